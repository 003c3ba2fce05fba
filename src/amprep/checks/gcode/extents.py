"""Judge the extent of a printed object: its size, its position and its height."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats
from amprep.checks.gcode.matching import shift_words

_BEYOND = 0.3
"""How far (mm) an object may reach beyond its extent in plan, or half the width of a line if that is more."""
_SHORT = 1.0
"""How far (mm) it may fall short of it, or twice the width of a line: thin ends are not printed."""
_TOP = 0.5
"""How far (mm) beside two layers its top may be missing."""
_SAME_RATIO = 0.004


@dataclass(frozen=True, eq=False)
class ExtentFault:
    """What is wrong with the extent of an object.

    Attributes
    ----------
    kind
        ``moved``, ``scaled``, ``height`` or ``size``.
    words
        The same in words, to follow the name of the object.
    shift
        ``(3,)`` mm by which it is moved; zero unless `kind` is ``moved``.
    """

    kind: str
    words: str
    shift: Floats


@dataclass(frozen=True)
class LineSizes:
    """Width of the lines and greatest thickness of the layers of an object, mm."""

    width: float
    layer: float


def find_extent_fault(
    ours: tuple[Floats, Floats], theirs: tuple[Floats, Floats], sizes: LineSizes
) -> ExtentFault | None:
    """Return what is wrong with the extent of an object, None if it is right.

    Parameters
    ----------
    ours, theirs
        Least and greatest corner, ``(3,)`` mm, as prepared and as printed, in build coordinates; heights are those of
        the bottom of the lowest layer and of the top of the highest.
    sizes
        Of the lines.
    """
    beyond = np.array([max(_BEYOND, sizes.width / 2.0)] * 2 + [sizes.layer + 0.05])
    short = np.array([max(_SHORT, 2.0 * sizes.width)] * 2 + [2.0 * sizes.layer + _TOP])
    low, high = theirs[0] - ours[0], theirs[1] - ours[1]
    if _within(low, high, beyond, short):
        return None
    size, due = theirs[1] - theirs[0], ours[1] - ours[0]
    none = np.zeros(3)
    if np.all(np.abs(size - due) <= np.minimum(short, 2.0 * beyond)):
        return _moved((low + high) / 2.0, beyond)
    ratio = size / np.maximum(due, 1e-9)
    common = float(ratio[np.argmax(due)])
    if abs(common - 1.0) > _SAME_RATIO and np.all(np.abs(size - common * due) <= beyond + _SAME_RATIO * due):
        return ExtentFault("scaled", f"it is scaled by {common:.4g}", none)
    if np.all(np.abs(size - due)[:2] <= short[:2]) and not np.all(np.abs(size - due)[2:] <= short[2:]):
        words = f"it is {size[2]:.2f} mm high, prepared were {due[2]:.2f} mm"
        return ExtentFault("height", words, none)
    return ExtentFault(
        "size", f"its size is {_size_words(size)} mm, prepared were {_size_words(due)} mm", none
    )


def _within(low: Floats, high: Floats, beyond: Floats, short: Floats) -> bool:
    """Tell whether both corners lie within the tolerances, which differ outwards and inwards."""
    return bool(
        np.all(low >= -beyond) and np.all(high <= beyond) and np.all(low <= short) and np.all(high >= -short)
    )


def _moved(shift: Floats, beyond: Floats) -> ExtentFault:
    """Return the fault of an object that has its size."""
    lower = -shift[2]
    plan = np.where(np.abs(shift[:2]) > 0.5 * beyond[:2], shift[:2], 0.0)
    words = []
    if np.any(plan):
        words.append(f"it is moved by {shift_words(shift[:2])} mm")
    if abs(lower) > 0.5 * beyond[2]:
        words.append(f"it is {abs(lower):.2f} mm {'lower' if lower > 0 else 'higher'} than prepared")
    return ExtentFault("moved", " and ".join(words) or f"it is moved by {shift_words(shift)} mm", shift)


def _size_words(size: Floats) -> str:
    return " x ".join(f"{value:.2f}" for value in size.tolist())
