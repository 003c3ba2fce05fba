"""Slices of a build: the contours of its parts and supports, layer by layer, and the files that hold them."""
