"""Flanges and rafts have the sizes of the rules and keep their distance from parts, zones and other supports."""

from functools import cache

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from tests.shared.optional import present

from amprep.checks.supports.bodies import check_bodies
from amprep.errors import JobError
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.supports import footprints
from amprep.host import Host
from amprep.model import Build, BuildSettings, BuildVolume, Mesh, Part, PlacedPart, Stop, silent
from amprep.model.contacts import BaseRules
from amprep.supports.plan import PlanningRules, plan_supports
from amprep.supports.solids.bases import LEAST_GAP, make_bases
from amprep.supports.solids.build import SolidRules, build_supports

SIZE = np.array([60.0, 60.0, 40.0])
PLAIN = BuildVolume(SIZE)
FLANGE, RAFT = (
    BaseRules("flange", flange_mm=1.5, flange_height_mm=0.8),
    BaseRules("raft", raft_margin_mm=2.0, raft_height_mm=0.5),
)


def box(lo, hi):
    return Manifold.cube((np.array(hi, float) - lo).tolist()).translate(lo)


def mesh_of(solid):
    mesh = solid.to_mesh64()
    return Mesh(np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts, np.int32))


def placed(name, solid):
    mesh = mesh_of(solid)
    return PlacedPart(name, Part(name, mesh, mesh.signed_volume), np.eye(4))


def solid_of(mesh):
    return as_manifold(mesh.vertices, mesh.triangles)


def low(solid, height):
    return solid.trim_by_plane((0.0, 0.0, -1.0), -height)


@cache
def host():
    return Host.load(plugins_enabled=False)


def layout_of(parts, space=PLAIN):
    router = host().choose("router", "shortest-paths")

    def route(problem, stop, progress):
        rng = np.random.default_rng(0)
        return host().call(
            router, problem, params=host().params(router, {}), rng=rng, stop=stop, progress=progress
        )

    return plan_supports(parts, space, PlanningRules(pitch_mm=2.0), route=route, stop=Stop(), progress=silent)


def supports(parts, layout, base, cell="prism", space=PLAIN, surface=False, params=None, **more):
    emitter = host().choose("cell", cell)
    return build_supports(
        layout,
        parts,
        lambda request: host().call(
            emitter, request, params=host().params(emitter, params or {}), stop=Stop(), progress=silent
        ),
        SolidRules(base=base, allow_surface=surface, space=space, **more),
        stop=Stop(),
        progress=silent,
    )


@cache
def crowd():
    """Two slabs side by side in the air, a block on the plate beside the first, and a post below the second."""
    parts = (
        placed("one", box((20, 20, 10), (30, 30, 12))),
        placed("two", box((20, 33, 8), (30, 43, 10))),
        placed("block", box((31.5, 20, 0), (40, 30, 6))),
    )
    return parts, layout_of(parts)


@pytest.mark.parametrize(
    ("base", "cell"),
    [
        (FLANGE, "prism"),
        (RAFT, "prism"),
        (BaseRules("raft", raft_margin_mm=2.0, raft_height_mm=0.5, raft_hole_mm=0.8), "strut"),
    ],
)
def test_bases_keep_every_promise_and_their_distance(base, cell):
    parts, layout = crowd()
    bodies = supports(parts, layout, base, cell)
    settings = BuildSettings("b", PLAIN, overlap=0.1)
    assert check_bodies(Build(settings, parts, bodies), Stop()) == []
    solids = [solid_of(body.mesh) for body in bodies]
    bare = [solid_of(body.mesh) for body in supports(parts, layout, BaseRules(), cell)]
    least = min(LEAST_GAP, bare[0].min_gap(bare[1], 5.0)) - 0.01
    assert solids[0].min_gap(solids[1], 5.0) >= least
    assert all(
        low(solid, base.base_height_mm).min_gap(solid_of(parts[2].mesh), 5.0) >= 0.29 for solid in solids
    )
    for solid, before in zip(solids, bare, strict=True):
        assert (
            solid.slice(base.base_height_mm / 2).area() > 1.2 * before.slice(base.base_height_mm / 2).area()
        )
        assert solid.slice(base.base_height_mm + 0.01).area() == pytest.approx(
            before.slice(base.base_height_mm + 0.01).area(), rel=1e-3
        )


def alone(base, cell="prism", space=PLAIN, at=20.0):
    parts = (placed("slab", box((at, at, 10), (at + 8, at + 8, 12))),)
    layout = layout_of(parts, space)
    return [solid_of(supports(parts, layout, each, cell, space)[0].mesh) for each in (BaseRules(), base)]


