"""A lattice cell: the gyroid (A. Schoen, NASA TN D-5541, 1970) as a network or as a wall."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from amprep.cells import cell_offer
from amprep.hookspecs import CellEmitter, hookimpl, require_bounds
from amprep.model import ImplicitCell

amprep_api = 1
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class GyroidParams:
    """Parameters of the gyroid.

    Attributes
    ----------
    kind
        ``network``: one side of the surface is filled up to the density; ``wall``: the surface is thickened.
    density
        Fraction of the volume that a network fills.
    wall_mm
        Thickness of a wall.
    resolution
        Steps along each edge of the cell. The default is 6 for a network; for a wall, its thickness is more than one
        step.
    """

    kind: Literal["network", "wall"] = "network"
    density: float = 0.3
    wall_mm: float = 0.4
    resolution: int | None = None

    def __post_init__(self) -> None:
        require_bounds(self, "density", at_least=0.1, at_most=0.9)
        require_bounds(self, "wall_mm", above=0)
        require_bounds(self, "resolution", at_least=6, at_most=60)


@hookimpl
def amprep_cell_emitters() -> Iterator[CellEmitter]:
    """Yield the gyroid."""
    yield cell_offer(
        "gyroid",
        "The gyroid, a minimal surface: as a network or as a wall.",
        declare_gyroid,
        params=GyroidParams,
    )


def declare_gyroid(pitch: float, step: float, params: GyroidParams) -> ImplicitCell:
    """Return the gyroid as an implicit cell of pitch x pitch x step mm."""
    size = np.array([pitch, pitch, step])

    def network(points: Floats) -> Floats:
        # the fraction of the volume above a level is nearly linear in the level, with a slope of one third
        return gyroid(points)[0] - 3.03 * (0.5 - params.density)

    def wall(points: Floats) -> Floats:
        value, gradient = gyroid(points)
        steepness = np.maximum(np.linalg.norm(gradient / size, axis=1), 1e-6)
        outside: Floats = np.abs(value) / steepness
        return params.wall_mm / 2 - outside

    if params.kind == "network":
        return ImplicitCell(network, params.resolution or 6)
    default = int(np.clip(np.ceil(1.5 * size.max() / params.wall_mm), 8, 60))
    return ImplicitCell(wall, params.resolution or default)


def gyroid(points: Floats) -> tuple[Floats, Floats]:
    """Return the function whose zero set is the gyroid, ``(n,)``, and its gradient ``(n, 3)``, in the unit cube."""
    sine, cosine = np.sin(2 * np.pi * points), np.cos(2 * np.pi * points)
    value = (sine * np.roll(cosine, -1, axis=1)).sum(axis=1)
    gradient = cosine * np.roll(cosine, -1, axis=1) - sine * np.roll(sine, 1, axis=1)
    return value, 2 * np.pi * gradient
