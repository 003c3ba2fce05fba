"""The slices of a build as JSON."""

from typing import Any

from amprep.report.slices.record import SliceRecord


def to_json(record: SliceRecord) -> dict[str, Any]:
    """Return a record as JSON values."""
    return {
        "build": record.build,
        "layer_mm": record.layer_mm,
        "layers": record.layers,
        "files": list(record.files),
        "bodies": [
            {
                "name": each.name,
                "role": each.role,
                "contours": each.contours,
                "volume_mm3": each.volume_mm3,
                "sliced_mm3": float(each.area_mm2.sum()) * record.layer_mm,
                "lines_mm": each.lines_mm,
                "has_beams": each.has_beams,
            }
            for each in record.bodies
        ],
        "parts_area_mm2": [round(value, 4) for value in record.area_mm2("part").tolist()],
        "supports_area_mm2": [round(value, 4) for value in record.area_mm2("support").tolist()],
    }
