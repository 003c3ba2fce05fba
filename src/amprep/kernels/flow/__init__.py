"""Compiled kernels of network flow on the support grid."""