def test_a_flange_widens_every_foot_by_its_margin_up_to_its_height():
    bare, wide = alone(FLANGE)
    feet, sole = bare.slice(0.4), wide.slice(0.4)
    assert (footprints.grown(feet, 1.49) - sole).area() < 1e-3
    assert (sole - footprints.grown(feet, 1.51)).area() < 1e-3
    assert wide.slice(0.81).area() == pytest.approx(bare.slice(0.81).area(), rel=1e-4)


def test_a_raft_is_one_plate_with_a_margin_around_all_feet():
    bare, wide = alone(RAFT, "strut")
    feet, pad = bare.slice(0.02), wide.slice(0.25)
    assert feet.num_contour() > 1
    assert len(pad.decompose()) == 1
    assert (footprints.grown(feet, 1.98) - pad).area() < 1e-2
    reach = np.array(pad.bounds()) - np.array(feet.bounds())
    assert reach == pytest.approx([-2.0, -2.0, 2.0, 2.0], abs=0.02)


def test_holes_perforate_a_raft_beside_the_feet():
    _, plain = alone(RAFT)
    bare, pierced = alone(BaseRules("raft", raft_margin_mm=4.0, raft_height_mm=0.5, raft_hole_mm=0.8))
    _, whole = alone(BaseRules("raft", raft_margin_mm=4.0, raft_height_mm=0.5))
    holes = (whole - pierced).decompose()
    assert len(holes) > 10
    for hole in holes:
        assert hole.volume() == pytest.approx(0.5 * np.pi * 0.16, rel=0.06)
    assert (low(bare, 0.5) - pierced).volume() < 1e-6
    assert plain.volume() < whole.volume()


@pytest.mark.parametrize("shape", ["box", "cylinder"])
def test_bases_end_at_the_build_volume_and_at_forbidden_zones(shape):
    at = 2.0 if shape == "box" else 12.0
    zone = np.array([[at + 9.0, 0.0, 0.0]]), np.array([[at + 14.0, 40.0, 5.0]])
    space = BuildVolume(SIZE, shape, *zone)
    parts = (placed("slab", box((at, at, 10), (at + 8, at + 8, 12))),)
    layout = layout_of(parts, space)
    bodies = supports(parts, layout, BaseRules("raft", raft_margin_mm=6.0, raft_height_mm=0.5), space=space)
    assert check_bodies(Build(BuildSettings("b", space, overlap=0.1), parts, bodies), Stop()) == []
    assert low(solid_of(bodies[0].mesh), 0.5).bounding_box()[3] <= at + 9.0


def test_pieces_of_a_base_without_a_foot_are_dropped():
    """A wall on the plate divides the raft; the piece beyond it is dropped."""
    parts = (placed("slab", box((20, 20, 10), (28, 28, 12))), placed("wall", box((29, 0, 0), (29.5, 60, 5))))
    layout = layout_of(parts)
    (body,) = supports(parts, layout, BaseRules("raft", raft_margin_mm=5.0, raft_height_mm=0.5))
    assert low(solid_of(body.mesh), 0.5).bounding_box()[3] == pytest.approx(29.0 - LEAST_GAP, abs=0.01)


def test_there_is_no_raft_below_a_part_that_is_closer_than_its_height():
    part = placed("part", box((20, 20, 0.7), (28, 28, 3)))
    feet = box((21, 21, 0), (22, 22, 0.7))
    (pad,) = make_bases(
        [feet], (part,), BaseRules("raft", raft_margin_mm=3.0, raft_height_mm=0.5), PLAIN, 0.0
    )
    assert pad is None
    high = placed("part", box((20, 20, 0.9), (28, 28, 3)))
    (pad,) = make_bases(
        [feet], (high,), BaseRules("raft", raft_margin_mm=3.0, raft_height_mm=0.5), PLAIN, 0.0
    )
    assert present(pad).volume() == pytest.approx(
        0.5 * footprints.raft(CrossSection.square((1, 1)), 3.0).area(), rel=1e-6
    )


def test_beams_stand_on_a_raft():
    parts = (placed("slab", box((20, 20, 10), (28, 28, 12))),)
    layout = layout_of(parts)
    (body,) = supports(parts, layout, RAFT, "strut", beams=True)
    assert body.lattice is not None
    assert low(solid_of(body.lattice.solids), 0.5).volume() > 25.0
    assert check_bodies(Build(BuildSettings("b", PLAIN, overlap=0.1), parts, (body,)), Stop()) == []


def test_walls_without_thickness_have_no_base():
    parts, layout = crowd()
    with pytest.raises(JobError, match=r"cells\.base = 'raft' needs a cell with thickness"):
        supports(parts, layout, RAFT, "x-wall", surface=True, params={"wall_mm": 0.0})
