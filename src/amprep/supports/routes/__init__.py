"""Routing of the support network."""
