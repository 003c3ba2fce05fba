"""Coverings with boxes."""
