"""Judge what the target of a build file would print: each part and support once, as recorded, and nothing else."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE
from amprep.checks.packing.parts_placed import ROUNDING
from amprep.checks.printed.found import PrintedBeams, PrintedBody, PrintedFile, PrintedKind
from amprep.checks.violation import Violation, place_words
from amprep.geometry.meshes.topology import drop_unused_vertices, edges_match
from amprep.model.build import Build, BuildSettings, Lattice, PlacedPart, SupportBody
from amprep.model.mesh import Mesh

PROMISE = "printed as planned"

_WORDS: dict[PrintedKind, str] = {
    "model": "as a part",
    "support": "as a support",
    "open support": "as a support that is not filled",
    "surface": "as a surface that is not filled",
    "negative": "as a negative volume, which removes material",
    "modifier": "as a modifier, which prints nothing",
    "blocker": "as a support blocker, which prints nothing",
    "enforcer": "as a support enforcer, which prints nothing",
}


@dataclass(frozen=True, eq=False)
class _Claim:
    """A part or support that the file must print."""

    name: str
    kind: PrintedKind
    mesh: Mesh
    lattice: Lattice | None = None


def check_as_printed(build: Build, printed: PrintedFile) -> list[Violation]:
    """Return where the target of a file would print something else than the build.

    A body is what the build claims if it has the same triangles in the same order, with vertices at most `ROUNDING`
    away, and the same beams. Beams must have round caps and no balls of their own; they may be
    clipped by a box outside which no beam ends.

    Parameters
    ----------
    build
        The build that the file's metadata describes.
    printed
        What the target of the file would make of it.
    """
    if printed.unit_mm != 1.0:
        message = (
            f"{printed.program} would print everything {printed.unit_mm:g} times as large: the unit is not mm"
        )
        return [Violation(PROMISE, build.settings.build_id, message)]
    found = [Violation(PROMISE, build.settings.build_id, each) for each in printed.remarks]
    left = list(printed.bodies)
    claims = _claims(build)
    missing = []
    for claim in claims:
        index = _index_of(claim, left)
        if index is None:
            missing.append(claim)
            continue
        body = left.pop(index)
        found += [
            Violation(PROMISE, claim.name, f"{printed.program} {fault}") for fault in _faults(claim, body)
        ]
    found += [_not_found(claim, left, printed) for claim in missing]
    found += [
        Violation(
            PROMISE, body.name or "unnamed", f"{printed.program} would print it, but no part or support is so"
        )
        for body in left
        if body.kind != "nothing"
    ]
    return found


def _claims(build: Build) -> list[_Claim]:
    parts = [_Claim(each.label, _kind_of_part(each, build.settings), each.mesh) for each in build.parts]
    return parts + [
        _Claim(
            each.name,
            _kind_of_support(each, build.settings),
            each.mesh if each.lattice is None else each.lattice.solids,
            each.lattice,
        )
        for each in build.supports
    ]


def _kind_of_part(placed: PlacedPart, settings: BuildSettings) -> PrintedKind:
    return "model" if placed.part.is_solid or settings.target == "prusaslicer" else "surface"


def _kind_of_support(support: SupportBody, settings: BuildSettings) -> PrintedKind:
    """Return as what the dialect of a target prints supports."""
    if support.surface:
        return "open support"
    as_model = settings.target == "generic" and settings.supports_as == "model"
    return "model" if as_model or settings.target == "prusaslicer" else "support"


def _index_of(claim: _Claim, bodies: Sequence[PrintedBody]) -> int | None:
    """Return the index of the first body with the geometry of a claim; beams are judged afterwards."""
    for index, body in enumerate(bodies):
        if (body.beams is None) == (claim.lattice is None) and _same_mesh(claim.mesh, _solids(body)):
            return index
    return None


def _solids(body: PrintedBody) -> Mesh:
    """Return the mesh of a body, without vertices that only beams use."""
    if body.beams is None:
        return body.mesh
    return Mesh(*drop_unused_vertices(*body.mesh.arrays))


def _same_mesh(one: Mesh, other: Mesh) -> bool:
    if one.vertices.shape != other.vertices.shape or one.triangles.shape != other.triangles.shape:
        return False
    if not len(one.vertices):
        return True
    near = bool(np.abs(one.vertices - other.vertices).max() <= ROUNDING)
    return near and np.array_equal(one.triangles, other.triangles)


def _faults(claim: _Claim, body: PrintedBody) -> list[str]:
    """Return what is wrong with a body that has the right mesh."""
    found = []
    if body.kind == "nothing":
        found.append("would not print it")
    elif body.kind != claim.kind:
        found.append(f"would print it {_WORDS[body.kind]} instead of {_WORDS[claim.kind]}")
    if claim.lattice is not None and body.beams is not None:
        found += _faults_of_beams(claim.lattice, body.beams)
    return found


def _faults_of_beams(lattice: Lattice, beams: PrintedBeams) -> list[str]:
    ends = lattice.nodes[lattice.struts]
    if len(ends) != len(beams.ends):
        return [f"would print {len(beams.ends)} of its {len(ends)} beams"]
    found = []
    if len(ends) and np.abs(ends - beams.ends).max() > ROUNDING:
        found.append("would print beams at other places")
    if len(ends) and np.abs(lattice.radii - beams.radii).max() > ROUNDING:
        found.append("would print beams of other radii")
    if not beams.round_caps.all():
        found.append("would print beams without balls at their ends")
    if beams.has_balls:
        found.append("would print balls at nodes of beams")
    return found + _faults_of_clipping(beams)


def _faults_of_clipping(beams: PrintedBeams) -> list[str]:
    """Judge the mesh that clips beams: a box, from which no beam ends outside."""
    if beams.clipping is None:
        return []
    if not beams.keeps_inside:
        return ["would remove the beams inside their clipping mesh"]
    low, high = beams.clipping.bounds if len(beams.clipping.triangles) else (np.zeros(3), np.zeros(3))
    volume = float(np.prod(high - low))
    is_closed = edges_match(beams.clipping.triangles)
    if not is_closed or abs(beams.clipping.signed_volume - volume) > 1e-6 * volume:
        return ["would clip beams at a mesh that is no box"]
    ends = beams.ends.reshape(-1, 3)
    outside = ((ends < low - CONTACT_TOLERANCE) | (ends > high + CONTACT_TOLERANCE)).any(axis=1)
    cut = int(outside.reshape(-1, 2).any(axis=1).sum())
    return [f"would cut {cut} of {len(beams.ends)} beams off at their clipping mesh"] if cut else []


def _not_found(claim: _Claim, left: list[PrintedBody], printed: PrintedFile) -> Violation:
    """Say what would be printed instead of a claim; a body of its name is taken out of `left`."""
    named = next((body for body in left if body.name == claim.name), None)
    if named is None or named.kind == "nothing":
        return Violation(PROMISE, claim.name, f"{printed.program} would not print it as it is recorded")
    left.remove(named)
    if len(named.mesh.triangles) != len(claim.mesh.triangles):
        what = f"with {len(named.mesh.triangles)} instead of {len(claim.mesh.triangles)} triangles"
    elif named.kind != claim.kind:
        what = _WORDS[named.kind]
    else:
        what = f"elsewhere or in another shape, from {place_words(named.mesh.bounds[0])} mm"
    return Violation(PROMISE, claim.name, f"{printed.program} would print it {what}")
