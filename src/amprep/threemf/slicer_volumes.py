"""Slicer volumes: ranges of a mesh's triangles that a slicer treats differently from the solid."""

from typing import Literal, NamedTuple

VolumeKind = Literal["solid", "blocker", "enforcer", "negative", "modifier"]

PRUSASLICER_KINDS: dict[str, VolumeKind] = {
    "ModelPart": "solid",
    "NegativeVolume": "negative",
    "ParameterModifier": "modifier",
    "SupportBlocker": "blocker",
    "SupportEnforcer": "enforcer",
}
"""Kind of a volume by PrusaSlicer's name of it."""

PRUSASLICER_NAMES = {kind: name for name, kind in PRUSASLICER_KINDS.items()}


class SlicerVolume(NamedTuple):
    """Triangles `first` to `last` of a mesh object, both included, and their purpose."""

    name: str
    first: int
    last: int
    kind: VolumeKind = "solid"
