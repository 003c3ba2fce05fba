"""Show a record by its summary."""


class Summarised:
    """A record whose ``repr`` is the name of its class with its ``str``, not all that it holds.

    A dataclass that inherits from it must be declared with ``repr=False``.
    """

    def __repr__(self) -> str:
        """Name of the class and summary."""
        return f"<{type(self).__name__}: {self}>"
