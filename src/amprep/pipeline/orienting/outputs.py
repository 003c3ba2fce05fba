"""Write the files of a search for orientations: a page, a JSON report, and a picture of each part."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from amprep.job import Job
from amprep.model import Progress
from amprep.orienting.measure import overhang_mesh, stood
from amprep.pipeline.outputs import OutputFolder, safe_name
from amprep.report.orientation.picture import ShownOrientation
from amprep.report.orientation.record import OrientationRecord, OrientedPart
from amprep.report.orientation.terminal import rows


def write_orientations(
    record: OrientationRecord, job: Job, folder: Path, progress: Progress
) -> OrientationRecord:
    """Write all files of a search and return the record with their names.

    Raises
    ------
    InputError
        When the folder cannot be written.
    """
    from amprep.report.orientation.json_form import write_json
    from amprep.report.orientation.page import write_page
    from amprep.report.orientation.picture import draw_orientations

    with OutputFolder(folder, f"{record.name}.orient") as outputs:
        shown, pictures, names = [], [], []
        for number, part in enumerate(record.parts):
            progress(number / (len(record.parts) + 1), part.name)
            shown.append(list(_shown(part, job)))
            suffix = f"{number + 1}.{safe_name(part.name)}.png" if len(record.parts) > 1 else "png"
            path = outputs.path(suffix)
            draw_orientations(shown[-1], path)
            pictures.append(path.read_bytes())
            names.append(outputs.name(suffix))
        record = replace(record, report_files=(outputs.name("html"), outputs.name("json"), *names))
        write_page(record, shown, pictures, outputs.path("html"))
        write_json(record, outputs.path("json"))
        outputs.publish()
    return record


def _shown(part: OrientedPart, job: Job) -> Iterator[ShownOrientation]:
    lift = job.packing.lift_mm
    for name, proposal in rows(part):
        mesh = stood(part.part, proposal.rotation, lift).mesh
        yield ShownOrientation(name, mesh, overhang_mesh(part.part, proposal.rotation, job.supports, lift))
