"""Build volume of a printer, with forbidden zones. The plate is at z = 0; x and y start at 0."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from amprep.arrays import Floats, frozen


def _no_boxes() -> Floats:
    return np.empty((0, 3))


@dataclass(frozen=True, eq=False)
class BuildVolume:
    """A box ``[0, x] x [0, y] x [0, z]``, or the upright cylinder inscribed in this box, whose x and y are equal.

    Attributes
    ----------
    size
        ``(3,)`` mm.
    zone_lo, zone_hi
        ``(k, 3)`` mm, lowest and highest corners of the forbidden zones.
    """

    size: Floats
    shape: Literal["box", "cylinder"] = "box"
    zone_lo: Floats = field(default_factory=_no_boxes)
    zone_hi: Floats = field(default_factory=_no_boxes)

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", frozen(self.size, np.float64))
        object.__setattr__(self, "zone_lo", frozen(self.zone_lo, np.float64, 3))
        object.__setattr__(self, "zone_hi", frozen(self.zone_hi, np.float64, 3))
        if self.size.shape != (3,) or not (np.isfinite(self.size).all() and (self.size > 0).all()):
            raise ValueError(f"size must be three positive lengths in mm, got {self.size.tolist()}")
        if self.shape == "cylinder" and self.size[0] != self.size[1]:
            raise ValueError("the x and y sizes of a cylinder must be equal (its diameter)")

    @property
    def volume_mm3(self) -> float:
        """Volume of the box or cylinder, including forbidden zones."""
        x, y, z = self.size.tolist()
        return float(x * y * z if self.shape == "box" else np.pi / 4 * x * x * z)
