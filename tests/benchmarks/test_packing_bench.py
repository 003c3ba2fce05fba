"""Packing benchmarks: number of builds and time on published instances and on one plate.

Run with ``pytest tests/benchmarks/test_packing_bench.py``. Other packages are compared if they are installed.
"""

import importlib

import numpy as np
import pytest

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import Boxes, BuildVolume, Item, PackingProblem, Stop, silent
from amprep.plugins.packers.extreme_points import pack_extreme_points
from amprep.plugins.packers.params import ExtremePointsParams
from amprep.testing.packing_instances import MPV_SIDE, mpv_instance

CLASSES = [1, 4, 5, 6, 7, 8]
"""Classes of Martello, Pisinger and Vigo; 2 and 3 are class 1 with the axes exchanged."""


def boxes_of(class_, n, index):
    """Return the sides of the boxes of a published instance."""
    items = mpv_instance(class_, n, index).problem.items
    return [item.volume.enclosing()[1].astype(int).tolist() for item in items]


def problem(sizes, side, **rules):
    items = [Item(i, 0, Boxes(np.zeros((1, 3)), np.array([s], float)), 1.0) for i, s in enumerate(sizes)]
    return PackingProblem(tuple(items), BuildVolume(np.full(3, float(side))), **rules)


def pack(task):
    rng = np.random.default_rng(0)
    return pack_extreme_points(task, params=ExtremePointsParams(), rng=rng, stop=Stop(), progress=silent)


@pytest.mark.parametrize("class_", CLASSES)
@pytest.mark.parametrize("n", [50, 100, 200])
def test_mean_builds_of_ten_instances(benchmark, class_, n):
    tasks = [problem(boxes_of(class_, n, index), MPV_SIDE[class_]) for index in range(1, 11)]
    pack(tasks[0])
    packings = benchmark.pedantic(lambda: [pack(task) for task in tasks], rounds=1)
    assert all(check_packing(task, packing) == [] for task, packing in zip(tasks, packings, strict=True))
    benchmark.extra_info["builds"] = float(np.mean([len(packing.builds) for packing in packings]))
    benchmark.extra_info["bound"] = float(np.mean([packing.bound for packing in packings]))


def test_three_thousand_small_boxes_on_plates(benchmark):
    sizes = np.random.default_rng(1).integers(3, 15, (3000, 3)).tolist()
    task = problem(sizes, 250, clearance=1.0, stacking=False)
    packing = benchmark.pedantic(lambda: pack(task), rounds=1, warmup_rounds=1)
    assert check_packing(task, packing) == []
    benchmark.extra_info["builds"], benchmark.extra_info["bound"] = len(packing.builds), packing.bound


def py3dbp_builds(sizes, side):
    """Return the number of builds of `py3dbp`; only the given orientation is allowed."""
    py3dbp = pytest.importorskip("py3dbp")
    importlib.import_module("py3dbp.constants").RotationType.ALL[:] = [0]
    left, builds = [py3dbp.Item(str(i), *size, 1) for i, size in enumerate(sizes)], 0
    while left:
        packer = py3dbp.Packer()
        packer.add_bin(py3dbp.Bin("bin", side, side, side, 1e9))
        for item in left:
            packer.add_item(item)
        packer.pack(bigger_first=True)
        fitted = {item.name for item in packer.bins[0].items}
        left, builds = [item for item in left if item.name not in fitted], builds + 1
    return builds


def packvium_builds(sizes, side):
    """Return the number of builds of `packvium` with balanced settings; unplaced boxes are packed again."""
    packvium = pytest.importorskip("packvium")
    as_given = importlib.import_module("packvium.geometry").Rotation.all()[:1]
    room = packvium.Container.create("bin", packvium.Dimensions.mm(*map(str, (side,) * 3)))
    packer, left, builds = packvium.Packer(packvium.PackingConfig.balanced()), dict(enumerate(sizes)), 0
    while left:
        items = [
            packvium.Item.create(str(i), packvium.Dimensions.mm(*map(str, size)), allowed_rotations=as_given)
            for i, size in left.items()
        ]
        found = packer.pack(items=items, containers=[room]).containers
        builds += len(found)
        for placement in (placed for container in found for placed in container.placements):
            del left[int(placement.instance.item.id)]
    return builds


def u_nesting_builds(sizes, side):
    """Return the number of builds of `u-nesting` with extreme points, one build after another."""
    u_nesting = pytest.importorskip("u_nesting")
    room, left, builds = {"dimensions": [float(side)] * 3}, dict(enumerate(sizes)), 0
    while left:
        boxes = [
            {"id": str(i), "dimensions": [float(s) for s in size], "quantity": 1, "orientation": "fixed"}
            for i, size in left.items()
        ]
        for placement in u_nesting.solve_3d(boxes, room, {"strategy": "ep"})["placements"]:
            del left[int(placement["geometry_id"])]
        builds += 1
    return builds


@pytest.mark.parametrize("n", [50, 200])
@pytest.mark.parametrize("class_", CLASSES)
@pytest.mark.parametrize("rival", [py3dbp_builds, packvium_builds, u_nesting_builds])
def test_no_other_fast_packer_needs_fewer_builds(benchmark, rival, class_, n):
    tasks = [boxes_of(class_, n, index) for index in range(1, 11)]
    theirs = benchmark.pedantic(lambda: [rival(sizes, MPV_SIDE[class_]) for sizes in tasks], rounds=1)
    ours = [len(pack(problem(sizes, MPV_SIDE[class_])).builds) for sizes in tasks]
    benchmark.extra_info["builds"], benchmark.extra_info["ours"] = (
        float(np.mean(theirs)),
        float(np.mean(ours)),
    )
    assert np.mean(ours) <= np.mean(theirs)
