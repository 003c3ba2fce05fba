"""Support layouts of parts made from boxes, small enough to draw by hand."""

import manifold3d
import numpy as np

from amprep.model import BuildVolume, Mesh, Part, PlacedPart, Stop, silent
from amprep.plugins.routers.params import ShortestPathsParams
from amprep.plugins.routers.shortest_paths import route_shortest_paths
from amprep.supports.plan import PlanningRules, plan_supports

Solid = manifold3d.Manifold
SPACE = BuildVolume([60, 60, 60])


def box(size, corner):
    return Solid.cube(size).translate(corner)


def mesh_of(solid):
    mesh = solid.to_mesh()
    return Mesh(mesh.vert_properties[:, :3], mesh.tri_verts)


def placed(*solids, **settings):
    parts = [Part(f"p{i}", mesh_of(solid), solid.volume(), **settings) for i, solid in enumerate(solids)]
    return [PlacedPart(part.name, part, np.eye(4)) for part in parts]


def route(problem, stop, progress):
    rng = np.random.default_rng(0)
    return route_shortest_paths(problem, params=ShortestPathsParams(), rng=rng, stop=stop, progress=progress)


def layout(parts, space=SPACE, **settings):
    given = {name: settings.pop(name) for name in ("route", "stop") if name in settings}
    rules = PlanningRules(**{"pitch_mm": 1.0, "escalation": "none"} | settings)
    return plan_supports(parts, space, rules, **{"route": route, "stop": Stop(), "progress": silent} | given)
