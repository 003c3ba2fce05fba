"""Closed support bodies from routed edges."""
