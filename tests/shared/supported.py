"""Builds of simple parts with simple supports, for the judges of supports."""

from dataclasses import replace

import numpy as np
from manifold3d import Manifold
from tests.shared.solids import mesh_of

from amprep.model import Build, BuildSettings, BuildVolume, Part, PlacedPart, SupportBody
from amprep.model.supports.rules import SupportRules

SETTINGS = BuildSettings("b.build-1", BuildVolume([200, 200, 200]), reach=3.0, overlap=0.1)


def box(size, corner):
    return Manifold.cube(size).translate(corner)


def part_of(solid, label="table"):
    return PlacedPart(label, Part(label, mesh_of(solid), solid.volume()), np.eye(4))


def table(height, side=20.0, corner=(0.0, 0.0)):
    """A plate in the air."""
    return box((side, side, 3), (*corner, height))


def build_of(parts, bodies, sizes=None, **rules):
    """Return a build of solids, each support held by the part with its number, under the rules named."""
    settings = replace(SETTINGS, rules=SupportRules(**rules))
    placed = tuple(part_of(solid, f"part-{number}") for number, solid in enumerate(parts))
    supports = tuple(
        SupportBody(f"support-{number}", mesh_of(solid), (number,)) for number, solid in enumerate(bodies)
    )
    return Build(settings if sizes is None else replace(settings, sizes=sizes), placed, supports)
