"""Bounding volumes: by job, by part, chained, and in an orientation that the maker chose."""

import sys
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.checks.packing.motion import motion_fault
from amprep.errors import JobError, PluginError
from amprep.hookspecs import PackerAccepts, VolumeMaker, hookimpl
from amprep.host import Host
from amprep.job import apply_part_settings, apply_sets, job_from_inputs, make_job
from amprep.model import Boxes, Mesh, Orientations, Overrides, Part, Solid, Stop, TurnedVolume, silent
from amprep.model.rotations import axis_rotations, quarter_turns
from amprep.pipeline.packing import pack_parts
from amprep.pipeline.packing.bounding import bound_part, bound_parts, offered_orientations
from amprep.pipeline.reading import LoadedParts
from amprep.pipeline.resolve import resolve
from amprep.pipeline.stages import Clock, ProgressWatcher

ANGLE = np.radians(30.0)
TILT = np.array([[np.cos(ANGLE), -np.sin(ANGLE), 0], [np.sin(ANGLE), np.cos(ANGLE), 0], [0, 0, 1]])
BAR = box_mesh((0, 0, 0), (90, 10, 10))
TILTED_BAR = Mesh(BAR.vertices @ TILT.T, BAR.triangles)


def makers():
    """A maker of a larger solid, one of boxes, and one that turns the tilted bar parallel to the axes."""
    module = ModuleType("made_volumes")
    setattr(module, "amprep_api", 1)  # noqa: B010 a module has no such attribute

    def larger(part, *, params, rng, stop):
        lo, hi = part.mesh.bounds
        return Solid(box_mesh(tuple(lo - 1), tuple(hi - lo + 2)))

    def bounds(part, *, params, rng, stop):
        return Boxes(*(corner[None] for corner in part.mesh.bounds))

    def straight(part, *, params, rng, stop):
        turned = part.mesh.vertices @ TILT
        return TurnedVolume(Boxes(turned.min(axis=0)[None], turned.max(axis=0)[None]), TILT.T)

    def wrong(part, *, params, rng, stop):
        return bounds(part, params=params, rng=rng, stop=stop)

    def offers():
        yield VolumeMaker("larger", "A larger box.", run=larger, makes="solid")
        yield VolumeMaker("bounds", "The box.", run=bounds, makes="box")
        yield VolumeMaker("straight", "Straight.", run=straight, makes="box")
        yield VolumeMaker("wrong", "Not the solid it states.", run=wrong, makes="solid")

    setattr(module, "amprep_volume_makers", hookimpl(offers))  # noqa: B010
    return module


@pytest.fixture
def host(monkeypatch):
    monkeypatch.setitem(sys.modules, "made_volumes", makers())
    return Host.load(modules=["made_volumes"], env={"AMPREP_LOAD_PLUGINS": ""})


def loaded(host, parts, *sets):
    return LoadedParts(resolve(apply_sets(job_from_inputs(["bar.stl"]), sets), host), tuple(parts))


def bar(**fields):
    return Part("bar", TILTED_BAR, TILTED_BAR.signed_volume, **fields)


def test_the_packer_chooses_the_volume_maker_of_a_job_that_names_none(host):
    (made,) = bound_parts(loaded(host, [bar()]), Stop(), silent)
    assert isinstance(made.volume, Solid)
    (made,) = bound_parts(loaded(host, [bar()], "packing.strategy=extreme-points"), Stop(), silent)
    assert isinstance(made.volume, Boxes)
    np.testing.assert_array_equal(made.rotation, np.eye(3))


def test_a_surface_is_bounded_by_its_box_where_the_job_names_no_volume_maker(host):
    (made,) = bound_parts(loaded(host, [replace(bar(), is_solid=False)]), Stop(), silent)
    assert isinstance(made.volume, Boxes)


def test_a_volume_maker_bounds_the_solid_of_the_one_before(host):
    given = loaded(host, [bar()], 'packing.volumes=["larger", "larger", "bounds"]')
    (made,) = bound_parts(given, Stop(), silent)
    lo, hi = made.volume.enclosing()
    np.testing.assert_allclose(lo, TILTED_BAR.bounds[0] - 2)
    np.testing.assert_allclose(hi, TILTED_BAR.bounds[1] + 2)


def test_a_part_chooses_its_own_volume_makers(host):
    parts = [bar(), replace(bar(overrides=Overrides(volumes=("larger", "bounds"))), name="other")]
    first, second = bound_parts(loaded(host, parts, "packing.volumes=bounds"), Stop(), silent)
    np.testing.assert_allclose(second.volume.enclosing()[0], first.volume.enclosing()[0] - 1)


