"""What was edited in a build."""

from dataclasses import dataclass, field

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.model import PlacedPart, SupportBody
from amprep.report.replanning import PartChange


@dataclass(frozen=True, eq=False)
class EditedPart:
    """A part of an edited build.

    Attributes
    ----------
    placed
        The part where it is now.
    was
        Its index in the build as it was written, for a copy that of the part it is a copy of; None for an added part.
    motion
        ``(4, 4)``, from where it was to where it is.
    change
        What happened to it.
    slides
        Whether it is where it was, or was moved along the plate only, and may keep its supports.
    """

    placed: PlacedPart
    was: int | None
    change: PartChange
    motion: Floats = field(default_factory=lambda: np.eye(4))
    slides: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "motion", frozen(self.motion, np.float64).reshape(4, 4))


@dataclass(frozen=True, eq=False)
class EditedBuild:
    """A build after it was edited.

    Attributes
    ----------
    parts
        Its parts, those of the build as it was written first and in their order.
    supports
        Supports that are in the file where those of their parts must be; they hold `parts` by their indices.
    sources
        For each of them its index in the build as it was written.
    deleted
        Labels of parts that are no longer in the build.
    """

    parts: tuple[EditedPart, ...]
    supports: tuple[SupportBody, ...]
    sources: tuple[int, ...]
    deleted: tuple[str, ...]
