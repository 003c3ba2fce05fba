"""Judge the supports of a build by the limits that its file records, and say what was judged and how exactly."""

from typing import NamedTuple

from amprep.checks.overhangs.needs import GRANT_MM
from amprep.checks.supports import coverage, drift, legs, territory
from amprep.checks.supports.least_section import LEAST_CONTACT, LEAST_WALL, TOLERANCE, check_least_section
from amprep.checks.supports.solids import KnownSolids
from amprep.checks.violation import Violation
from amprep.model.build import Build
from amprep.model.control import Stop
from amprep.model.counting import counted
from amprep.model.supports.rules import SupportRules
from amprep.overhangs.contacts import sample_spacing

PROMISES = (LEAST_WALL, LEAST_CONTACT, legs.PROMISE, territory.PROMISE, drift.PROMISE)
"""Names of the promises."""

NOT_JUDGED = "not judged"
"""Beginning of the extent of a promise that a build's rules do not ask for."""


class JudgedLimits(NamedTuple):
    """Broken promises, and for each promise what was judged: the limit, the tolerance, and the number of sections."""

    violations: list[Violation]
    extent: dict[str, str]


def check_limits(build: Build, stop: Stop, solids: KnownSolids | None = None) -> JudgedLimits:
    """Judge sections, legs, territory and drift of the supports of a build; the thesis asks for none of them.

    The extent of coverage is told, too, although another judge checks it. `solids` are shared with other judges.
    """
    solids = solids or KnownSolids()
    violations, sections = check_least_section(build, stop, solids)
    violations += legs.check_legs(build, stop, solids)
    violations += territory.check_territory(build, stop, solids)
    violations += drift.check_drift(build, stop)
    extent = _extent(build.settings.rules, sections) | {coverage.PROMISE: _coverage_extent(build)}
    return JudgedLimits(violations, extent)


def _extent(rules: SupportRules, sections: int) -> dict[str, str]:
    own, cut = rules.territory == "own", f"tolerance {TOLERANCE:g} mm: {counted(sections, 'section')}"
    drifts = [f"{rules.drift_ratio:.3g} of the height"] if rules.drift_ratio > 0.0 else []
    drifts += [f"{rules.drift_mm:g} mm"] if rules.drift_mm > 0.0 else []
    margin = f"margin {rules.territory_margin_mm:g} mm, tolerance {territory.TOLERANCE:g} mm"
    known = {
        LEAST_WALL: f"{rules.least_wall_mm:g} mm, {cut}" if rules.least_wall_mm > 0.0 else "",
        LEAST_CONTACT: f"{rules.least_contact_mm2:g} mm2, {cut}" if rules.least_contact_mm2 > 0.0 else "",
        legs.PROMISE: f"length at most {rules.leg_ratio:g} times the width, by planes {legs.STEP:g} mm apart, "
        "tolerance one such distance"
        if rules.leg_ratio > 0.0
        else "",
        territory.PROMISE: margin if own else "",
        drift.PROMISE: f"{', at most '.join(drifts)}, tolerance one square of the grid"
        if own and drifts
        else "",
    }
    return {promise: text or f"{NOT_JUDGED}: no limit" for promise, text in known.items()}


def _coverage_extent(build: Build) -> str:
    """Return what the judge of coverage grants."""
    rules = build.settings.rules
    if not build.settings.supported:
        return f"{NOT_JUDGED}: the job asked for no supports"
    spacings = [sample_spacing(placed, build.supports, build.settings) for placed in build.parts]
    points = f"points at most {max(spacings, default=0.0):.2g} mm apart"
    if not rules.has_limits:
        return f"all overhangs flatter than {rules.overhang_angle_deg:g} degrees, {points}"
    sizes = f"ledges {rules.ledge_mm:g}, bridges {rules.bridge_mm:g}, bores {rules.bore_mm:g} mm"
    return f"{sizes} are carried, tolerance {GRANT_MM:g} mm, {points}"
