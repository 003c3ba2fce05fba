"""Polygons, parts and layouts for tests of the search on plates."""

import numpy as np
from manifold3d import CrossSection, JoinType, Manifold, OpType
from tests.shared.solids import volume_of_solid

from amprep.geometry.plates.outline import ShadowOutline
from amprep.geometry.plates.shadow import shadow_of
from amprep.measures.bounding_volume import points_of
from amprep.model import Boxes, BuildVolume, Item, Orientations, PackingProblem, Stop, silent
from amprep.model.bounding_volume import Solid
from amprep.plugins.packers.params import PlatesParams
from amprep.plugins.packers.plates import pack_plates


def star(rng, corners=9, size=5.0):
    """A star-shaped polygon around the origin, counter-clockwise."""
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, corners))
    return rng.uniform(0.3 * size, size, corners)[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))


def centred(*loops):
    """Polygons as an outline, around the centre of their enclosing box."""
    points = np.concatenate(loops)
    low, high = points.min(axis=0), points.max(axis=0)
    return ShadowOutline(tuple(loop - (low + high) / 2.0 for loop in loops), (high - low) / 2.0)


def region_of(outline, position=(0.0, 0.0), quarter=0):
    """A turned and moved outline as a region."""
    turn = np.linalg.matrix_power(np.array([[0.0, -1.0], [1.0, 0.0]]), quarter)
    return CrossSection([loop @ turn.T + position for loop in outline.loops])


def distance_of(one, other, limit=50.0):
    """Distance of two regions, by bisection over offsets that make them meet."""
    low, high = 0.0, limit
    for _ in range(30):
        middle = (low + high) / 2.0
        meets = (one.offset(middle, JoinType.Round, 2.0, 720) ^ other).area() > 1e-9
        low, high = (low, middle) if meets else (middle, high)
    return high


def ring(outer, inner, height=4.0):
    return volume_of_solid(
        Manifold.cylinder(height, outer, outer, 48) - Manifold.cylinder(height, inner, inner, 48)
    )


def disc(radius, height=4.0):
    return volume_of_solid(Manifold.cylinder(height, radius, radius, 48))


def mushroom(radius, stem, height=6.0):
    """A cap on a stem: an overhang all around."""
    cap = Manifold.cylinder(1.0, radius, radius, 48).translate([0.0, 0.0, height - 1.0])
    return volume_of_solid(
        Manifold.batch_boolean([cap, Manifold.cylinder(height, stem, stem, 48)], OpType.Add)
    )


def block(x, y, z=2.0):
    return Boxes(np.zeros(3), np.array([x, y, z], float))


def plate_problem(volumes, size, objective="builds", orientations=None, values=None, **rules):
    allowed = orientations or Orientations()
    worth = values or [1.0] * len(volumes)
    items = tuple(
        Item(k, 0, v, w, allowed, exact=True) for k, (v, w) in enumerate(zip(volumes, worth, strict=True))
    )
    space = size if isinstance(size, BuildVolume) else BuildVolume(np.array(size, float))
    return PackingProblem(items, space, objective, stacking=False, **rules)


def pack(problem, work=300.0, stop=None, seed=2, **params):
    return pack_plates(
        problem,
        params=PlatesParams(work=work, **params),
        rng=np.random.default_rng(seed),
        stop=stop or Stop(),
        progress=silent,
    )


def shadow_faults(problem, packing):
    """What is wrong with the shadows of a packing, judged by areas of regions: pairs that are too near, and walls."""
    faults, gap = [], problem.clearance
    for number, build in enumerate(packing.builds):
        shadows = [_shadow(problem, placement) for placement in build]
        room = _room(problem.space, gap - 2e-3)
        wider = [s.offset(max(gap / 2.0 - 1e-3, 0.0), JoinType.Round, 2.0, 128) for s in shadows]
        for i, placement in enumerate(build):
            if (shadows[i] - room).area() > 1e-2:
                faults.append((number, placement.item, "walls"))
            for j in range(i):
                if (wider[i] ^ wider[j]).area() > 2e-3 * (1.0 + np.sqrt(wider[i].area())):
                    faults.append((number, placement.item, build[j].item))
    return faults


def _room(space, gap):
    x, y = space.size[:2]
    if space.shape == "cylinder":
        return CrossSection.circle(x / 2.0 - gap, 2048).translate((x / 2.0, y / 2.0))
    return CrossSection.square((x - 2.0 * gap, y - 2.0 * gap)).translate((gap, gap))


def _shadow(problem, placement):
    volume = problem.items[placement.item].volume
    points = points_of(volume) @ placement.rotation.T + placement.translation
    if isinstance(volume, Solid):
        return shadow_of(points, volume.mesh.triangles)
    hulls = [CrossSection.hull_points(corners[:, :2]) for corners in points.reshape(-1, 8, 3)]
    return CrossSection.batch_boolean(hulls, OpType.Add)
