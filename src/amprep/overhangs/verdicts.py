"""Say in words what the part carries of an overhang region, and sort regions by what the user has to do."""

from typing import Literal

from amprep.geometry.overhangs.regions import OverhangRegion

Triage = Literal["must fix", "worth a check", "self-supporting", "supported"]
"""What a user has to do about a region."""

Support = Literal["fully", "partly", "not"]

_NEAR = 0.8
"""Fraction of a limit from which on a region that the part carries is worth a check."""


def verdict_words(region: OverhangRegion, supported: Support | None = None) -> str:
    """Return kind and size of a region, its limit, and who carries it.

    Examples: ``self-supporting: bore 3.9 mm``, ``ledge 6.0 mm over 1.0: supported``, ``flat, starts in the air: not
    supported``.

    Parameters
    ----------
    region
        The region.
    supported
        To which extent supports hold it; None before supports are planned.
    """
    if region.is_self_supporting:
        return f"self-supporting: {_shape(region)}"
    words = _shape(region)
    if region.starts_in_air and region.kind != "tip":
        words += ", starts in the air"
    elif region.size_mm > region.limit_mm:
        words += f" over {region.limit_mm:.1f}"
    ending = {
        None: "needs support",
        "fully": "supported",
        "partly": "partly supported",
        "not": "not supported",
    }
    return f"{words}: {ending[supported]}"


def triage_of(region: OverhangRegion, supported: Support | None = None) -> Triage:
    """Return what a user has to do about a region.

    Regions that need support and are not held completely must be fixed. A region that the part carries is worth a check
    if its faces are noncritical, or its size is at least 80 % of the limit.
    """
    if not region.is_self_supporting:
        return "supported" if supported == "fully" else "must fix"
    is_near = region.limit_mm > 0 and region.size_mm >= _NEAR * region.limit_mm
    return "worth a check" if region.is_noncritical or is_near else "self-supporting"


def _shape(region: OverhangRegion) -> str:
    """Return kind and size: ``bore 3.9 mm``, ``face at 47° to the plate``."""
    if region.size_mm > 0:
        name = "knife edge" if region.kind == "edge" else region.kind
        return f"{name} {region.size_mm:.1f} mm"
    if region.kind == "face":
        return f"face at {region.angle_deg:.0f}° to the plate"
    return "knife edge" if region.kind == "edge" else region.kind
