"""Judge coverage: every overhang that needs support is within reach of a contact, or listed as unsupported."""

from dataclasses import replace

import numpy as np

from amprep.arrays import Int64s
from amprep.checks.overhangs.modifiers import border_of
from amprep.checks.overhangs.needs import are_needed
from amprep.checks.overhangs.samples import KINDS, JudgedSamples, judged_overhangs
from amprep.checks.supports import beams
from amprep.checks.violation import Violation, place_words
from amprep.model.build import Build, SupportBody
from amprep.overhangs.contacts import NUDGE, find_held, is_near, sample_spacing

PROMISE = "coverage"


def check_coverage(build: Build) -> list[Violation]:
    """Judge a finished build from its meshes alone: every sample point of an overhang is held, carried or listed.

    Beams are judged by their own contacts, not by the mesh that stands in for them. The judge finds the overhangs
    itself, and what the part itself carries (`amprep.checks.overhangs`), independently of the planner.
    """
    found: list[Violation] = []
    settings = build.settings
    if not settings.supported:
        return found
    for part, placed in enumerate(build.parts):
        spacing = sample_spacing(placed, build.supports, settings)
        overhangs = judged_overhangs(placed, settings.rules, spacing)
        left = _left_over(build, part, overhangs.samples, spacing)
        left = left[are_needed(overhangs, settings.rules, left)]
        kinds = overhangs.samples.kind[left]
        found += [
            _violation(build, part, kind, overhangs.samples, left[kinds == kind]) for kind in np.unique(kinds)
        ]
    return found


def _left_over(build: Build, part: int, samples: JudgedSamples, spacing: float) -> Int64s:
    """Return the samples of a part that are neither within reach of a contact nor listed."""
    placed = build.parts[part]
    border = NUDGE + border_of(placed)
    solid = [each for body in build.supports for each in _without_beams(body)]
    held = find_held(samples.points, placed.mesh, solid, build.settings, spacing, border)
    for body in build.supports:
        if body.lattice is not None and not held.all():
            left = np.flatnonzero(~held)
            contacts = beams.contacts_of(body.lattice, placed.mesh, NUDGE)
            held[left] = is_near(contacts, samples.points[left], build.settings.reach_of(body) + border)
    for listed in build.unsupported:
        if listed.part == part and not held.all():
            left = np.flatnonzero(~held)
            held[left] = is_near(listed.points, samples.points[left], listed.radius + border)
    return np.flatnonzero(~held)


def _without_beams(body: SupportBody) -> list[SupportBody]:
    """Return a support as its solids alone, if it has any."""
    if body.lattice is None:
        return [body]
    solids = body.lattice.solids
    return [replace(body, mesh=solids, lattice=None)] if len(solids.triangles) else []


def _violation(build: Build, part: int, kind: int, samples: JudgedSamples, left: Int64s) -> Violation:
    label = build.parts[part].label
    message = (
        f"an overhanging {KINDS[kind]} of {label} has {len(left)} sample points over {_reach_words(build)} mm from "
        f"any contact and is not listed, first at {place_words(samples.points[left[0]])} mm"
    )
    return Violation(PROMISE, label, message)


def _reach_words(build: Build) -> str:
    """Return the reach (mm) of the supports of a build, the least and the greatest where they differ."""
    reaches = [build.settings.reach, *(build.settings.reach_of(body) for body in build.supports)]
    return " to ".join(dict.fromkeys(f"{each:g}" for each in (min(reaches), max(reaches))))
