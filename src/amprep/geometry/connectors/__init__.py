"""Geometry of connectors between supports and parts."""
