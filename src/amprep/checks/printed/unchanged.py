"""Judge whether supports are as their build file records them: geometry by SHA-256, and position."""

from amprep.checks.packing.parts_placed import TOLERANCE
from amprep.checks.violation import Violation
from amprep.model.build import Build
from amprep.model.counting import counted

PROMISE = "support unchanged"


def check_unchanged(build: Build) -> list[Violation]:
    """Return the supports that differ from what the build file recorded."""
    found = []
    for body in build.supports:
        stored = body.stored
        if stored is None:
            continue
        if stored.recorded_digest and stored.recorded_digest != stored.digest:
            message = "its geometry differs from what the build file recorded (SHA-256)"
            found.append(Violation(PROMISE, body.name, message))
        if not stored.moved_mm <= TOLERANCE:
            message = f"it is {stored.moved_mm:.4g} mm from where it was written"
            found.append(Violation(PROMISE, body.name, message))
    return found


def extent_of(build: Build, not_judged: str) -> str:
    """Return what was judged; it begins with the words `not_judged` if a support has no digest."""
    if any(body.stored is None for body in build.supports):
        return f"{not_judged}: the build is in no file"
    without = sum(not body.stored.recorded_digest for body in build.supports if body.stored)
    if without:
        return f"{not_judged}: an earlier version wrote the file, without digests of {counted(without, 'support')}"
    return f"SHA-256 of {counted(len(build.supports), 'support')}"
