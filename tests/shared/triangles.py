"""Oracles on all pairs of triangles, in numpy, and solids to try them on."""

import numpy as np
from hypothesis import strategies as st
from manifold3d import Manifold
from scipy.spatial.transform import Rotation


def arrays(solid):
    """Vertices and triangles of a solid."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3], float), np.array(mesh.tri_verts, int)


def corners(solid):
    vertices, triangles = arrays(solid)
    return vertices[triangles]


def some_solid(kind, rng):
    """A solid of about 30 to 120 triangles and a size of about 10 mm, about the origin."""
    if kind == "box":
        return Manifold.cube(rng.uniform(2, 10, 3), True)
    if kind == "ball":
        return Manifold.sphere(float(rng.uniform(2, 6)), 8)
    if kind == "cylinder":
        return Manifold.cylinder(float(rng.uniform(2, 12)), float(rng.uniform(1, 5)), 0.0, 9, True)
    if kind == "ring":
        outer = Manifold.cylinder(3.0, 6.0, 6.0, 10, True)
        return outer - Manifold.cylinder(4.0, float(rng.uniform(2, 5)), -1.0, 8, True)
    arm, leg = Manifold.cube((9, 3, 3), True), Manifold.cube((3, 3, 9), True).translate((4, 0, 3))
    return (arm + leg).translate((-2, 0, -1))


KINDS = ("box", "ball", "cylinder", "ring", "angle")

SCENES = st.tuples(st.sampled_from(KINDS), st.sampled_from(KINDS), st.integers(0, 2**32 - 1))


def random_pose(rng, reach):
    """A rigid motion with a uniform rotation and a translation of at most `reach` along each axis."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=np.random.RandomState(rng.integers(2**31))).as_matrix()
    pose[:3, 3] = rng.uniform(-reach, reach, 3)
    return pose


def random_direction(rng):
    direction = rng.normal(size=3)
    return direction / np.linalg.norm(direction)


def shift(*by):
    pose = np.eye(4)
    pose[:3, 3] = by
    return pose


def placed(points, pose):
    return points @ pose[:3, :3].T + pose[:3, 3]


def _edges(t):
    """Starts and directions of all edges, ``(3 n, 3)``."""
    return t.reshape(-1, 3), (np.roll(t, -1, axis=1) - t).reshape(-1, 3)


def _hits(origins, directions, t):
    """Parameters at which lines hit triangles, ``(n, m)``; not a number where they miss (Moeller, Trumbore 1997)."""
    u, v = t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]
    across = np.cross(directions[:, None], v[None])
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / (across * u).sum(axis=2)
        out = origins[:, None] - t[None, :, 0]
        first = (across * out).sum(axis=2) * inverse
        around = np.cross(out, u[None])
        second = (around * directions[:, None]).sum(axis=2) * inverse
        along = (around * v).sum(axis=2) * inverse
    return np.where((first >= 0) & (second >= 0) & (first + second <= 1), along, np.nan)


def crossings(a, b):
    """Whether any edge of one set of triangles pierces a triangle of the other."""
    for one, other in ((a, b), (b, a)):
        starts, along = _edges(one)
        at = _hits(starts, along, other)
        if ((at >= 0) & (at <= 1)).any():
            return True
    return False


def _segments(p, u, q, v):
    """Distances of all pairs of segments, by the least of the unconstrained and the four constrained problems."""
    p, u, q, v = p[:, None], u[:, None], q[None], v[None]
    w = p - q
    a, b, c = (u * u).sum(-1), (u * v).sum(-1), (v * v).sum(-1)
    d, e = (u * w).sum(-1), (v * w).sum(-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (b * e - c * d) / (a * c - b * b)
        t = (a * e - b * d) / (a * c - b * b)
    inner = (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    pairs = [(np.where(inner, s, 0.0), np.where(inner, t, 0.0))]
    for end in (0.0, 1.0):
        pairs.append((np.full_like(a, end), np.clip((b * end + e) / c, 0, 1)))
        pairs.append((np.clip((b * end - d) / a, 0, 1), np.full_like(a, end)))
    gaps = [np.linalg.norm(w + s[..., None] * u - t[..., None] * v, axis=-1) for s, t in pairs]
    return np.min(gaps, axis=0)


def least_distance(a, b):
    """Distance of two sets of triangles, ``(n, 3, 3)`` and ``(m, 3, 3)``; 0 if an edge pierces a triangle."""
    if crossings(a, b):
        return 0.0
    least = _segments(*_edges(a), *_edges(b)).min()
    for one, other in ((a, b), (b, a)):
        normals = np.cross(other[:, 1] - other[:, 0], other[:, 2] - other[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        points = one.reshape(-1, 3)
        for triangle, normal in zip(other, normals, strict=True):
            at = _hits(points, np.broadcast_to(normal, points.shape), triangle[None])
            least = min(least, np.nanmin(np.abs(at), initial=np.inf))
    return least


def least_travel(a, b, direction):
    """Travel of the triangles `a` along a direction until they meet `b`; infinity if they do not."""
    found = [np.inf]
    along = np.broadcast_to(direction, (3 * len(a), 3))
    found.append(_first(_hits(a.reshape(-1, 3), along, b)))
    along = np.broadcast_to(-direction, (3 * len(b), 3))
    found.append(_first(_hits(b.reshape(-1, 3), along, a)))
    p, u = _edges(a)
    q, v = _edges(b)
    normal = np.cross(u[:, None], v[None])
    w = q[None] - p[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        travel = (w * normal).sum(-1) / (normal @ direction)
        gap = w - travel[..., None] * direction
        square = (normal * normal).sum(-1)
        s = (np.cross(gap, v[None]) * normal).sum(-1) / square
        t = (np.cross(gap, u[:, None]) * normal).sum(-1) / square
    meet = (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    found.append(_first(np.where(meet, travel, np.nan)))
    return min(found)


def _first(travel):
    return np.nanmin(np.where(travel >= 0, travel, np.nan), initial=np.inf)
