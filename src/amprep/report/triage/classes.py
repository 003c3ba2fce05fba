"""Decide what must be done about a region of overhangs."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

from amprep.geometry.overhangs.regions import NOT_FACES, OverhangRegion
from amprep.model import Unsupported
from amprep.model.supports import EXCEPTED

Triage = Literal["must fix", "worth a check", "supported", "self-supporting"]
MUST_FIX: Triage = "must fix"
CHECK: Triage = "worth a check"
SUPPORTED: Triage = "supported"
SELF_SUPPORTING: Triage = "self-supporting"
TRIAGES = (MUST_FIX, CHECK, SUPPORTED, SELF_SUPPORTING)
"""The classes, from the most urgent to the least."""

Outcome = Literal["fully", "partly", "not", "not needed"]
"""Extent to which a region is supported."""

NEAR_LIMIT = 0.9
"""Fraction of its limit from which the size of a self-supporting region is a reason for a check."""

STEEP_DEG = 2.0
"""Faces less than this flatter than the overhang angle, such as chamfers of 45 degrees, are no reason for a check."""


class RegionTriage(NamedTuple):
    """What must be done about a region.

    Attributes
    ----------
    triage
        Its class.
    outcome
        Extent to which it is supported; minor remainders count as supported.
    why
        The reason for its class, where the verdict does not say it.
    """

    triage: Triage
    outcome: Outcome
    why: str = ""


def triage_of(region: OverhangRegion, left: Sequence[Unsupported], angle_deg: float) -> RegionTriage:
    """Return the class of a region of overhangs.

    Parameters
    ----------
    region
        The region with its sizes.
    left
        What of it has no support.
    angle_deg
        Overhang angle of its part.
    """
    faults = [each for each in left if not each.minor]
    if faults:
        return RegionTriage(MUST_FIX, _outcome(region, left), _reasons(faults))
    if any(each.reason == EXCEPTED for each in left):
        return RegionTriage(CHECK, _outcome(region, left), "a rule of the job leaves it without supports")
    if left:
        return RegionTriage(CHECK, "fully", f"a small patch has no support: {_reasons(left)}")
    return _carried(region, angle_deg) if region.is_self_supporting else RegionTriage(SUPPORTED, "fully")


def _carried(region: OverhangRegion, angle_deg: float) -> RegionTriage:
    """Return the class of a region that the part itself carries."""
    if region.is_noncritical:
        return RegionTriage(CHECK, "not needed", "steeper than the overhang angle, not critical")
    is_steep = region.kind not in NOT_FACES and region.angle_deg > angle_deg - STEEP_DEG
    if not is_steep and 0.0 < NEAR_LIMIT * region.limit_mm <= region.size_mm:
        side = "above" if region.size_mm > region.limit_mm else "near"
        return RegionTriage(CHECK, "not needed", f"{side} the limit of {region.limit_mm:g} mm")
    return RegionTriage(SELF_SUPPORTING, "not needed")


def _outcome(region: OverhangRegion, left: Sequence[Unsupported]) -> Outcome:
    return "partly" if sum(each.measure for each in left) < (1.0 - 1e-6) * region.measure else "not"


def _reasons(left: Sequence[Unsupported]) -> str:
    return ", ".join(sorted({each.reason for each in left}))
