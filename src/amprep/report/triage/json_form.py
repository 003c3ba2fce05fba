"""Findings and regions of overhangs in the report for programs, described in docs/report.md."""

from collections.abc import Sequence
from typing import Any

from amprep.geometry.overhangs.regions import NOT_FACES, OverhangRegion
from amprep.report.record import OverhangRecord
from amprep.report.triage.classes import CHECK, MUST_FIX
from amprep.report.triage.findings import Finding
from amprep.report.triage.groups import count_by_triage


def counts_json(findings: Sequence[Finding]) -> dict[str, int]:
    """Return the number of findings of each class."""
    return {triage.replace(" ", "_").replace("-", "_"): n for triage, n in count_by_triage(findings).items()}


def findings_json(findings: Sequence[Finding]) -> list[dict[str, Any]]:
    """Return what must be fixed, then what is worth a check."""
    return [
        {
            "triage": each.triage,
            "build": each.build or None,
            "part": each.part,
            "kind": each.kind,
            "name": each.name,
            "message": each.words,
            "position_mm": each.position_mm,
        }
        for triage in (MUST_FIX, CHECK)
        for each in findings
        if each.triage == triage
    ]


def overhang_json(record: OverhangRecord) -> dict[str, Any]:
    """Return a region of overhangs of a build with its verdict."""
    return {
        "name": record.name,
        "part": record.part,
        "triage": record.triage,
        "verdict": record.verdict,
        **region_json(record.region),
        "demand_squares": record.demand_squares,
        "connected_squares": record.connected_squares,
        "supported": record.supported,
        "reasons": record.reasons,
    }


def region_json(region: OverhangRegion) -> dict[str, Any]:
    """Return kind, sizes and position of a region of overhangs."""
    is_face = region.kind not in NOT_FACES
    return {
        "kind": region.kind,
        "size_mm": region.size_mm,
        "limit_mm": region.limit_mm,
        "angle_deg": region.angle_deg if is_face else None,
        "lowest_mm": region.lowest_mm,
        "starts_in_air": region.starts_in_air,
        "area_mm2": region.measure if is_face else None,
        "length_mm": region.measure if region.kind == "edge" else None,
        "height_mm": region.centre[2] if region.kind == "tip" else None,
        "position_mm": region.centre,
    }
