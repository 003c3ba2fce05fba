"""Bounds that several settings share."""

from amprep.validation import LARGEST_COUNT, require


def require_quantity(quantity: int | None) -> None:
    """Raise `ValueError` unless `quantity` is None or a count that a job may ask for."""
    valid = quantity is None or 1 <= quantity <= LARGEST_COUNT
    require(valid, f"quantity must be between 1 and {LARGEST_COUNT}", quantity)
