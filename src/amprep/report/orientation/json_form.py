"""The result of a search for orientations as JSON."""

from pathlib import Path
from typing import Any

from amprep.model.orientation import OrientationProposal
from amprep.report.json_values import plain, stages_json, write_json_file
from amprep.report.orientation.record import OrientationRecord, OrientedPart

FORMAT = 1
"""Version of the layout; it increases when a key changes its meaning or is removed."""


def to_json(record: OrientationRecord) -> dict[str, Any]:
    """Return the record as plain values."""
    return {
        "format": FORMAT,
        "amprep_version": record.version,
        "name": record.name,
        "printer": record.printer,
        "material": record.material,
        "lift_mm": record.lift_mm,
        "parts": [_part(each) for each in record.parts],
        "report_files": list(record.report_files),
        "warnings": list(record.warnings),
        "stages": stages_json(record.stages),
    }


def write_json(record: OrientationRecord, path: Path) -> None:
    """Write the record as a JSON file."""
    write_json_file(to_json(record), path)


def _part(each: OrientedPart) -> dict[str, Any]:
    return {
        "name": each.name,
        "source": each.part.source,
        "directions": each.tried,
        "drawn": _proposal(each.drawn),
        "proposals": [_proposal(proposal) for proposal in each.proposals],
    }


def _proposal(proposal: OrientationProposal) -> dict[str, Any]:
    figures = {**vars(proposal.figures), "box_mm3": proposal.figures.box_mm3}
    found = {
        "rotation": proposal.rotation,
        "tilt_deg": proposal.tilt_deg,
        "merits": proposal.merits,
        **figures,
    }
    return dict(plain(found))
