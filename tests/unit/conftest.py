"""Fixtures of the unit tests."""

from tests.shared.builds import make_build

__all__ = ["make_build"]
