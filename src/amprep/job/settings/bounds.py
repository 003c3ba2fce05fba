"""Bounds that several sections of a job share."""

from amprep.validation import LARGEST_COUNT, require


def require_quantity(quantity: int | None) -> None:
    """Raise `ValueError` unless the quantity is None or an allowed number of copies."""
    valid = quantity is None or 1 <= quantity <= LARGEST_COUNT
    require(valid, f"quantity must be between 1 and {LARGEST_COUNT}", quantity)
