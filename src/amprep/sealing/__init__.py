"""Seals: small files beside build files that show whether a build file was changed, and who sealed it."""
