"""Units of length that files are in."""

from collections.abc import Mapping

MILLIMETRES: Mapping[str, float] = {
    "micron": 0.001,
    "millimetre": 1.0,
    "centimetre": 10.0,
    "inch": 25.4,
    "foot": 304.8,
    "metre": 1000.0,
}
"""Name of a unit -> its length in mm."""
