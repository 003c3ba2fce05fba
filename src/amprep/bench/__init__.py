"""Benchmarks on named instances, with rivals in the same run."""
