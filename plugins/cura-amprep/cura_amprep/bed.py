"""The bed of Cura's active machine: its definition for amprep, and the way from Cura's scene to build coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable

import numpy as np


@dataclass(frozen=True)
class Bed:
    """The bed of a machine.

    Attributes
    ----------
    name
        Name of the machine.
    width, depth, height
        Size along x, y and z in mm.
    shape
        ``rectangular`` or ``elliptic``.
    areas
        Outlines of disallowed areas in mm from the middle of the bed, with y to the front, as Cura has them.
    margin
        Width in mm of the border that Cura keeps free for brims, skirts or rafts.
    """

    name: str
    width: float
    depth: float
    height: float
    shape: str = "rectangular"
    areas: tuple[tuple[tuple[float, float], ...], ...] = ()
    margin: float = 0.0

    def definition(self) -> dict[str, Any]:
        """Return a definition in Cura's own format, which ``amprep printers import`` reads."""
        values: dict[str, Any] = {
            "machine_width": self.width,
            "machine_depth": self.depth,
            "machine_height": self.height,
            "machine_shape": self.shape,
            "machine_disallowed_areas": [list(map(list, area)) for area in (*self.areas, *self._border())],
        }
        overrides = {key: {"default_value": value} for key, value in values.items()}
        return {"version": 2, "name": self.name, "metadata": {"visible": True}, "overrides": overrides}

    def _border(self) -> list[tuple[tuple[float, float], ...]]:
        """Return the border of a rectangular bed as four rectangles; a round bed has none."""
        if self.margin <= 0 or self.shape == "elliptic":
            return []
        x, y, m = self.width / 2, self.depth / 2, self.margin
        return [
            _rectangle(-x, -y, -x + m, y),
            _rectangle(x - m, -y, x, y),
            _rectangle(-x + m, -y, x - m, -y + m),
            _rectangle(-x + m, y - m, x - m, y),
        ]

    def from_scene(self) -> np.ndarray[Any, Any]:
        """Return the 4 x 4 matrix from Cura's scene to build coordinates, for column vectors.

        In the scene, y points up and z to the front, and the origin is in the middle of the bed. In a build, z points
        up and y to the back, and the origin is the left front corner, as Cura's own 3MF writer has it.
        """
        return np.array(
            [
                [1.0, 0.0, 0.0, self.width / 2],
                [0.0, 0.0, -1.0, self.depth / 2],
                [0.0, 1.0, 0.0, 0.0],
                [0.0, 0.0, 0.0, 1.0],
            ]
        )


def bed_of(name: str, value_of: Callable[[str], Any], margin: float = 0.0) -> Bed:
    """Return the bed of a machine.

    Parameters
    ----------
    name
        Name of the machine.
    value_of
        Returns the value of a setting of the machine by its key, or None.
    margin
        Width of the border that Cura keeps free, mm.
    """
    width, depth, height = (float(value_of(f"machine_{key}")) for key in ("width", "depth", "height"))
    areas = tuple(
        tuple((float(x), float(y)) for x, y in area) for area in value_of("machine_disallowed_areas") or []
    )
    shape = str(value_of("machine_shape") or "rectangular")
    return Bed(name, width, depth, height, shape, areas, max(float(margin), 0.0))


def _rectangle(x0: float, y0: float, x1: float, y1: float) -> tuple[tuple[float, float], ...]:
    return ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
