"""Planted faults: whatever a program would print differently is named with the part or support that it concerns."""

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.solids import mesh_of
from tests.shared.supported import box, build_of, table

from amprep.checks.printed.as_recorded import PROMISE, check_as_printed
from amprep.checks.printed.found import PrintedBeams, PrintedBody, PrintedFile
from amprep.model import Mesh
from amprep.model.build import Lattice

BUILD = build_of([table(10)], [box((4, 4, 10.1), (2, 2, 0))])
ENDS = np.array([[[3, 3, 1], [3, 3, 5]], [[3, 3, 5], [5, 3, 9]]], float)
CONNECTOR = box((2, 2, 1), (2, 2, 9))
LATTICE = Lattice(
    [[3, 3, 1], [3, 3, 5], [5, 3, 9]],
    [[0, 1], [1, 2]],
    [[0.5, 0.5], [0.5, 0.4]],
    mesh_of(CONNECTOR),
    mesh_of(box((4, 4, 10.1), (2, 2, 0))),
    None,
)
WITH_BEAMS = replace(BUILD, supports=(replace(BUILD.supports[0], lattice=LATTICE),))
BEAMS = PrintedBeams(ENDS, LATTICE.radii, [True, True], has_balls=False, clipping=None)


def printed(build=BUILD, **changes):
    """What an honest file makes of a build, with the given changes of its body ``part`` or ``support``."""
    part = PrintedBody("part-0", "model", build.parts[0].mesh)
    lattice = build.supports[0].lattice
    mesh = build.supports[0].mesh if lattice is None else lattice.solids
    support = PrintedBody("support-0", "support", mesh, None if lattice is None else BEAMS)
    part, support = replace(part, **changes.get("part", {})), replace(support, **changes.get("support", {}))
    return PrintedFile("A slicer", 1.0, (part, support, *changes.get("more", ())))


def faults(found, build=BUILD):
    violations = check_as_printed(build, found)
    assert {each.promise for each in violations} <= {PROMISE}
    return [(each.subject, each.message.removeprefix("A slicer ")) for each in violations]


def with_beams(**changes):
    return [
        words
        for _, words in faults(printed(WITH_BEAMS, support={"beams": replace(BEAMS, **changes)}), WITH_BEAMS)
    ]


def test_an_honest_file_has_no_fault_in_any_order_and_rounding_is_none():
    found = printed()
    assert faults(found) == []
    assert faults(replace(found, bodies=found.bodies[::-1])) == []
    rounded = Mesh(BUILD.parts[0].mesh.vertices + 9e-5, BUILD.parts[0].mesh.triangles)
    assert faults(printed(part={"mesh": rounded})) == []
    assert faults(printed(WITH_BEAMS), WITH_BEAMS) == []


def test_another_unit_is_named_alone():
    found = faults(replace(printed(), unit_mm=25.4))
    assert found == [("b.build-1", "would print everything 25.4 times as large: the unit is not mm")]


def test_remarks_of_the_reader_are_faults_of_the_build():
    assert faults(replace(printed(), remarks=("cuts the plate in two",))) == [
        ("b.build-1", "cuts the plate in two")
    ]


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("nothing", "would not print it"),
        ("model", "would print it as a part instead of as a support"),
        ("modifier", "would print it as a modifier, which prints nothing instead of as a support"),
        ("blocker", "would print it as a support blocker, which prints nothing instead of as a support"),
        ("enforcer", "would print it as a support enforcer, which prints nothing instead of as a support"),
        ("negative", "would print it as a negative volume, which removes material instead of as a support"),
        ("open support", "would print it as a support that is not filled instead of as a support"),
    ],
)
def test_a_support_that_is_printed_as_something_else_is_named(kind, words):
    assert faults(printed(support={"kind": kind})) == [("support-0", words)]


def test_kinds_follow_the_target_and_the_way_supports_are_stored():
    as_parts = printed(support={"kind": "model"})
    for settings in ({"target": "prusaslicer"}, {"target": "generic", "supports_as": "model"}):
        build = replace(BUILD, settings=replace(BUILD.settings, **settings))
        assert faults(as_parts, build) == []
        assert len(faults(printed(), build)) == 1
    walls = replace(BUILD, supports=(replace(BUILD.supports[0], surface=True),))
    assert faults(printed(support={"kind": "open support"}), walls) == []


