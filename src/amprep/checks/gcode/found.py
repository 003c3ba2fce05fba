"""What a slicer's G-code prints, object by object, as the judges need it."""

import math
from dataclasses import dataclass, field

import numpy as np

from amprep.arrays import Float32s, Floats, frozen


@dataclass(frozen=True, eq=False)
class SlicedLayer:
    """The lines of one layer, without infill.

    Attributes
    ----------
    z, thickness
        Height of its top, and its thickness, mm.
    lines
        ``(n, 6)`` mm: start x and y, end x and y, half the width; and 1 for outer walls, else 0.
    complete
        False if lines were left out because there are too many.
    """

    z: float
    thickness: float
    lines: Float32s
    complete: bool = True


@dataclass(frozen=True, eq=False)
class SlicedBody:
    """What was extruded for an object, or for the slicer's supports of an object.

    Attributes
    ----------
    low, high
        ``(3,)`` mm, extent of the lines with half their widths; not finite if there are none. The height is that of
        the tops of layers.
    length
        Length of the lines, mm.
    layers
        Number of layers.
    thickest
        Thickness of the thickest layer above the first, mm; 0 if there is none.
    samples
        Some of its layers, in ascending order.
    """

    low: Floats
    high: Floats
    length: float = 0.0
    layers: int = 0
    thickest: float = 0.0
    samples: tuple[SlicedLayer, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "low", frozen(self.low, np.float64))
        object.__setattr__(self, "high", frozen(self.high, np.float64))

    @property
    def is_empty(self) -> bool:
        """Whether nothing was extruded."""
        return not self.layers


@dataclass(frozen=True, eq=False)
class SlicedObject:
    """An object as labels name it; without labels, everything that was extruded.

    Attributes
    ----------
    name
        The label without the numbers that slicers add.
    number
        The number of a label that has one; else "".
    body
        The object itself.
    supports
        The supports that the slicer added to it.
    """

    name: str
    body: SlicedBody
    supports: SlicedBody
    number: str = ""


@dataclass(frozen=True, eq=False)
class SlicedPlate:
    """Everything that a file of G-code prints.

    Attributes
    ----------
    program
        The slicer, with its version; "" if the file does not say.
    objects
        The labelled objects; one without a name if there are no labels.
    labels
        How objects are labelled; "" if they are not.
    has_names
        Whether the labels contain the names of objects.
    apart
        What was extruded outside all labels, without skirts and the like.
    bed
        ``(n, 2)`` mm, corners of the bed; empty if the file does not state it.
    settings
        Settings of the slicer in the file, by name.
    features
        Whether the file says what each line is.
    """

    program: str
    objects: tuple[SlicedObject, ...]
    labels: str
    has_names: bool
    apart: SlicedObject
    bed: Floats
    settings: dict[str, str] = field(default_factory=dict)
    features: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "bed", frozen(self.bed, np.float64, 2))

    def number_setting(self, *names: str) -> float:
        """Return the first number of the first of some settings that the file states; 0 if it states none."""
        for name in names:
            try:
                value = float(self.settings[name].split(",")[0].rstrip("%"))
            except (KeyError, ValueError):
                continue
            if math.isfinite(value):
                return value
        return 0.0
