"""The built-in volume makers."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from amprep.hookspecs import VolumeMaker, hookimpl, later
from amprep.model.bounding_volume import Boxes
from amprep.model.control import Stop
from amprep.model.part import Part
from amprep.plugins.volumes.params import (
    BoundingMeshParams,
    BranchAndCutParams,
    ConvexPiecesParams,
    KMeansParams,
    TwoBoxesParams,
    TwoRectanglesParams,
)

amprep_api = 1


def _box(part: Part, *, params: Any, rng: np.random.Generator, stop: Stop) -> Boxes:  # noqa: ARG001
    from amprep.plugins.volumes.given_boxes import enclosing_box

    return enclosing_box(part)


def _boxes(part: Part, *, params: Any, rng: np.random.Generator, stop: Stop) -> Boxes:  # noqa: ARG001
    from amprep.plugins.volumes.given_boxes import given_boxes

    return given_boxes(part)


@hookimpl
def amprep_volume_makers() -> Iterable[VolumeMaker]:
    """Yield the built-in volume makers."""
    yield VolumeMaker(name="box", summary="The enclosing box of the part.", run=_box, makes="box")
    yield VolumeMaker(
        name="oriented-box",
        summary="The smallest enclosing box over the orientations that the part allows (thesis 2.3).",
        run=later("amprep.plugins.volumes.oriented_box:oriented_box"),
        makes="box",
    )
    yield VolumeMaker(
        name="boxes",
        summary="The boxes given in the job for the part; they must contain it.",
        run=_boxes,
        makes="boxes",
    )
    yield VolumeMaker(
        name="mesh",
        summary="The mesh of the part itself.",
        run=later("amprep.plugins.volumes.own_mesh:own_mesh"),
        makes="solid",
    )
    yield VolumeMaker(
        name="bounding-mesh",
        summary="The mesh of the part with fewer triangles, simplified outwards (Gaschler, Fischer, Knoll).",
        run=later("amprep.plugins.volumes.bounding_mesh:bounding_mesh"),
        makes="solid",
        params=BoundingMeshParams,
    )
    yield VolumeMaker(
        name="boxes-two",
        summary="Two boxes of least union, or whose larger one is smallest (Bespamyatnikh, Segal).",
        run=later("amprep.plugins.volumes.two_boxes:cover_with_two"),
        makes="boxes",
        params=TwoBoxesParams,
    )
    yield VolumeMaker(
        name="boxes-branch-and-cut",
        summary="Two to four boxes of small union, by branch and cut on cells, with a bound (thesis 2.3).",
        run=later("amprep.plugins.volumes.branch_and_cut:branch_and_cut_boxes"),
        makes="boxes",
        params=BranchAndCutParams,
    )
    yield VolumeMaker(
        name="boxes-kmeans",
        summary="Two to five boxes, by k-means over centres and diagonal directions (thesis 2.3).",
        run=later("amprep.plugins.volumes.k_means:k_means_boxes"),
        makes="boxes",
        params=KMeansParams,
    )
    yield VolumeMaker(
        name="convex-pieces",
        summary="Nearly convex pieces of the part, replaced by their hulls.",
        run=later("amprep.plugins.volumes.convex_decomposition:convex_pieces"),
        makes="convex",
        params=ConvexPiecesParams,
    )
    yield VolumeMaker(
        name="rectangles-two",
        summary="Two upright boxes over parallel rectangles of any orientation (Saha, Das; thesis 2.3).",
        run=later("amprep.plugins.volumes.parallel_rectangles:two_rectangles"),
        makes="boxes",
        params=TwoRectanglesParams,
    )
