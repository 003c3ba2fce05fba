"""Parse the allowed rotations of a part: none, z90, z15 except 30-60, up-x, axis, about-z, free, or matrices."""

import json
import re
from collections.abc import Callable
from itertools import permutations, product
from typing import Any

import numpy as np

from amprep.arrays import Floats
from amprep.errors import JobError, nearest_hint
from amprep.model.part import Orientations

ROTATION_WORDS = ("none", "z90", "axis", "about-z", "free")

ORIENT = "orient"
"""In a job file: the rotations that a search for orientations finds."""

_EXPECTED = (
    f"one of {', '.join(ROTATION_WORDS)}, z with a step of 1 to 360 degrees and perhaps forbidden angles "
    "('z15 except 30-60, 210-240'), up- with the axes that may point up (up-xz), or a list of 3x3 rotation matrices"
)
_UPRIGHT = re.compile(r"up-([xyz]{1,3})")
_NUMBER = r"(\d+(?:\.\d+)?)"
_STEPS = re.compile(rf"z{_NUMBER}(?:\s+except\s+(.+))?")
_BAND = re.compile(rf"\s*{_NUMBER}\s*-\s*{_NUMBER}\s*")
_ANGLE_ROUNDING = 1e-9  # degrees
_WRITTEN_ACCURACY = 1e-3  # tolerance for rounded entries such as 0.7071


def parse_rotations(words: str | list[Any]) -> Orientations:
    """Return the orientations for one of `ROTATION_WORDS`, or for a list of 3x3 matrices, also as JSON text.

    ``z15 except 30-60, 350-10`` allows the turns about z by multiples of 15 degrees, without those from 30 to 60 and
    from 350 to 370 degrees. Matrices may be rounded to three decimals; the nearest rotation is used.

    Raises
    ------
    JobError
        For an unknown word, a matrix that is not a rotation, or forbidden angles that leave no turn.
    """
    if not isinstance(words, str):
        return Orientations("list", _matrices(words))
    word = words.strip()
    if word.startswith("["):
        return Orientations("list", _matrices(_json(word)))
    allowed: dict[str, Callable[[], Orientations]] = {
        "none": Orientations,
        "z90": lambda: Orientations("list", quarter_turns()),
        "axis": lambda: Orientations("list", axis_rotations()),
        "about-z": lambda: Orientations("about-z"),
        "free": lambda: Orientations("free"),
    }
    if upright := _UPRIGHT.fullmatch(word.lower()):
        return Orientations("list", upright_rotations(upright[1]))
    if steps := _STEPS.fullmatch(word.lower()):
        return Orientations("list", _turns(word, float(steps[1]), steps[2]))
    if word.lower() not in allowed:
        hint = nearest_hint(word, ROTATION_WORDS)
        raise JobError(f"rotations: expected {_EXPECTED}; got {word[:80]!r}{hint}")
    return allowed[word.lower()]()


def quarter_turns() -> Floats:
    """Return the four turns about z by multiples of 90 degrees, ``(4, 3, 3)``, identity first."""
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    return np.array([np.linalg.matrix_power(turn, k) for k in range(4)]) + 0.0


def turns_about_z(degrees: Floats) -> Floats:
    """Return the turns about z by some angles, ``(k, 3, 3)``; quarter turns are exact."""
    angles = np.radians(np.asarray(degrees, np.float64))
    found = np.zeros((len(angles), 3, 3))
    found[:, 0, 0] = found[:, 1, 1] = np.cos(angles)
    found[:, 1, 0], found[:, 0, 1] = np.sin(angles), -np.sin(angles)
    found[:, 2, 2] = 1.0
    whole = np.rint(found) + 0.0
    exact = np.abs(whole - found).max(axis=(1, 2)) < 1e-12
    return np.where(exact[:, None, None], whole, found)


def upright_rotations(axes: str) -> Floats:
    """Return the rotations that turn one of the axes of the part upwards, four per axis, ``(4 k, 3, 3)``."""
    every = axis_rotations()
    return np.concatenate(
        [every[every[:, 2, axis] == 1.0] for axis in range(2, -1, -1) if "xyz"[axis] in axes]
    )


def axis_rotations() -> Floats:
    """Return the 24 rotations that map axes to axes, ``(24, 3, 3)``: the quarter turns about z first."""
    upright = quarter_turns()
    found = [
        signed
        for order in permutations(range(3))
        for signs in product((1.0, -1.0), repeat=3)
        if np.linalg.det(signed := np.eye(3)[list(order)] * np.array(signs)[:, None] + 0.0) > 0
    ]
    others = [matrix for matrix in found if matrix[2, 2] != 1.0]
    return np.concatenate([upright, np.array(others)])


def _turns(word: str, step: float, bands: str | None) -> Floats:
    """Return the turns about z by multiples of a step (degrees) outside the forbidden bands, the least angle first."""
    if not 1.0 <= step <= 360.0:
        raise JobError(
            f"rotations: the step must be between 1 and 360 degrees, got {step:g}; correct {word[:80]!r}"
        )
    angles = np.arange(0.0, 360.0 - _ANGLE_ROUNDING, step)
    forbidden = np.zeros(len(angles), bool)
    for band in bands.split(",") if bands else ():
        low, high = _band(word, band)
        width = high - low + (360.0 if high < low else 0.0)
        forbidden |= (angles - low + _ANGLE_ROUNDING) % 360.0 <= width + 2.0 * _ANGLE_ROUNDING
    if forbidden.all():
        raise JobError(
            f"rotations: {word[:80]!r} allows no turn; make a forbidden band narrower, or the step finer"
        )
    return turns_about_z(angles[~forbidden])


def _band(word: str, band: str) -> tuple[float, float]:
    """Return the first and the last angle (degrees) of a forbidden band."""
    ends = _BAND.fullmatch(band)
    if not ends:
        raise JobError(f"rotations: expected {_EXPECTED}; got {word[:80]!r}")
    low, high = float(ends[1]), float(ends[2])
    if max(low, high) > 360.0:
        raise JobError(
            f"rotations: forbidden angles must be between 0 and 360 degrees, got {band.strip()[:80]}"
        )
    return low, high


def _json(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise JobError(f"rotations: expected {_EXPECTED}; the list is not valid JSON ({error})") from error


def _matrices(rows: Any) -> Floats:
    try:
        matrices = np.array(rows, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise JobError(f"rotations: expected {_EXPECTED}; got {str(rows)[:80]}") from error
    if matrices.ndim != 3 or matrices.shape[1:] != (3, 3) or len(matrices) == 0:
        raise JobError(f"rotations: expected {_EXPECTED}; got a list of shape {matrices.shape}")
    return np.array([_nearest_rotation(matrix) for matrix in matrices])


def _nearest_rotation(matrix: Floats) -> Floats:
    """Return the rotation nearest to `matrix` (Schönemann 1966, DOI 10.1007/BF02289451)."""
    if not np.isfinite(matrix).all():
        raise JobError("rotations: a matrix has an entry that is not a finite number")
    if np.abs(matrix @ matrix.T - np.eye(3)).max() > 3 * _WRITTEN_ACCURACY or np.linalg.det(matrix) < 0:
        raise JobError(f"rotations: {matrix.tolist()} is not a rotation matrix (orthonormal, determinant +1)")
    left, _, right = np.linalg.svd(matrix)
    rotation: Floats = left @ right
    whole: Floats = np.rint(rotation) + 0.0
    return whole if np.abs(whole - rotation).max() < 1e-9 else rotation
