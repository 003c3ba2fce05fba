"""Simulated annealing of bounding volumes of any shape."""
