"""Choose the turns about z of a part in which no long edge meets the recoater blade at once."""

from dataclasses import replace

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.slicing.straight_traces import straight_traces
from amprep.measures.printing.blade_edges import BladeRules, planar_faces_of
from amprep.model import Orientations, Part
from amprep.model.rotations import axis_rotations, quarter_turns, turns_about_z

# Strategy. A turn about z turns the long edges of all layers with the part. The allowed rotations are sorted by the
# direction of the part that points up; in each of these classes the edges are found once, and each rotation is kept
# if it brings none of them close to the direction of the blade. Where any angle is allowed, each quarter turn is
# replaced by the turns nearest to it that do, 5 to 15 degrees away. A class without such a rotation stays as it is.

TURNS_DEG = (0.0, 6.0, 8.0, 10.0, 12.5, 15.0)
"""Angles by which a part that may be turned by any angle is turned from its quarter turns, in order of preference: the
smallest first, since the box around a part grows with the angle."""


def turns_off_blade(part: Part, rules: BladeRules, orientations: frozenset[str]) -> Orientations:
    """Return the orientations of a part without those in which a long edge meets the blade at once.

    Parameters
    ----------
    part
        The part with its allowed orientations.
    rules
        Direction of the blade, least angle to it, and the length from which edges count.
    orientations
        Those that the packer can handle, as in `amprep.hookspecs.PackerAccepts`. Any angle about z becomes a list of
        turns, and any rotation becomes one unless the packer can handle it.

    Returns
    -------
    Orientations
        Those of the part if they cannot be better: it has no long edges, may not be turned, or has them in too many
        directions.
    """
    allowed = part.orientations
    if "list" not in orientations or (allowed.freedom == "free" and "free" in orientations):
        return allowed
    if allowed.freedom == "list" and len(allowed.matrices) == 1:
        return allowed
    any_angle = allowed.freedom != "list"
    start = {"list": allowed.matrices, "about-z": quarter_turns(), "free": axis_rotations()}[allowed.freedom]
    classes, changed, faces = [], False, planar_faces_of(part)
    for members in _by_upward_direction(start):
        edges = straight_traces(faces, rules.edge_mm, members[0]).angle_deg
        kept = _turned(members, edges, rules) if any_angle else members[_are_off(members, edges, rules)]
        changed |= len(kept) > 0 and len(edges) > 0
        classes.append(kept if len(kept) else members)
    return replace(allowed, freedom="list", matrices=np.concatenate(classes)) if changed else allowed


def _by_upward_direction(matrices: Floats) -> list[Floats]:
    """Return the rotations in groups that differ by turns about z, in the order of their first members."""
    rows = np.round(matrices[:, 2], 6) + 0.0
    first = [int(np.flatnonzero((rows == row).all(axis=1))[0]) for row in rows]
    return [matrices[np.array(first) == number] for number in dict.fromkeys(first)]


def _are_off(members: Floats, edges: Floats, rules: BladeRules) -> Bools:
    """Tell which rotations keep all edges off the blade; `edges` are their directions after the first rotation."""
    relative = members @ members[0].T
    turns = np.degrees(np.arctan2(relative[:, 1, 0], relative[:, 0, 0]))
    return np.asarray(~rules.meets_blade(edges[None, :] + turns[:, None]).any(axis=1))


def _turned(members: Floats, edges: Floats, rules: BladeRules) -> Floats:
    """Return each rotation turned by the first of `TURNS_DEG` that keeps all edges off the blade, to both sides."""
    found = []
    for member in members:
        for angle in TURNS_DEG:
            both = turns_about_z(np.array([angle, -angle][: 1 if angle == 0.0 else 2])) @ member
            good = both[_are_off(np.concatenate([members[:1], both]), edges, rules)[1:]]
            if len(good):
                found.append(good)
                break
    return np.concatenate(found) if found else members[:0]
