"""Convert plain values, as in TOML, to typed values; messages give the expected type and the value."""

import math
import types
from collections.abc import Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from amprep.errors import JobError, nearest_hint

T = TypeVar("T")
_SCALARS: dict[Any, str] = {bool: "true or false", int: "a whole number", float: "a number", str: "a text"}


def field_types(cls: type) -> dict[str, Any]:
    """Return the type of each field of a dataclass that can be set.

    Raises
    ------
    TypeError
        When no plain value can be converted to the type of a field.
    NameError
        When an annotation uses a name that does not exist.
    """
    hints = get_type_hints(cls)
    settable = {field.name: hints[field.name] for field in fields(cls) if field.init}
    for name, wanted in settable.items():
        expectation(wanted, name)
    return settable


def make(cls: type[T], table: Mapping[str, Any], where: str) -> T:
    """Make a record of the dataclass `cls` from a table of plain values.

    Parameters
    ----------
    where
        Name of the table in messages, for example ``job.toml, [packing]``.

    Raises
    ------
    JobError
        For an unknown key, a key that `REPLACED_KEYS` of the class lists with its successor, a value of the wrong
        type (`EXPECTED` of the class may say in words what a key expects), or a value out of bounds.
    """
    wanted = field_types(cls)
    replaced = getattr(cls, "REPLACED_KEYS", {})
    for key in table:
        if key in replaced:
            raise JobError(
                f"{where}: the key {key!r} is now {replaced[key]!r}; see docs/job-file.md for its meaning"
            )
        if key not in wanted:
            raise JobError(f"{where}: unknown key {key!r}{nearest_hint(key, wanted)}")
    expected = getattr(cls, "EXPECTED", {})
    values = {
        key: convert(value, wanted[key], f"{where}: {key}", expected.get(key)) for key, value in table.items()
    }
    try:
        return cls(**values)
    except ValueError as error:
        raise JobError(f"{where}: {error}") from error


def convert(value: Any, wanted: Any, where: str, expected: str | None = None) -> Any:
    """Return the value converted to a type; raise `JobError` if this is impossible.

    The message describes the type by `expected`, if that is given, and suggests the nearest word of a choice.
    """
    converted, fits = _attempt(value, wanted)
    if not fits:
        words = expected or expectation(wanted, where)
        raise JobError(f"{where}: expected {words}, got {_shown(value)}{_nearest_choice(value, wanted)}")
    return converted


def _nearest_choice(value: Any, wanted: Any) -> str:
    """Return ``(did you mean 'x'?)`` for the first text that is none of the choices but like one; else nothing."""
    known = {choice for choice in _choices(wanted) if isinstance(choice, str)}
    texts = [
        each for each in (value if isinstance(value, list | tuple) else [value]) if isinstance(each, str)
    ]
    hints = (nearest_hint(text, known) for text in texts if text not in known)
    return next((hint for hint in hints if "did you mean" in hint), "")


def _choices(wanted: Any) -> Iterator[Any]:
    """Yield the values of all choices in a type."""
    if get_origin(wanted) is Literal:
        yield from get_args(wanted)
        return
    for each in get_args(wanted):
        yield from _choices(each)


def expectation(wanted: Any, where: str) -> str:
    """Describe a type in words; raise `TypeError` if no plain value can be converted to it."""
    if wanted in _SCALARS:
        return _SCALARS[wanted]
    if wanted is Any or wanted is Path:
        return "any value" if wanted is Any else "a path"
    origin, arguments = get_origin(wanted), get_args(wanted)
    if origin is Literal:
        return "one of " + ", ".join(repr(choice) for choice in arguments)
    if origin in (Union, types.UnionType):
        return " or ".join(expectation(each, where) for each in arguments if each is not type(None))
    if origin is tuple:
        return _tuple_expectation(arguments, where)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return "a table"
    raise TypeError(
        f"{where} has type {wanted}; "
        "use bool, int, float, str, Path, tuple, Literal, Mapping or a union of them"
    )


def _tuple_expectation(arguments: tuple[Any, ...], where: str) -> str:
    if arguments == (Any, Ellipsis):
        return "a list"
    if len(arguments) == 2 and arguments[1] is Ellipsis:
        return f"a list, each {expectation(arguments[0], where)}"
    return "a list of " + ", ".join(expectation(each, where) for each in arguments)


def _attempt(value: Any, wanted: Any) -> tuple[Any, bool]:
    """Return the converted value, and whether the conversion succeeded."""
    if wanted is Any:
        return value, True
    if wanted in _SCALARS or wanted is Path:
        return _scalar(value, wanted)
    origin, arguments = get_origin(wanted), get_args(wanted)
    if origin is Literal:
        return value, any(value == choice and type(value) is type(choice) for choice in arguments)
    if origin in (Union, types.UnionType):
        return _first_fitting(value, arguments)
    if origin is tuple:
        return _tuple(value, arguments)
    return value, isinstance(value, Mapping)


def _scalar(value: Any, wanted: Any) -> tuple[Any, bool]:
    if wanted is float:
        number = isinstance(value, int | float) and not isinstance(value, bool)
        return (
            (float(value), True)
            if number and abs(value) <= 1e300 and math.isfinite(value)
            else (value, False)
        )
    if wanted is Path:
        return (Path(value), True) if isinstance(value, str | Path) else (value, False)
    return value, type(value) is wanted


def _first_fitting(value: Any, choices: tuple[Any, ...]) -> tuple[Any, bool]:
    for choice in choices:
        converted, fits = (value, value is None) if choice is type(None) else _attempt(value, choice)
        if fits:
            return converted, True
    return value, False


def _tuple(value: Any, arguments: tuple[Any, ...]) -> tuple[Any, bool]:
    if not isinstance(value, list | tuple):
        return value, False
    open_ended = len(arguments) == 2 and arguments[1] is Ellipsis
    wanted = arguments[:1] * len(value) if open_ended else arguments
    if len(wanted) != len(value):
        return value, False
    pairs = [_attempt(each, kind) for each, kind in zip(value, wanted, strict=True)]
    return tuple(converted for converted, _ in pairs), all(fits for _, fits in pairs)


def _shown(value: Any) -> str:
    words = {bool: "the truth value", str: "the text", dict: "the table", list: "the list"}
    text = repr(value) if not isinstance(value, bool) else str(value).lower()
    short = text if len(text) <= 80 else text[:77] + "..."
    return f"{words[type(value)]} {short}" if type(value) in words else short
