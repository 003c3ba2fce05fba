"""Make the data of the 3D view: names, colours, matrices and descriptions of each build's contents."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from amprep.arrays import Floats
from amprep.measures.density import build_height, part_volume
from amprep.model import (
    BoundingVolume,
    Boxes,
    Build,
    ConvexPieces,
    Mesh,
    PlacedPart,
    SupportBody,
)
from amprep.model.counting import counted
from amprep.model.mesh import join_meshes
from amprep.model.volume_meshes import meshes_of
from amprep.report.page.geometry import GeometryPack
from amprep.report.picture.colours import MARK_COLOURS, PALETTE, SUPPORT, VOLUME, part_colours
from amprep.report.picture.marks import mark_radius, thinned
from amprep.report.record import BuildRecord, RunRecord
from amprep.report.triage.classes import Triage
from amprep.report.triage.findings import Finding, findings_of
from amprep.report.triage.groups import grouped
from amprep.report.triage.words import position_words

MOST_MARKED = 300
"""Findings of one class and build that have a mark of their own in the 3D view."""


def view_model(record: RunRecord) -> tuple[dict[str, Any], str]:
    """Return the model as plain values, and the geometry in base64, of the 3D view."""
    pack = GeometryPack()
    findings = findings_of(record)
    builds = [
        _build(entry.build, _locks(entry), pack)
        | {
            "marks": _marks([each for each in findings if each.build == number], pack),
            "volumes": _packed(entry, pack),
        }
        for number, entry in enumerate(record.builds, start=1)
    ]
    return {"builds": builds, "meshes": pack.entries}, pack.base64()


def _locks(entry: BuildRecord) -> dict[int, str]:
    """Return the names of the parts with which a part is locked, by its index."""
    return {
        part: ", ".join(entry.build.parts[other].label for other in group if other != part)
        for group in entry.removal_order.locked
        for part in group
    }


def _build(build: Build, locks: dict[int, str], pack: GeometryPack) -> dict[str, Any]:
    space = build.settings.space
    return {
        "id": build.settings.build_id,
        "height": build_height(build),
        "space": {
            "size": space.size.tolist(),
            "shape": space.shape,
            "zones": np.stack([space.zone_lo, space.zone_hi], axis=1).tolist(),
        },
        "supportColour": SUPPORT,
        "parts": [
            _part(placed, colour, locks.get(index, ""), pack)
            for index, (placed, colour) in enumerate(zip(build.parts, part_colours(build), strict=True))
        ],
        "supports": [_support(body, build, pack) for body in build.supports],
    }


def _packed(entry: BuildRecord, pack: GeometryPack) -> list[dict[str, Any]]:
    """Return the bounding volumes of a build as one choice of the view; none if nothing was packed."""
    if not entry.volumes:
        return []
    names = [placed.label for placed in entry.build.parts]
    distinct = {id(each.volume): each.volume for each in entry.volumes}  # copies share their volume
    models = {
        key: volume_model(volume, np.eye(4), pack, "", _counted(volume)) for key, volume in distinct.items()
    }
    shown = [
        models[id(each.volume)]
        | {"name": f"bounding volume of {names[each.part]}", "matrix": each.matrix.ravel().tolist()}
        for each in entry.volumes
    ]
    return [{"name": "bounding volumes", "shown": shown}]


def volume_model(
    volume: BoundingVolume, matrix: Floats, pack: GeometryPack, name: str, facts: Sequence[str]
) -> dict[str, Any]:
    """Return the data of a bounding volume.

    Parameters
    ----------
    volume
        The bounding volume.
    matrix
        ``(4, 4)``, its coordinates to build coordinates.
    pack
        Collects its mesh.
    name, facts
        Shown when it is selected.
    """
    pieces = meshes_of(volume)
    return {
        "name": name,
        "mesh": pack.add(join_meshes(pieces)),
        "pieces": [len(piece.vertices) for piece in pieces],
        "colours": list(PALETTE) if len(pieces) > 1 else [VOLUME],
        "matrix": matrix.ravel().tolist(),
        "facts": list(facts),
    }


def _counted(volume: BoundingVolume) -> list[str]:
    if isinstance(volume, Boxes):
        return ["1 box" if len(volume.lo) == 1 else f"{len(volume.lo)} boxes"]
    if isinstance(volume, ConvexPieces):
        return [counted(len(volume.pieces), "convex piece")]
    return [f"solid of {len(volume.mesh.triangles)} triangles"]


def _part(placed: PlacedPart, colour: str, locked_with: str, pack: GeometryPack) -> dict[str, Any]:
    low, high = placed.mesh.bounds
    facts = [
        " × ".join(f"{size:.1f}" for size in high - low) + f" mm, {part_volume(placed) / 1000:.2f} cm³",
        "lowest corner at x {:.2f}, y {:.2f}, z {:.2f} mm".format(*low),
    ]
    if placed.part.part_number:
        facts.append(f"part number {placed.part.part_number}")
    if locked_with:
        facts.append(f"locked with {locked_with}")
    return {
        "name": placed.label,
        "colour": colour,
        "mesh": pack.add(placed.part.mesh),
        "matrix": placed.matrix.ravel().tolist(),
        "facts": facts,
    }


def _support(body: SupportBody, build: Build, pack: GeometryPack) -> dict[str, Any]:
    size = "walls without thickness" if body.surface else f"{abs(body.mesh.signed_volume) / 1000:.2f} cm³"
    held = ", ".join(build.parts[index].label for index in body.parts)
    return {
        "name": body.name,
        "surface": body.surface,
        "mesh": pack.add(body.mesh),
        "facts": [f"{size}, {len(body.mesh.triangles)} triangles", f"supports {held}"],
    }


def _marks(findings: Sequence[Finding], pack: GeometryPack) -> list[dict[str, Any]]:
    """Return the marks of what must be fixed, then of what is worth a check; those beyond the most are one mark."""
    marks: list[dict[str, Any]] = []
    for triage, colour in MARK_COLOURS.items():
        found = [each for group in grouped(findings) for each in group.findings if each.triage == triage]
        placed = [each for each in found if len(each.points)]
        marks += [_mark(each, colour, pack) for each in placed[:MOST_MARKED]]
        if rest := placed[MOST_MARKED:]:
            marks.append(_common_mark(triage, rest, colour, pack))
    return marks


def _mark(finding: Finding, colour: str, pack: GeometryPack) -> dict[str, Any]:
    return {
        "name": finding.name,
        "triage": finding.triage,
        "colour": colour,
        "points": pack.add(Mesh(thinned(finding.points), np.empty((0, 3), np.int32))),
        "radius": mark_radius(finding.radius),
        "facts": [finding.words, f"at {position_words(finding)} mm"],
    }


def _common_mark(
    triage: Triage, findings: Sequence[Finding], colour: str, pack: GeometryPack
) -> dict[str, Any]:
    """Return one mark with a point of each of many findings."""
    points = np.stack([each.points[0] for each in findings])
    return {
        "name": f"{len(findings)} more",
        "triage": triage,
        "colour": colour,
        "points": pack.add(Mesh(points, np.empty((0, 3), np.int32))),
        "radius": mark_radius(1.0),
        "facts": ["each is in the tables below or in the JSON report"],
    }
