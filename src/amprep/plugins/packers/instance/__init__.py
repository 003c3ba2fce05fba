"""A packing problem prepared for box packers."""
