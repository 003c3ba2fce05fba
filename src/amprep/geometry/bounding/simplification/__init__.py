"""Simplification of closed meshes outwards, so that the result contains them."""
