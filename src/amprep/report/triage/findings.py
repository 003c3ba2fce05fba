"""List what a run found about its builds as one kind of record, so that all of it is grouped and shown alike."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from amprep.arrays import Floats
from amprep.checks.supports import legs
from amprep.model import Unsupported
from amprep.report.record import BuildRecord, OverhangRecord, RunRecord
from amprep.report.removal_order import hindrances_of
from amprep.report.triage.classes import CHECK, MUST_FIX, Triage

_PLACE = re.compile(r"at \((-?[\d.]+), (-?[\d.]+), (-?[\d.]+)\)")
"""How messages of judges state a point in build coordinates, mm."""

Position = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Finding:
    """Something that was found about a build.

    Attributes
    ----------
    triage
        What must be done about it.
    build
        Number of the build, from 1; 0 if it is in none.
    part
        Name of the part in the job, the same for all copies.
    kind
        Kind of a region, such as ``ledge``; or ``violation``, ``long leg``, ``powder pocket``, ``locked parts``,
        ``unplaced copy``, ``blade edge``.
    name
        What it is about, for example ``overhang 7 of bracket-2``.
    words
        What was found.
    position_mm
        A point of it in build coordinates; None if it has no place.
    overhang
        The region; None for other findings.
    points
        ``(n, 3)`` mm, points that mark it in pictures, each for `radius` mm around it.
    volume_mm3
        Volume of a pocket of powder.
    """

    triage: Triage
    build: int
    part: str
    kind: str
    name: str
    words: str
    position_mm: Position | None = None
    overhang: OverhangRecord | None = None
    points: Floats = field(default_factory=lambda: np.empty((0, 3)))
    radius: float = 1.0
    volume_mm3: float = 0.0


def findings_of(record: RunRecord) -> list[Finding]:
    """Return everything that was found, in the order of the builds."""
    found = list(_unplaced(record))
    forbidden = record.settings.get("packing", {}).get("interlocking") == "forbid"
    for number, entry in enumerate(record.builds, start=1):
        found += build_findings(entry, number, locks_are_faults=forbidden)
    return found


def build_findings(entry: BuildRecord, number: int = 1, *, locks_are_faults: bool = False) -> list[Finding]:
    """Return what was found about a build: its regions of overhangs, broken promises, pockets and locked parts.

    Parameters
    ----------
    entry
        The build.
    number
        Its number, from 1.
    locks_are_faults
        Whether parts that are locked into each other must be fixed.
    """
    names = {placed.label: placed.part.name for placed in entry.build.parts}
    return [
        *(each for each in _violations(entry, number, names) if not _is_leg(each, entry)),
        *_regions(entry, number, names),
        *_legs(entry, number),
        *_pockets(entry, number),
        *_locks(entry, number, MUST_FIX if locks_are_faults else CHECK),
        *_blade_edges(entry, number),
    ]


def _unplaced(record: RunRecord) -> Iterator[Finding]:
    """Yield the unplaced copies, which are no faults if the job fills one build."""
    for item in () if record.objective == "fill" else record.unplaced:
        yield Finding(MUST_FIX, 0, item.name, "unplaced copy", f"{item.name} (copy {item.copy})", item.reason)


def _violations(entry: BuildRecord, number: int, names: Mapping[str, str]) -> Iterator[Finding]:
    for found in entry.verification or ():
        part, words = names.get(found.subject, found.subject), f"{found.promise}: {found.message}"
        place = _PLACE.search(found.message)
        x, y, z = map(float, place.groups()) if place else (0.0, 0.0, 0.0)
        at = (x, y, z) if place else None
        points = np.array([at] if at else []).reshape(-1, 3)
        yield Finding(MUST_FIX, number, part, "violation", found.subject, words, at, points=points)


def _regions(entry: BuildRecord, number: int, names: Mapping[str, str]) -> Iterator[Finding]:
    """Yield all regions of overhangs."""
    left: dict[str, list[Unsupported]] = {}
    for each in entry.build.unsupported:
        left.setdefault(each.label, []).append(each)
    for region in entry.overhangs:
        own = left.pop(region.name, [])
        points, radius = _marks(own, region.triage) if own else (np.array([region.position_mm]), 1.0)
        yield Finding(
            region.triage,
            number,
            names.get(region.part, region.part),
            region.region.kind,
            region.name,
            region.verdict,
            region.position_mm,
            region,
            points,
            radius,
        )
    for name, patches in left.items():
        yield _without_record(entry, number, name, patches)


def _without_record(entry: BuildRecord, number: int, name: str, patches: Sequence[Unsupported]) -> Finding:
    """Return an unsupported region of a build whose regions were not recorded."""
    triage = CHECK if all(each.minor for each in patches) else MUST_FIX
    points, radius = _marks(patches, triage)
    middle = points.mean(axis=0).tolist() if len(points) else None
    return Finding(
        triage,
        number,
        entry.build.parts[patches[0].part].part.name,
        patches[0].kind,
        name,
        ", ".join(sorted({each.reason for each in patches})),
        None if middle is None else (middle[0], middle[1], middle[2]),
        points=points,
        radius=radius,
    )


def _marks(patches: Sequence[Unsupported], triage: Triage) -> tuple[Floats, float]:
    """Return the points of the patches that put a region into its class, and their radius."""
    chosen = [each for each in patches if triage != MUST_FIX or not each.minor] or list(patches)
    return np.concatenate([each.points for each in chosen]), max(each.radius for each in chosen)


def _is_leg(found: Finding, entry: BuildRecord) -> bool:
    """Tell whether a violation is about legs that `_legs` lists one by one."""
    measured = {
        body.name for body, own in zip(entry.build.supports, entry.legs, strict=False) if own.too_long
    }
    return found.words.startswith(f"{legs.PROMISE}:") and found.name in measured


def _legs(entry: BuildRecord, number: int) -> Iterator[Finding]:
    """Yield the legs that are longer for their width than the rules allow: must fix where the judge finds one, too."""
    limit = entry.build.settings.rules.leg_ratio
    broken = {each.subject for each in entry.verification or () if each.promise == legs.PROMISE}
    for body, own in zip(entry.build.supports, entry.legs, strict=False):
        part = entry.build.parts[body.parts[0]].part.name if body.parts else body.name
        triage = MUST_FIX if body.name in broken else CHECK
        for leg in own.too_long:
            size = f"{leg.length_mm:.1f} mm long, {leg.width_mm:.2f} mm wide"
            words = f"{size}: {leg.ratio:.1f} times as long as wide, limit {limit:g}"
            points = np.array([leg.position_mm])
            yield Finding(triage, number, part, "long leg", body.name, words, leg.position_mm, points=points)


def _pockets(entry: BuildRecord, number: int) -> Iterator[Finding]:
    """Yield pockets of powder and closed cavities."""
    for body, removal in zip(entry.build.supports, entry.removal, strict=False):
        part = entry.build.parts[body.parts[0]].part.name if body.parts else body.name
        for pocket in (*(removal.pockets or ()), *removal.cavities):
            opening = "no opening" if pocket.closed else "openings that are too narrow"
            amount = f"{pocket.volume:.1f}" if pocket.volume >= 1.0 else f"{pocket.volume:.1g}"
            yield Finding(
                CHECK,
                number,
                part,
                "powder pocket",
                body.name,
                f"{amount} mm³ of powder cannot leave: {opening}",
                pocket.point,
                points=np.array([pocket.point]),
                volume_mm3=pocket.volume,
            )


def _locks(entry: BuildRecord, number: int, triage: Triage) -> Iterator[Finding]:
    groups = entry.removal_order.locked
    for group, words in zip(groups, hindrances_of(entry), strict=False):
        names = [entry.build.parts[part].part.name for part in group]
        yield Finding(triage, number, names[0], "locked parts", ", ".join(dict.fromkeys(names)), words)


def _blade_edges(entry: BuildRecord, number: int) -> Iterator[Finding]:
    """Yield for each part the longest edge that the recoater blade meets at once."""
    for edge in entry.blade_edges:
        placed = entry.build.parts[edge.part]
        others = f"; {edge.faces} faces have such edges" if edge.faces > 1 else ""
        words = (
            f"a straight edge of {edge.length_mm:.1f} mm is {edge.off_deg:.1f} degrees off the recoater blade, in "
            f"layers from {edge.low_mm:.1f} to {edge.high_mm:.1f} mm{others}"
        )
        points = np.array([edge.position_mm])
        yield Finding(
            CHECK,
            number,
            placed.part.name,
            "blade edge",
            placed.label,
            words,
            edge.position_mm,
            points=points,
        )
