"""A lattice cell: the gyroid (A. Schoen, NASA TN D-5541, 1970), as a network or as a wall."""

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
    """What is filled: one side of the surface up to a density, or a wall of some thickness.

    Attributes
    ----------
    resolution
        Steps along each side of the cell. Left out, it is 6 for a network, and for a wall so many that its
        thickness takes more than one.
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
    """Return the gyroid for cells of pitch x pitch x step mm: a function of the point, positive inside."""
    size = np.array([pitch, pitch, step])

    def network(points: Floats) -> Floats:
        # the share of the volume above a level is nearly linear in it: a third for each unit
        return gyroid(points)[0] - 3.03 * (0.5 - params.density)

    def wall(points: Floats) -> Floats:
        value, gradient = gyroid(points)
        steepness = np.maximum(np.linalg.norm(gradient / size, axis=1), 1e-6)
        return params.wall_mm / 2 - np.abs(value) / steepness

    if params.kind == "network":
        return ImplicitCell(network, params.resolution or 6)
    usual = int(np.clip(np.ceil(1.5 * size.max() / params.wall_mm), 8, 60))
    return ImplicitCell(wall, params.resolution or usual)


def gyroid(points: Floats) -> tuple[Floats, Floats]:
    """Return the function whose zeros are the gyroid, ``(n,)``, and its gradient ``(n, 3)`` in the unit cube."""
    sine, cosine = np.sin(2 * np.pi * points), np.cos(2 * np.pi * points)
    value = (sine * np.roll(cosine, -1, axis=1)).sum(axis=1)
    gradient = cosine * np.roll(cosine, -1, axis=1) - sine * np.roll(sine, 1, axis=1)
    return value, 2 * np.pi * gradient
