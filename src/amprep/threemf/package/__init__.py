"""The 3MF package: opening, scanning, writing."""
