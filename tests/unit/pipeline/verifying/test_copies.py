"""One of several equal copies stands for the others before the judges of supports, and a fault in any copy is found."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.supported import box, build_of, table

from amprep.model import Mesh, PlacedPart, SupportBody, Unsupported
from amprep.pipeline.verifying.build import verify_build
from amprep.pipeline.verifying.copies import TOLERANCE, find_copies

SHIFTS = ((0.0, 0.0), (40.0, 0.0), (7.25, 45.5))


def moved(mesh, x, y):
    return Mesh((mesh.vertices + (x, y, 0.0)).astype(np.float32).astype(np.float64), mesh.triangles)


def copies_of(shifts=SHIFTS, **rules):
    """A build with a table and its support at several places."""
    one = build_of([table(10, corner=(2, 2))], [box((20, 20, 10.05), (2, 2, 0))], **rules)
    (placed,), (body,) = one.parts, one.supports
    parts, bodies = [], []
    for number, (x, y) in enumerate(shifts):
        matrix = placed.matrix.copy()
        matrix[:2, 3] += x, y
        parts.append(PlacedPart(f"table-{number}", placed.part, matrix))
        bodies.append(replace(body, name=f"support-{number}", mesh=moved(body.mesh, x, y), parts=(number,)))
    return replace(one, parts=tuple(parts), supports=tuple(bodies))


def with_body(build, number, body: SupportBody | None):
    own = [each for each in build.supports if each.parts != (number,)]
    return replace(build, supports=(*own, *([] if body is None else [body])))


def changed(body, change):
    vertices = body.mesh.vertices.copy()
    change(vertices)
    return replace(body, mesh=Mesh(vertices, body.mesh.triangles))


def test_equal_copies_with_equal_supports_are_like_the_first_and_the_extent_says_so():
    build = copies_of()
    assert find_copies(build) == {1: 0, 2: 0}
    judged = verify_build(build)
    assert judged.ok
    assert "those of 2 copies equal judged ones" in judged.extent["coverage"]
    assert "copies" not in judged.extent["no intersection"]


@pytest.mark.parametrize("number", [1, 2])
def test_a_support_that_is_missing_or_moved_at_any_copy_is_found(number):
    build = copies_of()
    body = build.supports[number]
    assert verify_build(with_body(build, number, None)).violations

    def raise_it(vertices):
        vertices[:, 2] += 3.0

    lifted = with_body(build, number, changed(body, raise_it))
    assert number not in find_copies(lifted)
    assert {each.promise for each in verify_build(lifted).violations}


def test_a_fault_in_all_copies_is_told_for_each_of_them():
    build = copies_of()

    def shrink(vertices):
        vertices[:, 2] *= 0.5

    bodies = tuple(changed(each, shrink) for each in build.supports)
    judged = verify_build(replace(build, supports=bodies))
    assert {each.subject for each in judged.violations} >= {"support-0", "support-1", "support-2"}


@pytest.mark.parametrize(("move", "like"), [(0.5 * TOLERANCE, True), (3.0 * TOLERANCE, False)])
def test_a_vertex_may_differ_by_rounding_only(move, like):
    def nudge(vertices):
        vertices[0, 0] += move

    build = copies_of(SHIFTS[:2])
    build = with_body(build, 1, changed(build.supports[1], nudge))
    assert bool(find_copies(build)) == like


def test_copies_with_another_part_or_the_border_near_are_judged_themselves():
    assert find_copies(copies_of(((0.0, 0.0), (40.0, 0.0), (60.0, 0.0)))) == {}
    assert find_copies(copies_of(((0.0, 0.0), (-2.5, 40.0)))) == {}


def test_parts_with_listed_regions_are_like_others_far_from_the_border_only():
    listed = [
        Unsupported(
            number, f"overhang 1 of table-{number}", "face", "territory", 4.0, [(x + 7, y + 7, 10)], 0.5
        )
        for number, (x, y) in enumerate(SHIFTS)
    ]
    at_border = [(x - 1.5, y - 1.5) for x, y in SHIFTS]
    near = replace(copies_of(at_border, territory="own"), unsupported=tuple(listed))
    assert find_copies(near) == {}
    inner = [(x + 30.0, y + 30.0) for x, y in SHIFTS]
    regions = [replace(each, points=each.points + (30.0, 30.0, 0.0)) for each in listed]
    assert find_copies(replace(copies_of(inner, territory="own"), unsupported=tuple(regions))) == {1: 0, 2: 0}
    regions[2] = replace(regions[2], minor=True)
    assert find_copies(replace(copies_of(inner, territory="own"), unsupported=tuple(regions))) == {1: 0}
