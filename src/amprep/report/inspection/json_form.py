"""The report of an inspection for programs, described in docs/inspect.md."""

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from amprep.measures.overhangs import OverhangFigures
from amprep.model import Boxes, Part, TurnedVolume
from amprep.overhangs.verdicts import verdict_words
from amprep.report.inspection.record import InspectedPart, InspectedVolume, InspectionRecord
from amprep.report.json_values import plain, stages_json, violations_json, write_json_file
from amprep.report.triage.json_form import region_json

FORMAT = 1
"""Version of the layout; it increases when a key changes its meaning or is removed."""


def to_json(record: InspectionRecord) -> dict[str, Any]:
    """Return an inspection as plain values: dicts, lists, strings, finite numbers, booleans and None."""
    report = {
        "format": FORMAT,
        "amprep_version": record.version,
        "clearance_mm": record.clearance_mm,
        "lift_mm": record.lift_mm,
        "files": [asdict(file) for file in record.files],
        "parts": [_part(each) for each in record.parts],
        "report_files": list(record.report_files),
        "stages": stages_json(record.stages),
        "warnings": list(record.warnings),
    }
    result: dict[str, Any] = plain(report)
    return result


def write_json(record: InspectionRecord, path: Path) -> None:
    """Write the report; the file appears complete, or not at all."""
    write_json_file(to_json(record), path)


def _part(each: InspectedPart) -> dict[str, Any]:
    return {
        "name": each.name,
        "source": each.part.source,
        "solid": each.part.is_solid and each.contents is not None,
        **_settings(each.part),
        "mesh": None if each.contents is None else asdict(each.contents),
        "problems": list(each.problems),
        "findings": list(each.findings),
        "overhangs": None if each.overhangs is None else _overhangs(each.overhangs),
        "thin_walls": [asdict(wall) for wall in each.walls],
        "printers": [asdict(fit) for fit in each.printers],
        "volumes": [_volume(volume) for volume in each.volumes],
    }


def _overhangs(found: OverhangFigures) -> dict[str, Any]:
    regions = [{"verdict": verdict_words(region), **region_json(region)} for region in found.regions]
    return asdict(replace(found, regions=())) | {"regions": regions}


def _settings(part: Part) -> dict[str, Any]:
    allowed = part.orientations
    return {
        "quantity": part.quantity,
        "value": part.value,
        "part_number": part.part_number,
        "material": part.appearance.material,
        "colour": part.appearance.colour,
        "orientations": len(allowed.matrices) if allowed.freedom == "list" else allowed.freedom,
        "regions": [{"kind": region.kind, "name": region.name} for region in part.regions],
    }


def _volume(each: InspectedVolume) -> dict[str, Any]:
    made = each.made
    return {
        "makers": each.makers,
        "kind": each.kind,
        "volume_mm3": None if made is None else each.volume_mm3,
        "ratio": each.ratio,
        "pieces": each.pieces,
        "triangles": each.triangles,
        "seconds": round(each.seconds, 4),
        "bound_mm3": each.bound_mm3,
        "gap": each.gap,
        "rotation": None if made is None else made.rotation,
        "boxes": None if made is None else _boxes(made),
        "contains_part": None if made is None else not each.violations,
        "violations": violations_json(each.violations),
        "failure": each.failure,
        "picture": each.picture,
    }


def _boxes(made: TurnedVolume) -> list[list[float]] | None:
    """Return x0, y0, z0, x1, y1, z1 of each box, as a job file takes them; None for other volumes."""
    if not isinstance(made.volume, Boxes):
        return None
    return [[*lo, *hi] for lo, hi in zip(made.volume.lo.tolist(), made.volume.hi.tolist(), strict=True)]
