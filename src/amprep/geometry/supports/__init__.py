"""Geometry of support bodies: beams, bases, walls, contact area."""
