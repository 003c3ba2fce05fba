"""Find the flat facets that faces beside overhang regions are part of."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.overhangs.regions import connected_components
from amprep.geometry.overhangs.surface import Surface

_PARALLEL = 1 - 1e-9
"""Least cosine of the angle between the normals of faces of the same facet."""

_UPWARDS = 1e-3
"""Greatest upward component of the normals of faces that may continue an arch."""


class LabelledFaces(NamedTuple):
    """Faces ``(n,)`` of a surface, and the region ``(n,)`` that each is beside."""

    face: Int64s
    label: Int64s


def facets_of(surface: Surface, normals: Floats, face: Int64s, label: Int64s) -> LabelledFaces:
    """Return all faces of the facets that faces are part of; faces that point upwards are left out.

    Parameters
    ----------
    surface, normals
        The merged surface and its unit normals.
    face, label
        ``(n,)`` faces, and the region that each is beside.
    """
    count = len(surface.triangles)
    eligible = normals[:, 2] < _UPWARDS
    same_edge = np.flatnonzero(surface.half_edge[1:] == surface.half_edge[:-1])
    one, other = surface.half_face[same_edge], surface.half_face[same_edge + 1]
    both = eligible[one] & eligible[other]
    one, other = one[both], other[both]
    parallel = np.einsum("ij,ij->i", normals[one], normals[other]) > _PARALLEL
    facet = connected_components(one[parallel], other[parallel], count)
    chosen = eligible[face]
    pairs = np.unique(np.column_stack([facet[face[chosen]], label[chosen]]), axis=0)
    order = np.argsort(facet, kind="stable")
    first, last = (np.searchsorted(facet[order], pairs[:, 0], side=side) for side in ("left", "right"))
    size = last - first
    within = np.arange(size.sum()) - np.repeat(np.cumsum(size) - size, size)
    return LabelledFaces(order[np.repeat(first, size) + within], np.repeat(pairs[:, 1], size))
