"""Trapped powder and drain holes."""
