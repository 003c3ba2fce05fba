"""Parse the allowed rotations of a part: none, z90, up-x, axis, about-z, free, or a list of matrices."""

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

_EXPECTED = (
    f"one of {', '.join(ROTATION_WORDS)}, up- with the axes that may point up (up-xz), or a list of 3x3 "
    "rotation matrices"
)
_UPRIGHT = re.compile(r"up-([xyz]{1,3})")
_WRITTEN_ACCURACY = 1e-3  # tolerance for rounded entries such as 0.7071


def parse_rotations(words: str | list[Any]) -> Orientations:
    """Return the orientations for one of `ROTATION_WORDS`, or for a list of 3x3 matrices, also as JSON text.

    Matrices may be rounded to three decimals; the nearest rotation is used.

    Raises
    ------
    JobError
        For an unknown word, or a matrix that is not a rotation.
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
    if word.lower() not in allowed:
        hint = nearest_hint(word, ROTATION_WORDS)
        raise JobError(f"rotations: expected {_EXPECTED}; got {word[:80]!r}{hint}")
    return allowed[word.lower()]()


def quarter_turns() -> Floats:
    """Return the four turns about z by multiples of 90 degrees, ``(4, 3, 3)``, identity first."""
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    return np.array([np.linalg.matrix_power(turn, k) for k in range(4)]) + 0.0


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
