"""Parameters of the readers of 3MF and mesh files."""

from dataclasses import dataclass

from amprep.units import MILLIMETRES
from amprep.validation import require


@dataclass(frozen=True)
class ThreemfParams:
    """Parameters of the reader `3mf`.

    Attributes
    ----------
    strict
        Whether every rule of the specification must be kept; `reading.strict` sets it.
    """

    strict: bool = False


@dataclass(frozen=True)
class MeshParams:
    """Parameters of the reader `mesh`.

    Attributes
    ----------
    unit
        Unit of STL, OBJ, PLY and OFF files, which do not state theirs; `reading.unit` sets it.
    """

    unit: str = "millimetre"

    def __post_init__(self) -> None:
        require(self.unit in MILLIMETRES, f"unit must be one of {', '.join(MILLIMETRES)}", self.unit)

    @property
    def scale(self) -> float:
        """Length of the unit in mm."""
        return MILLIMETRES[self.unit]
