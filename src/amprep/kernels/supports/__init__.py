"""Compiled loops over sections of supports."""
