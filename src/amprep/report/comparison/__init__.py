"""Runs side by side: their figures, pictures and findings, from their JSON reports."""
