"""A small instance of the ESICUP format is read, packed and judged on its meshes."""

import json

import numpy as np
import pytest
import trimesh

from amprep.bench.packing.esicup import EsicupBench, read_esicup, summary
from amprep.errors import InputError


@pytest.fixture
def instance_file(tmp_path):
    trimesh.creation.box((2.0, 2.0, 2.0)).export(tmp_path / "cube.stl")
    (tmp_path / "Small").mkdir()
    prism = trimesh.convex.convex_hull(
        np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2], [2, 0, 2], [0, 2, 2]])
    )
    prism.update_faces(np.arange(len(prism.faces)) > 0)  # open, as some meshes of the sets are
    prism.export(tmp_path / "Small" / "prism.stl")
    rows = [{"path": "Sets/cube.stl", "demand": 2}, {"path": "Sets/Small/prism.stl", "demand": 1}]
    record = {"container": {"size-x": 4.0, "size-y": 2.0}, "item-types": rows}
    path = tmp_path / "Small1.json"
    path.write_text(json.dumps(record), encoding="utf-8")
    return path


def test_every_seed_gives_a_layout_that_is_valid_on_the_meshes(instance_file):
    instance = read_esicup(instance_file)
    assert [part.quantity for part in instance.parts] == [2, 1]
    assert instance.record is None
    bench = EsicupBench(instance, "separation")
    results = [bench.run(seed, 1000.0, {"work": 2.0}) for seed in (1, 2)]  # the work ends the search
    assert [result.validated for result in results] == [True, True]
    assert 4.0 <= summary(results)["least_height_mm"] <= 6.0 + 1e-3  # one above the other, compacted
    assert results[0].density == pytest.approx((8 + 8 + 4) / (8 * results[0].height_mm), rel=1e-3)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"container": {"size-x": 4.0}}, "size-y is missing"),
        ({"container": {"size-x": -4.0, "size-y": 1}}, "positive sizes"),
        ({"item-types": [{"path": "cube.stl", "demand": 0}]}, "at least 1"),
        ({"item-types": [{"path": "ball.stl", "demand": 1}]}, "ball.stl is not in"),
    ],
)
def test_a_wrong_file_is_refused_with_its_fault(instance_file, change, complaint):
    record = json.loads(instance_file.read_text(encoding="utf-8")) | change
    instance_file.write_text(json.dumps(record), encoding="utf-8")
    with pytest.raises(InputError, match=complaint):
        read_esicup(instance_file)


def test_meshes_of_the_same_name_are_told_apart_by_their_folders(instance_file):
    folder = instance_file.parent
    (folder / "other" / "clean").mkdir(parents=True)
    trimesh.creation.box((1.0, 1.0, 1.0)).export(folder / "other" / "clean" / "cube.stl")
    record = json.loads(instance_file.read_text(encoding="utf-8"))
    record["item-types"] = [
        {"path": "Sets/other/clean/cube.stl", "demand": 1},
        {"path": "cube.stl", "demand": 1},
    ]
    instance_file.write_text(json.dumps(record), encoding="utf-8")
    assert [part.volume_mm3 for part in read_esicup(instance_file).parts] == pytest.approx([1.0, 8.0])