def moved(mesh, by):
    return Mesh(mesh.vertices + by, mesh.triangles)


def test_a_body_elsewhere_or_in_another_shape_is_named_with_its_place():
    own = BUILD.parts[0].mesh
    for by in ([0, 0, 2e-4], [5, 0, 0]):
        ((name, words),) = faults(printed(part={"mesh": moved(own, by)}))
        assert name == "part-0"
        assert words.startswith("would print it elsewhere or in another shape, from (")
    turned = Mesh(own.vertices, own.triangles[:, ::-1])
    assert len(faults(printed(part={"mesh": turned}))) == 1


def test_lost_triangles_are_counted():
    own = BUILD.parts[0].mesh
    fewer = Mesh(own.vertices, own.triangles[1:])
    assert faults(printed(part={"mesh": fewer})) == [
        ("part-0", "would print it with 11 instead of 12 triangles")
    ]


def test_a_missing_body_is_named():
    found = printed()
    gone = replace(found, bodies=found.bodies[1:])
    assert faults(gone) == [("part-0", "would not print it as it is recorded")]


def test_a_second_copy_and_a_stranger_are_named_and_a_stranger_that_prints_nothing_is_not():
    stranger = PrintedBody("", "model", mesh_of(Manifold.cube((1, 1, 1))))
    expected = "would print it, but no part or support is so"
    assert faults(printed(more=[stranger])) == [("unnamed", expected)]
    assert faults(printed(more=[replace(stranger, kind="nothing")])) == []
    assert faults(printed(more=[PrintedBody("part-0", "model", BUILD.parts[0].mesh)])) == [
        ("part-0", expected)
    ]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"ends": ENDS[:1], "radii": LATTICE.radii[:1], "round_caps": [True]},
            "would print 1 of its 2 beams",
        ),
        ({"ends": ENDS + [0, 0.01, 0]}, "would print beams at other places"),
        ({"radii": LATTICE.radii * 1.5}, "would print beams of other radii"),
        ({"round_caps": [True, False]}, "would print beams without balls at their ends"),
        ({"has_balls": True}, "would print balls at nodes of beams"),
    ],
)
def test_changed_beams_are_named(changes, words):
    assert with_beams(**changes) == [words]


def test_beams_may_be_clipped_by_a_box_around_them_alone():
    around = mesh_of(box((10, 10, 10), (0, 0, 0)))
    assert with_beams(clipping=around) == []
    assert with_beams(clipping=around, keeps_inside=False) == [
        "would remove the beams inside their clipping mesh"
    ]
    assert with_beams(clipping=mesh_of(box((10, 10, 6), (0, 0, 0)))) == [
        "would cut 1 of 2 beams off at their clipping mesh"
    ]
    notched = box((10, 10, 10), (0, 0, 0)) - box((1, 1, 1), (8, 8, 8))
    assert with_beams(clipping=mesh_of(notched)) == ["would clip beams at a mesh that is no box"]
    nothing = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int32))
    assert with_beams(clipping=nothing) == ["would cut 2 of 2 beams off at their clipping mesh"]


def test_a_support_with_beams_needs_them_and_its_connectors():
    without = faults(printed(WITH_BEAMS, support={"beams": None}), WITH_BEAMS)
    assert [name for name, _ in without] == ["support-0"]
    bare = Mesh(ENDS.reshape(-1, 3), np.empty((0, 3), np.int32))
    ((name, words),) = faults(printed(WITH_BEAMS, support={"mesh": bare}), WITH_BEAMS)
    assert (name, words) == ("support-0", "would print it with 0 instead of 12 triangles")


def test_vertices_that_beams_alone_use_do_not_count():
    solids = LATTICE.solids
    more = Mesh(np.vstack([solids.vertices, ENDS.reshape(-1, 3)]), solids.triangles)
    assert faults(printed(WITH_BEAMS, support={"mesh": more}), WITH_BEAMS) == []
