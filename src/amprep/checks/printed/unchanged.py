"""Judge whether supports are as their build file records them, and the record as it was written, both by SHA-256."""

from amprep.checks.packing.parts_placed import TOLERANCE
from amprep.checks.violation import Violation
from amprep.model.build import Build
from amprep.model.counting import counted

PROMISE, RECORD = "support unchanged", "record unchanged"
"""Names of the promises."""


def check_unchanged(build: Build) -> list[Violation]:
    """Return the supports that differ from what the build file recorded, and a record that was changed."""
    found = []
    stored_record = build.stored
    if stored_record is not None and stored_record.recorded_digest not in ("", stored_record.digest):
        message = "settings, parts or listed overhangs differ from what was written (SHA-256)"
        found.append(Violation(RECORD, build.settings.build_id, message))
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


def extent_of_record(build: Build, not_judged: str) -> str:
    """Return what was judged of the record; it begins with the words `not_judged` if it has no digest."""
    if build.stored is None:
        return f"{not_judged}: the build is in no file"
    if not build.stored.recorded_digest:
        return f"{not_judged}: an earlier version wrote the file, without a digest of its record"
    return "SHA-256 of the record; whoever changes both is found by a seal, a report or a job"
