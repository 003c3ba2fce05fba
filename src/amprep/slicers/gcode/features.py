"""Names of features in G-code, and whether what they name belongs to the object."""

from amprep.kernels.gcode.records import (
    ADHESION,
    INFILL,
    OTHER,
    OUTER_WALL,
    SUPPORT,
    UNKNOWN,
    WALL,
)

FEATURE_PREFIXES = (";TYPE:", "; FEATURE:", "; TYPE:")

_ROLES = {
    OUTER_WALL: ("external perimeter", "outer wall", "wall-outer"),
    WALL: (
        *(
            "perimeter",
            "internal perimeter",
            "overhang perimeter",
            "inner wall",
            "overhang wall",
            "wall-inner",
        ),
        *("gap fill", "gap infill", "thin wall"),
    ),
    INFILL: (
        *("internal infill", "solid infill", "top solid infill", "bridge infill", "internal bridge infill"),
        *("ironing", "sparse infill", "internal solid infill", "top surface", "bottom surface", "bridge"),
        *("internal bridge", "skin", "fill"),
    ),
    SUPPORT: (
        *("support material", "support material interface", "support", "support interface"),
        *("support transition", "support-interface"),
    ),
    ADHESION: ("skirt", "brim", "skirt/brim"),
    OTHER: ("custom", "wipe tower", "prime tower", "prime-tower", "mill"),
}
_ROLE_OF = {name: role for role, names in _ROLES.items() for name in names}


def role_of(line: str) -> int | None:
    """Return the role that a comment begins, None if it is no comment about a feature.

    A feature without a known name counts as part of the object, so that nothing is left unjudged.
    """
    for prefix in FEATURE_PREFIXES:
        if line.startswith(prefix):
            return _ROLE_OF.get(line.removeprefix(prefix).strip().lower(), UNKNOWN)
    return None
