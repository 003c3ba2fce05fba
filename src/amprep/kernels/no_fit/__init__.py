"""Compiled search for layouts of shapes on no-fit solids: sampled fields, scans, descent, guided separation.

A no-fit solid of two shapes contains the offsets (position of one less position of the other) at which they overlap.
Nothing rotates continuously, so each pair of shapes has one no-fit solid, whose depth is sampled once on a grid.
"""
