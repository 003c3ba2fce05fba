"""Say verdicts and findings in words."""

from typing import get_args

from amprep.geometry.overhangs.regions import Kind, OverhangRegion
from amprep.report.triage.classes import SUPPORTED, RegionTriage
from amprep.report.triage.findings import Finding

REGION_KINDS = get_args(Kind)
"""Kinds of regions; their names say that they are overhangs."""


def region_words(verdict: str, found: RegionTriage) -> str:
    """Return the verdict on a region with its support, for example ``ledge 6.0 mm over 1.0: supported``."""
    if found.triage == SUPPORTED:
        return f"{verdict}: supported"
    return f"{verdict}; {found.why}" if found.why else verdict


def finding_words(finding: Finding) -> str:
    """Return a finding with its name and position in one line."""
    kind = f"{finding.kind}: " if finding.kind not in REGION_KINDS else ""
    words = f"{kind}{finding.name}: {finding.words}"
    return words if finding.position_mm is None else f"{words}, at ({position_words(finding)}) mm"


def position_words(finding: Finding, digits: int = 1) -> str:
    """Return the coordinates of a finding, separated by commas; empty if it has no place."""
    return ", ".join(f"{round(value, digits) + 0.0:.{digits}f}" for value in finding.position_mm or ())


def verdict_words(region: OverhangRegion) -> str:
    """Return what a region is, for example ``ledge 6.0 mm over 1.0``."""
    start = ", starts in the air" if region.starts_in_air else ""
    if region.is_self_supporting:
        return f"self-supporting: {region.kind} {region.size_mm:.1f} mm"
    size = f" {region.size_mm:.1f} mm over {region.limit_mm:g}" if region.size_mm > 0.0 else ""
    return f"{region.kind}{size}{start}"
