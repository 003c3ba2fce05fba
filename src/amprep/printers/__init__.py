"""Printers: the catalogue of profiles."""
