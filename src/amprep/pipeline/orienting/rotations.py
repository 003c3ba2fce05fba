"""Give parts with ``rotations = "orient"`` the orientations among which the packer chooses."""

from dataclasses import replace

import numpy as np

from amprep.arrays import Floats
from amprep.model import Orientations, Part, Stop
from amprep.model.orientation import OrientationProposal
from amprep.model.rotations import quarter_turns
from amprep.orienting.search import FoundOrientations
from amprep.pipeline.orienting.proposals import oriented
from amprep.pipeline.reading import LoadedParts
from amprep.pipeline.stages import Clock

_MORE, _LITTLE = 1.25, 10.0
"""Proposals are allowed whose estimate of support is at most so many times the least one, and so much more."""


def with_orientations(loaded: LoadedParts, clock: Clock, stop: Stop) -> tuple[LoadedParts, tuple[str, ...]]:
    """Return the parts with the rotations that a search for orientations allows, and a note on each.

    Parts that ask for it get the proposals with little support, each with its quarter turns about z. A part with fixed
    positions stays as drawn.

    Parameters
    ----------
    loaded
        Parts with their job.
    clock
        Times and shows the stage ``orient``, if any part asks for it.
    stop
        Ends the search early.

    Raises
    ------
    JobError
        When a part has no allowed orientation.
    """
    asking = [index for index, part in enumerate(loaded.parts) if part.orient is not None]
    if not asking:
        return loaded, ()
    parts, notes = list(loaded.parts), []
    job = loaded.resolved.job
    with clock.stage("orient") as progress:
        for done, index in enumerate(asking):
            part, rules = parts[index], parts[index].orient
            progress(done / len(asking), part.name)
            if part.fixed is not None or rules is None:
                notes.append(f"{part.name} stays as drawn, because it has fixed positions")
                continue
            found = oriented(part, job, rules, job.packing.effort, stop, progress)
            allowed = worth_packing(found.proposals)
            parts[index] = replace(part, orientations=Orientations("list", _turned(allowed)))
            notes.append(_note(part, found, allowed))
    return replace(loaded, parts=tuple(parts)), tuple(notes)


def worth_packing(proposals: tuple[OrientationProposal, ...]) -> list[OrientationProposal]:
    """Return the proposals with little support, those with the least first."""
    ordered = sorted(proposals, key=lambda each: each.figures.estimate)
    most = _MORE * ordered[0].figures.estimate + _LITTLE
    return [each for each in ordered if each.figures.estimate <= most]


def _turned(proposals: list[OrientationProposal]) -> Floats:
    """Return the rotations ``(k, 3, 3)`` of proposals, each with its quarter turns."""
    return np.concatenate([quarter_turns() @ proposal.rotation for proposal in proposals])


def _note(part: Part, found: FoundOrientations, allowed: list[OrientationProposal]) -> str:
    tilts = ", ".join(f"{each.tilt_deg:.0f}" for each in allowed)
    now, drawn = (each.figures.shadow_mm3 / 1000.0 for each in (allowed[0], found.drawn))
    return (
        f"{part.name} may be tilted by {tilts} degrees: {now:.3g} cm3 between overhangs and plate instead of "
        f"{drawn:.3g} cm3 as drawn"
    )
