"""Directions in which a part may be built, and quick figures of what each of them costs."""
