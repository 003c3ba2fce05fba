"""Support routing benchmarks: generated scenes and rival flow solvers."""
