"""Independent checks of the results of each stage; each returns the violations that it found."""

from amprep.checks.violation import Violation

__all__ = ["Violation"]
