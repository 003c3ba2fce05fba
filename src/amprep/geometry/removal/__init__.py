"""The order in which bodies can be taken out of a build by straight motions."""
