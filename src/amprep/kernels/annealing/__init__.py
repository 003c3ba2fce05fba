"""Simulated annealing of bodies that never intersect."""
