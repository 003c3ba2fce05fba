"""The report for programs: `job.report.json`, described in docs/report.md."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from amprep.measures.density import part_volume
from amprep.measures.height_profile import HeightProfile
from amprep.measures.legs import BodyLegs
from amprep.measures.printing.blade_edges import BladeEdge
from amprep.measures.removability import Removal, totals
from amprep.model import Build, Unsupported
from amprep.model.packing import PackingStep
from amprep.report.json_values import plain, pockets_json, stages_json, violations_json, write_json_file
from amprep.report.objective import gap_of, total_value
from amprep.report.printing import printing_json
from amprep.report.record import BuildRecord, RunRecord
from amprep.report.removal_order import removal_order_json
from amprep.report.triage.findings import findings_of
from amprep.report.triage.json_form import counts_json, findings_json, overhang_json

FORMAT = 2
"""Version of the layout; it increases when a key changes its meaning or is removed."""

_REMOVAL_KEYS = {
    "mass_g": "mass_g",
    "scan_mm2": "scanned_area_mm2",
    "contact_mm2": "contact_area_mm2",
    "contacts": "contact_patches",
    "trapped_mm3": "trapped_powder_mm3",
}
"""Field of `Removal` -> key."""


def to_json(record: RunRecord) -> dict[str, Any]:
    """Return a run as plain values: dicts, lists, strings, finite numbers, booleans and None."""
    fill, found = record.objective == "fill", findings_of(record)
    report = {
        "format": FORMAT,
        "amprep_version": record.version,
        "job": record.job,
        "printer": record.printer,
        "material": record.material or None,
        "target": record.target,
        "seed": record.seed,
        "objective": record.objective,
        "status": record.status,
        "stop_reason": record.stop_reason,
        "found_by": record.found_by or None,
        "reached": record.reached,
        "bound": record.bound,
        "bound_for": record.bound_for,
        "parts_bound": record.parts_bound,
        "packed_as": record.packed_as,
        "steps": [_step(step) for step in record.steps],
        "excess": dict(record.excess),
        "gap": gap_of(record),
        "total_value": total_value(record) if fill else None,
        "triage": counts_json(found),
        "findings": findings_json(found),
        "builds": [_build(entry, fill) for entry in record.builds],
        "unplaced": [vars(item) | {"value": item.value if fill else None} for item in record.unplaced],
        "stages": stages_json(record.stages),
        "warnings": list(record.warnings),
        "notes": list(record.notes),
        "by_default": list(record.by_default),
        "settings": dict(record.settings),
    }
    result: dict[str, Any] = plain(report)
    return result


def write_json(record: RunRecord, path: Path) -> None:
    """Write the report; the file appears complete, or not at all."""
    write_json_file(to_json(record), path)


def _step(step: PackingStep) -> dict[str, Any]:
    return {
        "method": step.method,
        "reached": step.reached,
        "height_mm": step.height,
        "seconds": step.seconds,
    }


def _build(entry: BuildRecord, fill: bool) -> dict[str, Any]:
    build = entry.build
    return {
        "id": build.settings.build_id,
        "file": entry.file,
        "sha256": entry.sha256,
        "picture": entry.picture,
        "stl_files": list(entry.stl_files),
        "build_volume_mm": build.settings.space.size,
        "build_volume_shape": build.settings.space.shape,
        "density": entry.density,
        "height_mm": entry.height_mm,
        "printing": printing_json(entry.printing),
        "blade_edges": [_blade_edge(edge, build) for edge in entry.blade_edges],
        "parts": [_part(entry, number, fill) for number in range(len(build.parts))],
        "supports": _supports(entry),
        "height_profile": _profile(entry.profile),
        "removal_order": removal_order_json(entry),
        "verified": entry.verification is not None,
        "pairs_judged": asdict(entry.pairs),
        "violations": violations_json(entry.verification or ()),
    }


def _blade_edge(edge: BladeEdge, build: Build) -> dict[str, Any]:
    return {**asdict(edge), "part": build.parts[edge.part].label}


def _profile(profile: HeightProfile) -> dict[str, Any]:
    return {
        "from_mm": profile.low,
        "spacing_mm": profile.spacing,
        "area_mm2": profile.areas.round(3),
        "mean_area_mm2": profile.mean,
        "variation": profile.variation,
        "largest": profile.largest,
        "largest_jump": profile.largest_jump,
    }


def _part(entry: BuildRecord, number: int, fill: bool) -> dict[str, Any]:
    placed, printing = entry.build.parts[number], entry.printing
    low, high = placed.mesh.bounds
    share = printing.shares[number] if printing.shares else None
    return {
        "name": placed.label,
        "part": placed.part.name,
        "part_number": placed.part.part_number,
        "source": placed.part.source,
        "source_sha256": placed.part.source_sha256,
        "transform": placed.matrix,
        "volume_mm3": part_volume(placed),
        "hours": None if share is None else share * printing.hours,
        "cost": None if share is None or printing.cost is None else share * printing.cost,
        "value": placed.part.fill_value if fill else None,
        "low_mm": low,
        "high_mm": high,
        "triangles": len(placed.part.mesh.triangles),
        "sha256": placed.part.mesh.digest,
    }


def _supports(entry: BuildRecord) -> dict[str, Any]:
    build = entry.build
    sums = totals(entry.removal)
    return {
        "volume_mm3": entry.support_volume_mm3,
        **{key: sums[name] for name, key in _REMOVAL_KEYS.items()},
        "overhangs": [overhang_json(region) for region in entry.overhangs],
        "demand_squares": entry.demand_squares,
        "unconnected_squares": [vars(square) for square in entry.unconnected],
        "unsupported_mm2": entry.unsupported_mm2,
        "unsupported_minor_mm2": entry.unsupported_minor_mm2,
        "unsupported": [_unsupported(entry, region) for region in build.unsupported],
        "bodies": [_body(entry, index) for index in range(len(build.supports))],
        "shared_supports": list(entry.shared_supports),
        "notes": list(entry.notes),
    }


def _unsupported(entry: BuildRecord, region: Unsupported) -> dict[str, Any]:
    return {
        "part": entry.build.parts[region.part].label,
        "region": region.label,
        "kind": region.kind,
        "reason": region.reason,
        "measure": region.measure,
        "minor": region.minor,
        "centre_mm": region.points.mean(axis=0) if len(region.points) else None,
    }


def _body(entry: BuildRecord, index: int) -> dict[str, Any]:
    body = entry.build.supports[index]
    return {
        "name": body.name,
        "parts": [entry.build.parts[index].label for index in body.parts],
        "surface": body.surface,
        "triangles": len(body.mesh.triangles),
        "volume_mm3": 0.0 if body.surface else abs(body.mesh.signed_volume),
        **(_legs(entry.legs[index]) if entry.legs else {}),
        **(_removal(entry.removal[index]) if entry.removal else {}),
    }


def _legs(legs: BodyLegs) -> dict[str, Any]:
    return {
        "legs": legs.total,
        "worst_leg": None if legs.worst is None else legs.worst._asdict(),
        "long_legs": [leg._asdict() for leg in legs.too_long],
    }


def _removal(removal: Removal) -> dict[str, Any]:
    return {
        **{key: getattr(removal, name) for name, key in _REMOVAL_KEYS.items()},
        "powder_resolution_mm": removal.resolution_mm,
        "pockets": None if removal.pockets is None else pockets_json(removal.pockets),
        "cavities": pockets_json(removal.cavities),
    }
