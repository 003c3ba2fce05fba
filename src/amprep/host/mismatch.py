"""Compare a packing problem with the features that a packer accepts."""

import numpy as np

from amprep.hookspecs import PackerAccepts
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces
from amprep.model.packing import PackingProblem
from amprep.model.part import Orientations
from amprep.model.rotations import axis_rotations, quarter_turns


def mismatches(accepts: PackerAccepts, problem: PackingProblem) -> list[str]:
    """Return the features of the problem that the packer does not accept, in a few words each."""
    volumes = {volume_word(item.volume) for item in problem.items} - _volumes_handled(accepts)
    turns = {orientation_word(item.orientations) for item in problem.items} - _turns_handled(accepts)
    found = [f"bounding volumes of kind {word!r}" for word in sorted(volumes)]
    found += [f"orientations of kind {word!r}" for word in sorted(turns)]
    if problem.objective not in accepts.objectives:
        found.append(f"the objective {problem.objective!r}")
    if problem.space.shape == "cylinder" and not accepts.cylinder:
        found.append("a cylindrical build volume")
    if len(problem.space.zone_lo) and not accepts.zones:
        found.append("forbidden zones")
    if problem.fixed and not accepts.fixed:
        found.append("fixed placements")
    if problem.stacking not in accepts.stacking:
        found.append(f"stacking {'on' if problem.stacking else 'off'}")
    return found


def volume_word(volume: BoundingVolume) -> str:
    """Return the word in `PackerAccepts.volumes` for a bounding volume."""
    if isinstance(volume, Boxes):
        return "box" if len(volume.lo) == 1 else "boxes"
    return "convex" if isinstance(volume, ConvexPieces) else "solid"


def orientation_word(orientations: Orientations) -> str:
    """Return the word in `PackerAccepts.orientations` for the orientations of an item."""
    if orientations.freedom != "list":
        return orientations.freedom
    matrices = orientations.matrices
    if len(matrices) == 1:
        return "fixed"
    return "axis" if np.allclose(np.abs(matrices), np.round(np.abs(matrices)), atol=1e-9) else "list"


def narrowed(orientations: Orientations, accepts: PackerAccepts) -> Orientations:
    """Return allowed orientations that the packer can handle: all of them, or else as many as it takes.

    A packer that takes lists only gets the quarter turns about z instead of any angle about z, and the 24 rotations
    from axis to axis instead of any rotation. Lists are returned as they are.
    """
    freedom, words = orientations.freedom, accepts.orientations
    if freedom == "list" or freedom in words:
        return orientations
    if {"axis", "list"} & words:
        return Orientations("list", quarter_turns() if freedom == "about-z" else axis_rotations())
    return Orientations("about-z") if freedom == "free" and "about-z" in words else Orientations()


def _volumes_handled(accepts: PackerAccepts) -> frozenset[str]:
    return accepts.volumes | {"box"} if "boxes" in accepts.volumes else accepts.volumes


def _turns_handled(accepts: PackerAccepts) -> frozenset[str]:
    # "list" includes lists that map axes to axes, and "axis" includes a single rotation
    handled = set(accepts.orientations)
    if "list" in handled:
        handled.add("axis")
    if "axis" in handled:
        handled.add("fixed")
    return frozenset(handled)
