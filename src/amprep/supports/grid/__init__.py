"""The voxel grid of a build and its red squares."""
