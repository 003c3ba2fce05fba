"""State for each promise what was judged, exactly or on samples, and to which tolerance."""

from amprep.checks.listed import free_below
from amprep.checks.neighbours import apart, islands
from amprep.checks.packing.pairs import PairCounts
from amprep.checks.packing.parts_placed import ROUNDING, TOLERANCE
from amprep.checks.printed import as_recorded, unchanged
from amprep.checks.printed.found import PrintedFile
from amprep.checks.removal import access, powder
from amprep.checks.supports import bodies, xy_distance
from amprep.checks.supports.limits import NOT_JUDGED
from amprep.model import Build
from amprep.model.counting import counted


def extents_of(build: Build, pairs: PairCounts, printed: PrintedFile | None) -> dict[str, str]:
    """Return what was judged for each promise that does not depend on limits.

    Parameters
    ----------
    build
        The build.
    pairs
        How many pairs of parts were judged by which method.
    printed
        What the target of its file would print; None for a build that is in no file.
    """
    return {
        as_recorded.PROMISE: f"{NOT_JUDGED}: the build is in no file"
        if printed is None
        else f"as {printed.program} reads it, tolerance {ROUNDING:g} mm",
        **_of_parts(build, pairs),
        unchanged.PROMISE: unchanged.extent_of(build, NOT_JUDGED),
        unchanged.RECORD: unchanged.extent_of_record(build, NOT_JUDGED),
        **_of_supports(build),
        free_below.PROMISE: free_below.extent_of(build, NOT_JUDGED),
    }


def removal_extents(asked: bool) -> dict[str, str]:
    """Return what is judged of the removal of supports, which takes long and must be asked for."""
    if not asked:
        return dict.fromkeys((powder.PROMISE, access.PROMISE), f"{NOT_JUDGED}: ask by --removability")
    return {
        powder.PROMISE: f"a ball of {powder.HOLE:g} mm, on vertical lines {powder.HOLE / 2:g} mm apart",
        access.PROMISE: f"straight lines in {len(access.DIRECTIONS)} directions",
    }


def _of_parts(build: Build, pairs: PairCounts) -> dict[str, str]:
    settings = build.settings
    exact = f"exact on the triangles, tolerance {TOLERANCE:.2g} mm"
    parts = f"{exact}: {counted(len(build.parts), 'part')}"
    apart_words = f"{exact}: {pairs}" if pairs.total else f"{exact}: no pairs"
    zones = len(settings.space.zone_lo)
    recorded = sum(bool(placed.recorded_digest) for placed in build.parts)
    return {
        "inside build volume": parts,
        "outside forbidden zones": f"{parts}, {counted(zones, 'zone')}"
        if zones
        else f"{NOT_JUDGED}: no zones",
        "no intersection": apart_words,
        "clearance": f"{settings.clearance:g} mm, {apart_words}",
        "lift": f"{settings.lift:g} mm, {parts}",
        "allowed motion": f"matrices of {counted(len(build.parts), 'part')}",
        "part unchanged": f"SHA-256 of the geometry of {counted(recorded, 'part')}"
        if recorded
        else f"{NOT_JUDGED}: no digest is recorded",
    }


def _of_supports(build: Build) -> dict[str, str]:
    supports = counted(len(build.supports), "support")
    gap = build.settings.rules.gap_mm
    depth = f"{build.settings.overlap:g} mm deep"
    return {
        bodies.CLOSED: f"solids of manifold3d: {supports}",
        bodies.INSIDE: f"exact on the triangles: {supports}",
        bodies.STANDING: f"every component: {supports}",
        bodies.PENETRATION: f"intersections of solids, contacts may be {depth}: {supports}",
        islands.PROMISE: f"every component: {supports}",
        apart.APART: f"intersections of solids: {supports}",
        apart.NEIGHBOURS: apart.extent_of(build, NOT_JUDGED),
        xy_distance.PROMISE: f"{gap:g} mm, points at most {xy_distance.SPACING:g} mm apart"
        if gap > 0.0
        else f"{NOT_JUDGED}: no distance is asked for",
    }
