"""How supports end: their connectors at the part, their base on the plate."""

from dataclasses import dataclass
from typing import Literal

ConnectorKind = Literal["full", "teeth", "point", "extend"]
BaseKind = Literal["direct", "flange", "raft"]


@dataclass(frozen=True)
class Connector:
    """The connectors from red squares up to the part; all lengths in mm.

    Attributes
    ----------
    kind
        ``full``: the whole square runs up; ``teeth``: it ends in a grid of square teeth, ``point``: in cones;
        ``extend``: the cell itself runs up.
    pitch
        Distance of teeth or points; None: about 1 mm for teeth, the square's side for points.
    width
        Side of a tooth, or diameter of a point, where it meets the part.
    height
        Length over which it tapers.
    neck
        Width of the neck at which it breaks off, below the contact; 0: none.
    neck_height
        Distance of the neck from the lowest spot of the contact.
    window
        Width of the diamonds that perforate the connectors; 0: none.
    """

    kind: ConnectorKind = "full"
    pitch: float | None = None
    width: float = 0.5
    height: float = 0.8
    neck: float = 0.0
    neck_height: float = 0.3
    window: float = 0.0

    @property
    def is_shaped(self) -> bool:
        """Whether connectors are more than whole squares, or cells, run up."""
        return self.kind in ("teeth", "point") or (self.kind == "full" and self.neck + self.window > 0)


@dataclass(frozen=True)
class Base:
    """What supports stand on at the plate; all lengths in mm.

    Attributes
    ----------
    kind
        ``direct``: nothing; ``flange``: every foot is widened; ``raft``: a pad under all feet of a support.
    margin
        How far it reaches beyond the feet.
    height
        Of flange or raft.
    hole
        Width of the holes of a raft; 0: none.
    """

    kind: BaseKind = "direct"
    margin: float = 1.0
    height: float = 0.6
    hole: float = 0.0
