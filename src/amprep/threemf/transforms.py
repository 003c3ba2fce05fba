"""Affine transforms of 3MF files, as ``(4, 4)`` matrices in mm."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats

if TYPE_CHECKING:
    from lib3mf import Lib3MF


def row_matrix(transform: "Lib3MF.Transform") -> Floats:
    """Return a 3MF transform as a ``(4, 4)`` matrix for row vectors; its numbers may be non-finite."""
    matrix = np.eye(4)
    matrix[:, :3] = np.array([list(row) for row in transform.Fields], np.float64)
    return matrix


def column_matrix(transform: "Lib3MF.Transform") -> Floats:
    """Return a 3MF transform as a ``(4, 4)`` matrix for column vectors; its numbers may be non-finite."""
    return np.ascontiguousarray(row_matrix(transform).T)


def inverse(matrix: Floats) -> Floats:
    """Return the inverse of a ``(4, 4)`` matrix.

    Raises
    ------
    numpy.linalg.LinAlgError
        A ValueError: the matrix is singular.
    """
    return np.asarray(np.linalg.inv(matrix), dtype=np.float64)


def from_origin(matrix: Floats, origin: tuple[float, float]) -> Floats:
    """Return a ``(4, 4)`` placement on the plate in coordinates in which the corner of the plate is at `origin`, mm."""
    moved = matrix.copy()
    moved[:2, 3] += origin
    return moved


def from_corner(matrix: Floats, origin: tuple[float, float]) -> Floats:
    """Return the inverse of `from_origin`: a ``(4, 4)`` placement from the corner of the plate."""
    return from_origin(matrix, (-origin[0], -origin[1]))


def transform_exactly(vertices: Floats, matrix: Floats) -> Floats:
    """Return the transformed vertices, with the same bits on every machine.

    A matrix product by BLAS may differ in the last bit.

    Parameters
    ----------
    vertices
        ``(n, 3)`` mm.
    matrix
        ``(4, 4)`` affine, for column vectors.
    """
    x, y, z = vertices.T
    rows = [a * x + b * y + c * z + d for a, b, c, d in matrix[:3].tolist()]
    return np.stack(rows, axis=1)


def round_as_stored(vertices: Floats) -> Floats:
    """Return the vertices as a reader of the file gets them: six decimals in float32."""
    return np.round(vertices, 6).astype(np.float32).astype(np.float64)
