"""Make the data of the 3D view: names, colours, matrices and descriptions of each build's contents."""

from typing import Any

import numpy as np

from amprep.measures.density import build_height, part_volume
from amprep.model import Build, Mesh, PlacedPart, SupportBody, Unsupported
from amprep.report.page.geometry import GeometryPack
from amprep.report.picture.colours import SUPPORT, part_colours
from amprep.report.picture.marks import mark_radius, thinned
from amprep.report.record import RunRecord


def view_model(record: RunRecord) -> tuple[dict[str, Any], str]:
    """Return the model as plain values, and the geometry in base64, of the 3D view."""
    pack = GeometryPack()
    builds = [_build(entry.build, pack) for entry in record.builds]
    return {"builds": builds, "meshes": pack.entries}, pack.base64()


def _build(build: Build, pack: GeometryPack) -> dict[str, Any]:
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
            _part(placed, colour, pack)
            for placed, colour in zip(build.parts, part_colours(build), strict=True)
        ],
        "supports": [_support(body, build, pack) for body in build.supports],
        "unsupported": [_unsupported(region, pack) for region in build.unsupported],
    }


def _part(placed: PlacedPart, colour: str, pack: GeometryPack) -> dict[str, Any]:
    low, high = placed.mesh.bounds
    facts = [
        " × ".join(f"{size:.1f}" for size in high - low) + f" mm, {part_volume(placed) / 1000:.2f} cm³",
        "lowest corner at x {:.2f}, y {:.2f}, z {:.2f} mm".format(*low),
    ]
    if placed.part.part_number:
        facts.append(f"part number {placed.part.part_number}")
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


def _unsupported(region: Unsupported, pack: GeometryPack) -> dict[str, Any]:
    unit = {"face": " mm²", "edge": " mm"}.get(region.kind)
    size = f"{region.kind}, {region.measure:.2f}{unit}" if unit else region.kind
    points = thinned(region.points)
    marks = pack.add(Mesh(points, np.empty((0, 3), np.int32))) if len(points) else -1
    return {
        "name": region.label,
        "reason": region.reason,
        "points": marks,
        "radius": mark_radius(region.radius),
        "facts": [size, region.reason],
    }
