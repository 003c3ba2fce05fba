"""Say verdicts and findings in words."""

from typing import get_args

from amprep.geometry.overhangs.regions import Kind, OverhangRegion
from amprep.overhangs.verdicts import verdict_words
from amprep.report.triage.classes import RegionTriage
from amprep.report.triage.findings import Finding

REGION_KINDS = get_args(Kind)
"""Kinds of regions; their names say that they are overhangs."""


def region_words(region: OverhangRegion, found: RegionTriage) -> str:
    """Return the verdict on a region, for example ``ledge 6.0 mm over 1.0: not supported, enclosed``."""
    words = verdict_words(region, None if found.outcome == "not needed" else found.outcome)
    return f"{words}, {found.why}" if found.why else words


def finding_words(finding: Finding) -> str:
    """Return a finding with its name and position in one line."""
    kind = f"{finding.kind}: " if finding.kind not in REGION_KINDS else ""
    words = f"{kind}{finding.name}: {finding.words}"
    return (
        words
        if finding.position_mm is None or finding.kind == "violation"
        else f"{words}, at ({position_words(finding)}) mm"
    )


def position_words(finding: Finding, digits: int = 1) -> str:
    """Return the coordinates of a finding, separated by commas; empty if it has no place."""
    return ", ".join(f"{round(value, digits) + 0.0:.{digits}f}" for value in finding.position_mm or ())
