"""Rigid motions of bodies."""
