"""Compiled search for plates: depth fields of pairs of outlines, scans, guided separation, contacts."""
