"""Judge coverage: every overhang is within reach of a contact, or listed as unsupported."""

import numpy as np

from amprep.checks.supports.overhangs import KINDS, border_of, overhang_samples
from amprep.checks.violation import Violation
from amprep.model.build import Build
from amprep.overhangs.contacts import NUDGE, find_held, is_near, sample_spacing

PROMISE = "coverage"


def check_coverage(build: Build) -> list[Violation]:
    """Judge a finished build from its meshes alone: every sample point of an overhang is held or listed.

    The judge finds the overhangs itself (`amprep.checks.supports.overhangs`), independently of the planner.
    """
    found: list[Violation] = []
    settings = build.settings
    if not settings.supported:
        return found
    for part, placed in enumerate(build.parts):
        spacing = sample_spacing(placed, settings.rules, settings.reach)
        samples = overhang_samples(placed, settings.rules, spacing)
        reach = settings.reach + NUDGE + border_of(placed)
        held = find_held(samples.points, placed.mesh, build.supports, spacing, reach)
        for listed in build.unsupported:
            if listed.part == part and not held.all():
                left = np.flatnonzero(~held)
                held[left] = is_near(
                    listed.points, samples.points[left], listed.radius + NUDGE + border_of(placed)
                )
        for kind in np.unique(samples.region[~held]):
            left = np.flatnonzero(~held & (samples.region == kind))
            x, y, z = samples.points[left[0]]
            message = (
                f"an overhanging {KINDS[kind]} of {placed.label} has {len(left)} sample points over "
                f"{settings.reach:g} mm from any contact and is not listed, first at ({x:.2f}, {y:.2f}, {z:.2f}) mm"
            )
            found.append(Violation(PROMISE, placed.label, message))
    return found
