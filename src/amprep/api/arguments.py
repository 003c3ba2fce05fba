"""Refuse arguments of a wrong type before they fail somewhere inside."""

from amprep.errors import InputError


def require_record(value: object, kinds: tuple[type, ...], function: str, advice: str) -> None:
    """Raise `InputError` unless the value is of one of the kinds.

    Parameters
    ----------
    value
        Argument of the function.
    kinds
        Records that the function takes.
    function
        Name of the function.
    advice
        What the caller should pass.
    """
    if not isinstance(value, kinds):
        names = " or ".join(kind.__name__ for kind in kinds)
        raise InputError(f"{function}: expected {names}, got {type(value).__name__}; {advice}")
