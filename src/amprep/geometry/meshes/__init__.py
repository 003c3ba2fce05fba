"""Mesh operations: repair, containment, distance, offset, decimation."""
