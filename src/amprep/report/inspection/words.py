"""Say figures of an inspection in words, for the terminal, the page and pictures."""

from collections.abc import Iterator, Sequence

import numpy as np

from amprep.measures.contents import MeshContents
from amprep.measures.overhangs import OverhangFigures
from amprep.measures.thin_walls import ThinWall
from amprep.model import Part
from amprep.model.counting import counted
from amprep.report.inspection.record import InspectedFile, InspectedPart, InspectedVolume
from amprep.report.triage.region_words import kinds_in_words


def file_words(file: InspectedFile) -> str:
    """Return path, reader, size and unit of a file, or why it cannot be read."""
    if file.problem:
        return file.problem
    unit = "no unit in the file, taken as millimetres" if file.unit == "none" else f"unit {file.unit}"
    return f"{file.path}: {file.reader}, {_bytes(file.size_bytes)}, {unit}, {counted(file.parts, 'part')}"


def contents_words(part: Part, contents: MeshContents) -> Iterator[tuple[str, str]]:
    """Yield the name and the value of each figure of a mesh."""
    yield "size", " x ".join(f"{side:.2f}" for side in contents.size_mm) + " mm"
    yield "lowest corner", "({:.2f}, {:.2f}, {:.2f}) mm".format(*contents.low_mm)
    if contents.volume_mm3 is not None:
        yield "volume", f"{contents.volume_mm3 / 1000:.3f} cm³"
    yield "surface", f"{contents.area_mm2 / 100:.2f} cm²"
    yield "mesh", f"{contents.triangles} triangles, {contents.vertices} vertices"
    yield "topology", _topology(contents)
    yield "quantity", f"{part.quantity}"
    if part.value is not None:
        yield "value", f"{part.value:g}"
    allowed = part.orientations
    listed = (
        "as it lies only"
        if (allowed.matrices == np.eye(3)).all()
        else counted(len(allowed.matrices), "rotation")
    )
    yield "orientations", listed if allowed.freedom == "list" else allowed.freedom
    if part.part_number:
        yield "part number", part.part_number
    if part.appearance.material:
        yield "material", part.appearance.material
    if part.appearance.colour:
        yield "colour", part.appearance.colour
    if part.regions:
        yield "regions", ", ".join(f"{region.kind} {region.name!r}" for region in part.regions)


def overhang_words(found: OverhangFigures) -> Iterator[tuple[str, str]]:
    """Yield what needs support, and what does not, with the reason."""
    yield (
        "needs support",
        ", ".join(
            [
                f"{found.faces_mm2:.1f} mm² in {counted(found.face_regions, 'face region')}",
                f"{counted(found.edge_regions, 'knife edge')} ({found.edges_mm:.1f} mm)",
                counted(found.tips, "tip"),
            ]
        ),
    )
    needed = [region for region in found.regions if not region.is_self_supporting]
    if needed:
        yield "needing support by kind", kinds_in_words(needed)
    if found.carried_regions:
        carried = counted(found.carried_regions, "region")
        yield (
            "self-supporting",
            f"{carried}, {found.carried_mm2:.1f} mm² of faces that the part itself carries",
        )
        own = [region for region in found.regions if region.is_self_supporting and not region.is_noncritical]
        yield "self-supporting by kind", kinds_in_words(own)
    noncritical = [region for region in found.regions if region.is_noncritical]
    if noncritical:
        yield "worth a check", f"{kinds_in_words(noncritical)}, steeper than the overhang angle, not critical"
    yield "steep enough", f"{found.steep_mm2:.1f} mm² of downward faces"
    yield "on the plate", f"{found.on_plate_mm2:.1f} mm²"
    if found.enforced_mm2:
        yield "enforced", f"{found.enforced_mm2:.1f} mm²"
    if found.blocked_mm2:
        yield "blocked", f"{found.blocked_mm2:.1f} mm²"


def wall_words(walls: Sequence[ThinWall]) -> Iterator[tuple[str, str]]:
    """Yield the area of thin walls; nothing for a surface."""
    if walls:
        areas = [f"{wall.area_mm2:.1f} mm² below {wall.below_mm:g} mm" for wall in walls if wall.area_mm2]
        yield "thin walls", ", ".join(areas) or f"none below {walls[-1].below_mm:g} mm"


def printer_words(part: InspectedPart, most: int | None = None) -> Iterator[tuple[str, str]]:
    """Yield each way in which the part fits printers, and their names, at most `most` of them."""
    for way in sorted({each.fit for each in part.printers}, key=_WAYS.index):
        names = [each.printer for each in part.printers if each.fit == way]
        shown = ", ".join(names[:most])
        left = len(names) - len(names[:most])
        count = (
            f"{len(names)} of {counted(len(part.printers), 'printer')}: " if len(part.printers) > 1 else ""
        )
        name = way if way == "does not fit" else f"fits {way}"
        yield name, f"{count}{shown}{f' and {left} more' if left else ''}"


def ratio_words(volume: InspectedVolume) -> str:
    """Return the ratio of the volume to that of the part."""
    return "-" if volume.ratio is None else f"{volume.ratio:.3f}"


def gap_words(volume: InspectedVolume) -> str:
    """Return the gap to the bound in per cent; empty if there is no bound."""
    return "" if volume.gap is None else f"{100 * volume.gap:.1f} %"


def shape_words(volume: InspectedVolume) -> str:
    """Return for example ``box``, ``3 boxes`` or ``solid``."""
    return f"{volume.pieces} {volume.kind}" if volume.pieces > 1 else volume.kind.removesuffix("s")


def volume_words(volume: InspectedVolume) -> str:
    """Return kind, pieces and ratio of a bounding volume in one line."""
    if volume.made is None:
        return volume.failure
    ratio = "" if volume.ratio is None else f", {volume.ratio:.3f} of the part's volume"
    turned = "" if (abs(volume.made.rotation.diagonal() - 1.0) < 1e-9).all() else ", turned"
    return f"{shape_words(volume)}, {counted(volume.triangles, 'triangle')}{ratio}{turned}, {volume.verdict}"


def _topology(contents: MeshContents) -> str:
    if contents.genus is None:
        return f"surface, not closed: {counted(contents.open_edges, 'open edge')}"
    bodies = "1 body" if contents.bodies == 1 else f"{contents.bodies} bodies"
    cavities = "no cavity" if not contents.cavities else f"closed cavities: {contents.cavities}"
    return f"closed, {bodies}, {cavities}, genus {contents.genus}"


def _bytes(size: int) -> str:
    return f"{size / 1e6:.1f} MB" if size >= 1e6 else f"{max(size / 1e3, 0.1):.1f} kB"


_WAYS = ("as it lies", "in an allowed orientation", "in another orientation", "does not fit")