@pytest.mark.parametrize(("given", "names"), [({"volumes": "mesh"}, ("mesh",)), ({}, None)])
def test_an_entry_of_the_job_names_the_volume_makers_of_its_part(given, names):
    job = make_job(
        {"inputs": ["bar.stl"], "part": [{"name": "bar", **given}]}, name="j", folder=None, source="j"
    )
    assert apply_part_settings([bar()], job)[0].overrides.volumes == names


@pytest.mark.parametrize("key", ["packing", "part"])
def test_only_a_maker_of_solids_may_be_followed_by_another(host, key):
    volumes = {"volumes": ["bounds", "larger"]}
    table = {"packing": volumes} if key == "packing" else {"part": [{"name": "bar", **volumes}]}
    job = make_job({"inputs": ["bar.stl"], **table}, name="j", folder=None, source="j")
    with pytest.raises(JobError, match="'bounds' must be the last, since it makes 'box'"):
        resolve(job, host)


def test_a_maker_that_states_a_solid_and_returns_boxes_is_refused_in_a_chain(host):
    given = loaded(host, [bar()], 'packing.volumes=["wrong", "bounds"]')
    with pytest.raises(PluginError, match=r"volume maker 'wrong' of .* returned Boxes, expected Solid"):
        bound_part(bar(), given.resolved.volumes, 0, Stop())


@pytest.mark.parametrize(
    ("sets", "message"),
    [
        ("packing.volumes=boxs", "no volume maker is called 'boxs'.*box"),
        ("packing.volume_params.boxs.n=3", "no volume maker is called 'boxs'"),
        ("packing.volume_params.box.n=3", "volume maker 'box': unknown key 'n'"),
        ("packing.volume_params.box=3", "volume_params must hold one table per volume maker"),
        ("packing.volumes=[]", "volumes must name at least one volume maker"),
    ],
)
def test_wrong_names_and_parameters_are_refused_before_any_work(host, sets, message):
    with pytest.raises((JobError, PluginError), match=message):
        loaded(host, [bar()], sets)


def test_a_part_is_placed_in_the_orientation_that_its_volume_maker_chose(host):
    allowed = Orientations("about-z")
    sets = ("packing.volumes=straight", "packing.blade_angle_deg=0")
    given = loaded(host, [bar(orientations=allowed, quantity=3)], *sets)
    packed = pack_parts(given, Clock(ProgressWatcher()), Stop())
    for placed in packed.builds[0].parts:
        assert motion_fault(placed.matrix[:3, :3], allowed) == ""
        corners = placed.mesh.vertices
        assert sorted(np.ptp(corners, axis=0).round(3).tolist()) == [10.0, 10.0, 90.0]


def test_a_fixed_copy_keeps_its_own_orientation(host):
    fixed = np.array([[40.0, 50.0, 0.0]])
    given = loaded(
        host, [bar(orientations=Orientations("about-z"), quantity=2, fixed=fixed)], "packing.volumes=straight"
    )
    packed = pack_parts(given, Clock(ProgressWatcher()), Stop())
    first = packed.builds[0].parts[0]
    np.testing.assert_allclose(first.matrix[:3, :3], np.eye(3), atol=1e-6)
    np.testing.assert_allclose(first.mesh.vertices.min(axis=0), fixed[0], atol=1e-4)


def accepts(*words):
    return PackerAccepts(orientations=frozenset(words))


@pytest.mark.parametrize(
    ("allowed", "words", "offered"),
    [
        ("free", ("fixed", "axis"), axis_rotations()),
        ("about-z", ("fixed", "axis", "list"), quarter_turns()),
        ("free", ("fixed",), np.eye(3)[None]),
    ],
)
def test_a_packer_of_lists_is_offered_some_of_any_rotations(allowed, words, offered):
    found = offered_orientations(Orientations(allowed), np.eye(3), accepts(*words))
    assert found.freedom == "list"
    np.testing.assert_array_equal(found.matrices, offered)


def test_a_packer_of_any_rotation_is_offered_all():
    assert offered_orientations(Orientations("free"), np.eye(3), accepts("free")).freedom == "free"
    assert offered_orientations(Orientations("free"), np.eye(3), accepts("about-z")).freedom == "about-z"


def test_listed_orientations_are_offered_relative_to_the_orientation_of_the_volume():
    allowed = Orientations("list", [np.eye(3), TILT])
    found = offered_orientations(allowed, TILT, accepts("list"))
    np.testing.assert_allclose(found.matrices @ TILT, allowed.matrices, atol=1e-12)
