"""Parts are packed on plates, and every plate is judged as polygons and on the meshes."""

import numpy as np
import pytest
import trimesh

from amprep.bench.plates.run import PlatesBench, PlatesResult, judge_plates, ratios_to, read_scene
from amprep.checks.packing.pairs import PairCounts
from amprep.errors import InputError
from amprep.model import PlacedPart


@pytest.fixture
def folder(tmp_path):
    trimesh.creation.box((30.0, 10.0, 5.0)).export(tmp_path / "long.stl")
    trimesh.creation.box((12.0, 12.0, 12.0)).export(tmp_path / "cube.stl")
    trimesh.creation.annulus(8.0, 14.0, 4.0).export(tmp_path / "ring.stl")
    return tmp_path


def test_packers_report_valid_plates_and_their_bound(folder):
    scene = read_scene([folder], (40.0, 40.0), 1.0, "z90")
    assert scene.copies == 3
    ring = 0.5 * 32 * np.sin(2 * np.pi / 32) * (14.0**2 - 8.0**2)
    assert scene.shadow_area == pytest.approx(300 + 144 + ring, rel=1e-6)
    bench = PlatesBench(scene, "extreme-points")
    result = bench.run(1, 5.0)
    assert result.validated, result.faults
    assert (result.plates, result.unplaced) == (2, 0)
    assert result.bound is not None
    assert result.bound <= 2
    assert result.filled == pytest.approx(scene.shadow_area / 3200.0)
    assert result.record["validated"] is True


def test_wrong_plates_are_reported_by_both_checks(folder):
    scene = read_scene([folder / "cube.stl"], (40.0, 40.0), 1.0, "none")
    matrix, moved = np.eye(4), np.eye(4)
    matrix[:3, 3], moved[:3, 3] = (8, 8, 6), (19, 8, 6)
    plate = [PlacedPart(name, scene.parts[0], m) for name, m in (("a", matrix), ("b", moved))]
    judged = judge_plates(scene, [plate])
    assert ["shadows apart" in fault for fault in judged.faults] == [True, False]
    assert "no intersection" in judged.faults[1]


def test_a_folder_without_parts_is_refused(tmp_path):
    with pytest.raises(InputError):
        read_scene([tmp_path], (40.0, 40.0), 1.0, "none")


def made(packer, plates, faults=()):
    return PlatesResult(packer, 1, plates, None, "", 0.5, 0, 1.0, 1.0, None, 0.1, PairCounts(), faults)


def test_ratios_compare_means_of_valid_results():
    results = [made("a", 2), made("a", 3), made("b", 4), made("b", 1, ("wrong",)), made("c", 5)]
    assert ratios_to("c", results) == {"a": pytest.approx(0.5), "b": pytest.approx(0.8)}
    assert ratios_to("d", results) == {}
