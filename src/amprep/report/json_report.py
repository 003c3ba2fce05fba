"""The report for programs: `job.report.json`, described in docs/report.md."""

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np

from amprep.files import replacing
from amprep.geometry.powder.pockets import Pocket
from amprep.measures.density import part_volume
from amprep.measures.removability import Removal, totals
from amprep.model import PlacedPart, Unsupported
from amprep.report.record import BuildRecord, OverhangRecord, RunRecord, UnconnectedRecord

FORMAT = 1
"""Version of the layout; grows when a key changes its meaning or goes."""
NUMBERS = re.compile(r"\[\n[-+.\deE,\s]+\n\s*\]")
"""A list of numbers over several lines; strings hold no raw line ends, so none is ever inside one."""


def to_json(record: RunRecord) -> dict[str, Any]:
    """Return the run as plain values: dicts, lists, strings, finite numbers, booleans and None."""
    report = {
        "format": FORMAT,
        "amprep": record.version,
        "job": record.job,
        "printer": record.printer,
        "target": record.target,
        "seed": record.seed,
        "objective": record.objective,
        "status": record.status,
        "stop_reason": record.stop_reason,
        "bound": record.bound,
        "builds": [_build(entry) for entry in record.builds],
        "unplaced": [
            {"name": item.name, "copy": item.copy, "reason": item.reason} for item in record.unplaced
        ],
        "stages": [{"name": stage.name, "seconds": round(stage.seconds, 3)} for stage in record.stages],
        "warnings": list(record.warnings),
        "notes": list(record.notes),
        "settings": dict(record.settings),
    }
    result: dict[str, Any] = plain(report)
    return result


def json_text(record: RunRecord) -> str:
    """Return the report as JSON text, matrices and points on one line each."""
    text = json.dumps(to_json(record), indent=2, ensure_ascii=False, allow_nan=False)
    return NUMBERS.sub(lambda found: " ".join(found[0].split()), text) + "\n"


def write_json(record: RunRecord, path: Path) -> None:
    """Write the report; the file is whole or not there."""
    with replacing(path) as temporary:
        temporary.write_bytes(json_text(record).encode("utf-8", "backslashreplace"))


def _build(entry: BuildRecord) -> dict[str, Any]:
    build = entry.build
    return {
        "id": build.settings.build_id,
        "file": entry.file,
        "picture": entry.picture,
        "stl": list(entry.stl_files),
        "space_mm": build.settings.space.size,
        "space_shape": build.settings.space.shape,
        "density": entry.density,
        "height_mm": entry.height_mm,
        "parts": [_part(placed) for placed in build.parts],
        "supports": {
            "volume_mm3": entry.support_volume_mm3,
            "material": entry.support_material,
            **totals(entry.removal),
            "overhangs": [_overhang(region) for region in entry.overhangs],
            "red": entry.red,
            "unconnected": [_unconnected(square) for square in entry.unconnected],
            "unsupported_mm2": entry.unsupported_mm2,
            "minor_mm2": entry.minor_mm2,
            "unsupported": [_unsupported(entry, region) for region in build.unsupported],
            "bodies": [_body(entry, index) for index in range(len(build.supports))],
            "shared": list(entry.shared),
            "notes": list(entry.notes),
        },
        "verified": entry.verification is not None,
        "violations": [
            {"promise": found.promise, "subject": found.subject, "message": found.message}
            for found in entry.verification or ()
        ],
    }


def _part(placed: PlacedPart) -> dict[str, Any]:
    low, high = placed.mesh.bounds
    return {
        "name": placed.label,
        "part": placed.part.name,
        "part_number": placed.part.part_number,
        "source": placed.part.source,
        "transform": placed.matrix,
        "volume_mm3": part_volume(placed),
        "low_mm": low,
        "high_mm": high,
        "triangles": len(placed.part.mesh.triangles),
        "sha256": placed.recorded_digest,
    }


def _unconnected(square: UnconnectedRecord) -> dict[str, Any]:
    return {
        "part": square.part,
        "region": square.region,
        "reason": square.reason,
        "square": list(square.square),
        "position_mm": list(square.position_mm),
    }


def _overhang(region: OverhangRecord) -> dict[str, Any]:
    measures = {"face": "area_mm2", "edge": "length_mm", "tip": "height_mm"}
    return {
        "name": region.name,
        "part": region.part,
        "kind": region.kind,
        **{key: region.measure if kind == region.kind else None for kind, key in measures.items()},
        "position_mm": list(region.position_mm),
        "red": region.red,
        "connected": region.connected,
        "held": region.held,
        "reasons": list(region.reasons),
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
    columns = entry.columns[index]._asdict() if entry.columns else {}
    return {
        "name": body.name,
        "parts": [entry.build.parts[index].label for index in body.parts],
        "surface": body.surface,
        "triangles": len(body.mesh.triangles),
        "volume_mm3": 0.0 if body.surface else abs(body.mesh.signed_volume),
        **columns,
        **(_removal(entry.removal[index]) if entry.removal else {}),
    }


def _removal(removal: Removal) -> dict[str, Any]:
    pockets = removal.pockets
    return {
        "mass_g": removal.mass_g,
        "scan_mm2": removal.scan_mm2,
        "contact_mm2": removal.contact_mm2,
        "contacts": removal.contacts,
        "trapped_mm3": removal.trapped_mm3,
        "resolution_mm": removal.resolution_mm,
        "pockets": None if pockets is None else [_pocket(pocket) for pocket in pockets],
    }


def _pocket(pocket: Pocket) -> dict[str, Any]:
    return {
        "volume_mm3": pocket.volume,
        "position_mm": pocket.point,
        "low_mm": pocket.lo,
        "high_mm": pocket.hi,
        "closed": pocket.closed,
    }


def plain(value: Any) -> Any:
    """Return numpy values, mappings and tuples as plain ones; a number that is not finite becomes None."""
    if isinstance(value, dict):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner) for inner in value]
    if isinstance(value, (set, frozenset)):
        return sorted(map(str, value))
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist())
    if isinstance(value, float):
        return value + 0.0 if math.isfinite(value) else None
    return value if value is None or isinstance(value, (bool, int, str)) else str(value)
