"""Regions are chosen by name, moved to the coordinates of their part, and must be closed meshes."""

from pathlib import Path

import numpy as np
import pytest
from tests.shared.optional import present

from amprep.errors import InputError, JobError, MeshError
from amprep.infill.regions import KIND, chosen, with_files, without
from amprep.model import Mesh, Part, Region
from amprep.testing.problems import box_mesh

BLOCK = box_mesh((0, 0, 0), (10, 10, 10))
CORE = box_mesh((2, 2, 2), (8, 8, 8))


def part(*regions, at=None, notes=()):
    where = None if at is None else np.array(at, float)
    return Part("block", BLOCK, 1000.0, regions=regions, positions=where, notes=notes)


def region(name="core", mesh=CORE):
    return Region(KIND, name, mesh=mesh)


def test_all_regions_are_chosen_without_names_and_the_named_ones_with():
    parts = [part(region("a"), region("b")), part(region("b"))]
    assert [[each.name for each in own] for own in chosen(parts, ())] == [["a", "b"], ["b"]]
    assert [[each.name for each in own] for own in chosen(parts, ("a",))] == [["a"], []]


def test_no_region_and_an_unknown_name_are_refused():
    with pytest.raises(JobError, match="--region"):
        chosen([part()], ())
    with pytest.raises(JobError, match="'core'"):
        chosen([part(region())], ("cora",))


def test_an_open_region_is_refused():
    with pytest.raises(MeshError, match="is not a closed mesh"):
        chosen([part(region(mesh=Mesh(CORE.vertices, CORE.triangles[1:])))], ())


def test_meshes_of_files_are_moved_to_the_coordinates_of_the_part_they_meet(tmp_path):
    file = tmp_path / "core.stl"
    file.write_bytes(b"")
    far = part(at=[[100.0, 0.0, 0.0]])
    near = part(at=[[50.0, 0.0, 0.0]])

    def read(path: Path) -> list[Part]:
        return [Part("core", Mesh(CORE.vertices + (50.0, 0.0, 0.0), CORE.triangles), 216.0)]

    one, other = with_files([far, near], [file], read)
    assert one.regions == ()
    assert present(other.regions[0].mesh).vertices == pytest.approx(CORE.vertices)


def test_a_file_that_does_not_exist_or_meets_no_part_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        with_files([part()], [tmp_path / "core.stl"], lambda path: [])
    (tmp_path / "core.stl").write_bytes(b"")
    away = Part("core", Mesh(CORE.vertices + 500.0, CORE.triangles), 216.0)
    with pytest.raises(JobError, match="outside all parts"):
        with_files([part()], [tmp_path / "core.stl"], lambda path: [away])


def test_filled_regions_leave_the_part_and_others_stay():
    rest = without(part(region("a"), region("b")), [region("a")])
    assert [each.name for each in rest.regions] == ["b"]


def test_a_part_without_positions_is_at_the_origin():
    assert part().origins.tolist() == [[0, 0, 0]]
    assert part(at=[[1.0, 2.0, 3.0]]).origins.tolist() == [[1, 2, 3]]
