"""The promises of each stage as functions; each returns the violations it found."""

from amprep.checks.violation import Violation

__all__ = ["Violation"]
