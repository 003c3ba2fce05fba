"""Say in words what the part carries of an overhang region."""

from typing import Literal

from amprep.geometry.overhangs.regions import OverhangRegion

Support = Literal["fully", "partly", "not"]


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


def _shape(region: OverhangRegion) -> str:
    """Return kind and size: ``bore 3.9 mm``, ``face at 47° to the plate``."""
    if region.size_mm > 0:
        name = "knife edge" if region.kind == "edge" else region.kind
        return f"{name} {region.size_mm:.1f} mm"
    if region.kind == "face":
        return f"face at {region.angle_deg:.0f}° to the plate"
    return "knife edge" if region.kind == "edge" else region.kind
