"""Builds that break a promise before they are written, so that their own file records the fault."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from tests.shared.planted import BEAMS, solid_of, with_body
from tests.shared.supported import box

from amprep.model import Build, Mesh


def _solid_body(
    size: tuple[float, float, float], corner: tuple[float, float, float]
) -> Callable[[Build], Build]:
    """Return a change that adds a box to the first support."""

    def change(build: Build) -> Build:
        return with_body(build, 0, solid_of(build.supports[0].mesh) + box(size, corner))

    return change


def _lattice(**fields: Any) -> Callable[[Build], Build]:
    """Return a change of the beams of the first support; functions are called with the old value."""

    def change(build: Build) -> Build:
        first, *others = build.supports
        assert first.lattice is not None
        values = {name: value(getattr(first.lattice, name)) for name, value in fields.items()}
        return replace(build, supports=(replace(first, lattice=replace(first.lattice, **values)), *others))

    return change


@dataclass(frozen=True)
class WrongBuild:
    """A build that breaks a promise, before it is written; its file records it as it is."""

    name: str
    change: Callable[[Build], Build]
    dialects: tuple[str, ...]
    promise: str


_SOLIDS = ("generic", "cura", "prusaslicer")

WRONG_BUILDS = (
    WrongBuild(
        "supports overlap", _solid_body((30, 6, 5), (15, 11, 0)), _SOLIDS, "supports enter no other support"
    ),
    WrongBuild("too near", _solid_body((18, 4, 5), (20, 12, 0)), _SOLIDS, "distance to other parts"),
    WrongBuild("touching", _solid_body((20, 4, 5), (20, 12, 0)), _SOLIDS, "distance to other parts"),
    WrongBuild("island", _solid_body((1.5, 2, 2), (23.5, 12, 0)), _SOLIDS, "support holds its part"),
    WrongBuild("thin beams", _lattice(radii=lambda radii: 0.01 * radii), BEAMS, "least wall"),
    WrongBuild(
        "low beams", _lattice(nodes=lambda nodes: nodes * (1, 1, 0.5)), BEAMS, "support stands on the plate"
    ),
    WrongBuild(
        "no plate", _lattice(solids=lambda _: Mesh(np.empty((0, 3)), np.empty((0, 3)))), BEAMS, "coverage"
    ),
    WrongBuild("clipped", _lattice(room=lambda room: room * (1, 1, 0.1)), BEAMS, "printed as planned"),
)
