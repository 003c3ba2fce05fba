"""Packing benchmarks: published instances and the thesis's tables."""
