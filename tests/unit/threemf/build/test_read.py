"""A build file contains its whole build; other and damaged files are refused in one line."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from tests.shared.examples import examples
from tests.shared.records import differences

from amprep.errors import InputError
from amprep.model import (
    TARGETS,
    Build,
    BuildSettings,
    BuildVolume,
    Mesh,
    Orientations,
    Part,
    PlacedPart,
    SupportBody,
    Unsupported,
)
from amprep.model.supports.sizes import SupportSizes
from amprep.threemf import read_build, write_build
from amprep.threemf import write as writing


@pytest.mark.parametrize("share", [False, True])
@pytest.mark.parametrize("target", TARGETS)
def test_a_written_build_is_read_back(make_build, round_trip, target, share):
    build = make_build(target, share=share)
    found = differences(build, round_trip(build))
    stored = {f"build.supports.{index}.stored" for index in range(2)}
    assert set(found) == {f"build.parts.{index}.recorded_digest" for index in range(3)} | stored


@pytest.mark.parametrize("target", TARGETS)
def test_reach_and_sizes_of_a_support_are_read_back(make_build, round_trip, target):
    build = make_build(target)
    own = replace(build.supports[1], reach=1.2, sizes=SupportSizes(0.8, 0.3, 1.5, 0.4, 2.0, 0.5))
    found = round_trip(replace(build, supports=(build.supports[0], own)))
    assert [(each.reach, each.sizes) for each in found.supports] == [(None, None), (1.2, own.sizes)]
    assert [found.settings.reach_of(each) for each in found.supports] == [build.settings.reach, 1.2]


def test_a_wall_without_thickness_is_read_back_as_such(make_build, round_trip):
    build = make_build(surface=True)
    assert [support.surface for support in round_trip(build).supports] == [True, False]


@pytest.mark.parametrize("target", TARGETS)
def test_a_build_without_supports_is_read(make_build, round_trip, target):
    build = replace(make_build(target), supports=(), unsupported=())
    assert len(differences(build, round_trip(build))) == 3


@pytest.mark.parametrize("target", TARGETS)
def test_copies_share_one_part_after_reading(make_build, round_trip, target):
    first, _, third = round_trip(make_build(target)).parts
    assert first.part is third.part


@pytest.mark.parametrize("share", [False, True])
@pytest.mark.parametrize("target", TARGETS)
def test_the_recorded_digest_is_that_of_the_geometry(make_build, round_trip, target, share):
    build = make_build(target, share=share)
    for made, placed in zip(build.parts, round_trip(build).parts, strict=True):
        assert placed.recorded_digest == placed.part.mesh.digest
        if not (share and target == "prusaslicer"):
            assert placed.recorded_digest == made.part.mesh.digest


wild = (
    st.floats(-1e6, 1e6) | st.floats(-300, 300) | st.floats(-1e-5, 1e-5) | st.sampled_from([0.0, -0.0, 16.0])
)


@pytest.mark.parametrize("target", ["generic", "prusaslicer"])
@examples(40, suppress=(HealthCheck.function_scoped_fixture,))
@given(
    vertices=arrays(float, (60, 3), elements=wild),
    shift=arrays(float, 3, elements=st.floats(-400, 400)),
    angle=st.floats(-4, 4),
)
def test_any_coordinates_keep_their_digest(round_trip, target, vertices, shift, angle):
    mesh = Mesh(vertices, np.arange(60).reshape(-1, 3))
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, shift
    parts = tuple(
        PlacedPart(name, Part(name, mesh, 1.0), place) for name, place in [("a", matrix), ("b", np.eye(4))]
    )
    build = Build(
        BuildSettings("x", BuildVolume((1, 1, 1)), target), parts, (SupportBody("both", mesh, (0, 1)),)
    )
    first, second = round_trip(build).parts
    assert first.recorded_digest == first.part.mesh.digest == mesh.digest
    assert second.recorded_digest == second.part.mesh.digest
    assert second.mesh.vertices == pytest.approx(vertices, rel=0, abs=1e-6 * (np.abs(vertices).max() + 600))


@pytest.mark.parametrize("target", TARGETS)
def test_changed_geometry_does_not_have_the_recorded_digest(edited, target):
    placed = edited('z="2.000000"', 'z="2.010000"', target).parts[0]
    assert placed.recorded_digest != placed.part.mesh.digest


def test_a_moved_part_is_read_in_its_new_position(edited):
    assert edited("10.123456 20 3", "11 20 3").parts[0].matrix[:3, 3].tolist() == [11.0, 20.0, 3.0]


@pytest.mark.parametrize(
    ("old", "new"), [("amprep:format", "amprep:former"), ("schemas.amprep.dev", "example.com")]
)
def test_a_3mf_that_amprep_did_not_write_is_refused(edited, old, new):
    with pytest.raises(InputError, match="expected a build that amprep wrote"):
        edited(old, new)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('<triangle v1="', '<triangle v1="9'),
        ("<vertices>", "<vertexes>"),
        ('objectid="1"', 'objectid="99"'),
        ('x="0.000000"', 'x="nan"'),
    ],
)
def test_a_model_that_lib3mf_refuses_is_an_error_of_one_line(edited, old, new):
    with pytest.raises(InputError) as refused:
        edited(old, new)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("content", [b"", b"PK\3\4 and no more", b"solid part\nendsolid"])
def test_a_file_that_is_not_a_package_is_refused(tmp_path, content):
    path = tmp_path / "job.3mf"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"job\.3mf"):
        read_build(path)


def test_a_truncated_build_is_refused(make_build, tmp_path):
    path = tmp_path / "job.3mf"
    write_build(make_build(), path)
    path.write_bytes(path.read_bytes()[:-300])
    with pytest.raises(InputError, match=r"job\.3mf"):
        read_build(path)


@pytest.mark.parametrize("name", ["", "missing.3mf"])
def test_a_folder_or_a_missing_file_is_refused(tmp_path, name):
    with pytest.raises(InputError):
        read_build(tmp_path / name)


def test_unsupported_points_are_read_back_to_a_micrometre(make_build, round_trip):
    points = np.array([[1.23456789, -2.0, 1e-9], [1 / 3, 2 / 3, 200.123456789]])
    region = Unsupported(0, "edge 1", "edge", "capacity", 3.25, points, 0.71)
    read = round_trip(replace(make_build(), unsupported=(region,))).unsupported[0]
    assert np.abs(read.points - points).max() <= 0.5000001e-6
    assert (read.label, read.kind, read.reason, read.measure, read.radius) == (
        "edge 1",
        "edge",
        "capacity",
        3.25,
        0.71,
    )


def test_rotation_about_z_needs_no_matrices(make_build, round_trip):
    build = make_build()
    turned = replace(build.parts[0], orientations=Orientations("free", np.empty((0, 3, 3))))
    read = round_trip(replace(build, parts=(turned, *build.parts[1:]))).parts[0].orientations
    assert (read.freedom, read.matrices.shape) == ("free", (0, 3, 3))


@pytest.mark.parametrize("target", TARGETS)
def test_long_records_are_read(make_build, round_trip, target):
    """lib3mf cannot read a text of 64 KiB."""
    points = np.random.default_rng(7).uniform(0, 200, (20_000, 3))
    region = Unsupported(0, "é" * 30_000, "face", "capacity", 3.25, points, 0.7)
    build = make_build(target)
    plate = replace(build.parts[0].part, notes=("𝄞&" * 40_000,), name="&" * 70_000)
    build = replace(
        build, parts=(replace(build.parts[0], part=plate), *build.parts[1:]), unsupported=(region,)
    )
    assert len(differences(build, round_trip(build))) == 5  # digests of parts and supports


def test_a_build_is_readable_wherever_the_buffer_of_lib3mf_ends(make_build, tmp_path, monkeypatch):
    """Names with escaped characters near 64 KiB; some of these files would be unreadable without padding."""
    build, path = make_build(), tmp_path / "build.3mf"
    plate = build.parts[0].part

    def readable(length):
        noted = replace(build.parts[0], part=replace(plate, notes=("x" * length,)))
        write_build(replace(build, parts=(noted, *build.parts[1:])), path)
        try:
            return read_build(path).parts[0].part.notes == ("x" * length,)
        except InputError:
            return False

    lengths = range(58_000, 62_000, 100)
    assert all(map(readable, lengths))
    monkeypatch.setattr(writing, "is_readable", lambda path: True)
    assert not all(map(readable, lengths))
