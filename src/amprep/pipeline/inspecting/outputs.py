"""Write the files of an inspection: pictures, a page and a JSON report."""

from dataclasses import replace
from pathlib import Path

from amprep.model import Progress
from amprep.pipeline.outputs import OutputFolder, safe_name
from amprep.report.inspection.record import InspectedPart, InspectedVolume, InspectionRecord


def write_inspection(record: InspectionRecord, folder: Path, progress: Progress) -> InspectionRecord:
    """Write all files of an inspection and return the record with their names.

    Raises
    ------
    InputError
        When the folder cannot be written.
    """
    from amprep.report.inspection.json_form import write_json
    from amprep.report.inspection.page import write_page

    with OutputFolder(folder, f"{record.name}.inspect") as outputs:
        parts = []
        for number, each in enumerate(record.parts):
            progress(number / (len(record.parts) + 1), each.name)
            prefix = f"{safe_name(each.name)}." if len(record.parts) > 1 else ""
            drawn = tuple(_drawn(each, volume, prefix, outputs) for volume in each.volumes)
            parts.append(replace(each, volumes=drawn))
        pictures = [volume.picture for each in parts for volume in each.volumes if volume.picture]
        names = (outputs.name("html"), outputs.name("json"))
        record = replace(record, parts=tuple(parts), report_files=(*names, *pictures))
        write_page(record, outputs.path("html"))
        write_json(record, outputs.path("json"))
        outputs.publish()
    return record


def _drawn(
    each: InspectedPart, volume: InspectedVolume, prefix: str, outputs: OutputFolder
) -> InspectedVolume:
    """Write the picture of a bounding volume and return the volume with its name, which begins with `prefix`."""
    from amprep.report.inspection.picture import draw_volume
    from amprep.report.inspection.words import volume_words

    if volume.made is None:
        return volume
    suffix = f"{prefix}{safe_name(volume.makers.replace(',', '-'))}.png"
    title = f"{each.name}   ·   {volume.makers}"
    draw_volume(each.part.mesh, volume.made, title, volume_words(volume), outputs.path(suffix))
    return replace(volume, picture=outputs.name(suffix))
