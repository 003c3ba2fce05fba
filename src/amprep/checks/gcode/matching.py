"""Find out which object of G-code is which object of a build, and where the build lies on the slicer's bed."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.checks.gcode.expected import ExpectedObject, plain_name
from amprep.checks.gcode.found import SlicedObject, SlicedPlate
from amprep.errors import InputError
from amprep.model.build_volume import BuildVolume

_OTHER_NAME = 1e6
"""Cost (mm) of taking an object with another name."""
MOST_PAIRS = 4_000_000
"""Largest number of pairs of an object of the build and one of the G-code; 2,000 objects of each are matched."""
_NEAR = 1.0
"""Distance (mm) up to which the build lies where one of the usual origins puts it."""
_COPY = re.compile(r"\(\d+\)$")
_FILE = re.compile(r"^.*[/\\](?=.*\.\w+$)|\.(?:stl|3mf|obj|amf)$", re.IGNORECASE)
"""What slicers add to names: numbers of copies; folders and suffixes of files."""


@dataclass(frozen=True, eq=False)
class Match:
    """The objects of a build and those of G-code.

    Attributes
    ----------
    pairs
        Objects of the build with the objects of the G-code that print them.
    missing
        Objects of the build that are not printed.
    extra
        Objects of the G-code that are not of the build.
    origin
        ``(2,)`` mm, where the corner of the build volume lies on the slicer's bed.
    origin_words
        The same in words.
    """

    pairs: tuple[tuple[ExpectedObject, SlicedObject], ...]
    missing: tuple[ExpectedObject, ...]
    extra: tuple[SlicedObject, ...]
    origin: Floats
    origin_words: str


def match_objects(
    expected: Sequence[ExpectedObject], plate: SlicedPlate, space: BuildVolume, titles: Sequence[str]
) -> Match:
    """Return the assignment of objects with the least sum of distances, names first.

    Parameters
    ----------
    expected
        The objects of the build.
    plate
        What the G-code prints.
    space
        The build volume.
    titles
        What names of objects may have behind the labels: name and identifier of the build.

    Raises
    ------
    InputError
        If there are more than `MOST_PAIRS` pairs of objects.
    """
    from scipy.optimize import linear_sum_assignment

    printed = [each for each in plate.objects if not each.body.is_empty]
    if len(expected) * len(printed) > MOST_PAIRS:
        raise InputError(
            f"the G-code prints {len(printed)} objects and the build has {len(expected)}: more than {MOST_PAIRS} pairs "
            "cannot be matched"
        )
    apart = _distances(expected, printed)
    apart += np.where(_named(expected, printed, titles), 0.0, _OTHER_NAME)
    rows, columns = linear_sum_assignment(apart)
    pairs = [(expected[i], printed[j]) for i, j in zip(rows.tolist(), columns.tolist(), strict=True)]
    origin, words = _origin(pairs, plate, space)
    missing = tuple(each for i, each in enumerate(expected) if i not in set(rows.tolist()))
    extra = tuple(each for j, each in enumerate(printed) if j not in set(columns.tolist()))
    return Match(tuple(pairs), missing, extra, origin, words)


def _named(
    expected: Sequence[ExpectedObject], printed: Sequence[SlicedObject], titles: Sequence[str]
) -> Bools:
    """Return which printed objects have the name of which expected ones, or none, ``(n, m)``."""
    names = [_label_in(each.name, titles) for each in printed]
    return np.array([[not name or name in each.names for name in names] for each in expected]).reshape(
        len(expected), len(printed)
    )


def _label_in(name: str, titles: Sequence[str]) -> str:
    """Return the label in the name of an object, plainly, without the name of its build."""
    plain = plain_name(_FILE.sub("", _COPY.sub("", name)))
    for title in titles:
        ending = f"_{plain_name(title)}"
        if plain.endswith(ending):
            return plain.removesuffix(ending)
    return plain


def _distances(expected: Sequence[ExpectedObject], printed: Sequence[SlicedObject]) -> Floats:
    """Return the distances of the corners of all objects, ``(n, m)`` mm."""
    from scipy.spatial.distance import cdist

    ours = np.array([np.concatenate(each.bounds) for each in expected]).reshape(-1, 6)
    theirs = np.array([np.concatenate([each.body.low, each.body.high]) for each in printed]).reshape(-1, 6)
    return np.asarray(cdist(ours, theirs), np.float64)


def _origin(
    pairs: Sequence[tuple[ExpectedObject, SlicedObject]], plate: SlicedPlate, space: BuildVolume
) -> tuple[Floats, str]:
    """Return which of the usual origins most objects agree with; the corner at zero if none."""
    candidates = [(np.zeros(2), "as in the build file")]
    if len(plate.bed):
        low, high = plate.bed.min(axis=0), plate.bed.max(axis=0)
        candidates.append((low, "from the corner of the bed"))
        candidates.append(((low + high - space.size[:2]) / 2.0, "centred on the bed"))
    shifts = np.array([(ours_to_theirs(*pair))[:2] for pair in pairs]).reshape(-1, 2)
    near = [
        int((np.linalg.norm(shifts - origin, axis=1) <= _NEAR).sum()) if len(shifts) else 0
        for origin, _ in candidates
    ]
    origin, words = candidates[int(np.argmax(near))]
    if np.any(origin):
        words += f", moved by {shift_words(origin)} mm"
    return origin, words


def ours_to_theirs(ours: ExpectedObject, theirs: SlicedObject) -> Floats:
    """Return how far the centre of a printed object is from where the build has it, ``(3,)`` mm."""
    low, high = ours.bounds
    shift: Floats = (theirs.body.low + theirs.body.high - low - high) / 2.0
    return shift


def shift_words(shift: Floats) -> str:
    """Return a shift as messages state it."""
    return f"({', '.join(f'{round(value, 2) + 0.0:g}' for value in shift.tolist())})"
