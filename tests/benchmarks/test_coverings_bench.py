"""Coverings with boxes: their size, their time, and what packers gain by them.

Run with ``pytest tests/benchmarks/test_coverings_bench.py``. ``AMPREP_PARTS`` may name a folder of STL files: the same
is then measured on 24 of the parts in it.
"""

import os
import time
from pathlib import Path

import numpy as np
import pytest
from tests.shared.coverings import part_of, solid_of

from amprep.checks.packing.volumes_placed import check_packing
from amprep.checks.volumes import check_volume
from amprep.geometry.bounding.boxes.union import union_volume
from amprep.host import Host
from amprep.model import Boxes, BuildVolume, Item, Orientations, PackingProblem, Stop, silent
from amprep.model.bounding_volume import as_turned
from amprep.model.rotations import quarter_turns

HOST = Host.load()
MAKERS = ["box", "boxes-kmeans", "boxes-two", "boxes-branch-and-cut"]
PACKERS = {"extreme-points": "builds", "tabu": "builds", "auto": "fill", "ip": "fill"}
LIMIT_S = {"ip": 20.0}


def made_parts(kind, count, seed=1):
    """Parts like an L, a T or a U, of two or three boxes; ``LTU`` takes turns."""
    rng = np.random.default_rng(seed)
    parts = []
    for number in range(count):
        x, y, base, arm, height = (int(n) for n in rng.integers([14, 14, 4, 4, 6], [31, 31, 9, 9, 16]))
        letter = kind[number % len(kind)]
        first = {"L": 0, "T": (x - arm) // 2, "U": 0}[letter]
        boxes = [[0, 0, 0, x, base, height], [first, 0, 0, first + arm, y, height]]
        boxes += [[x - arm, 0, 0, x, y, height]] * (letter == "U")
        parts.append(solid_of(boxes, f"{letter}{number}"))
    return parts


def real_parts():
    """Solids of at most 120 mm among the files of a folder, in the order of their names."""
    from amprep import load

    folder = os.environ.get("AMPREP_PARTS")
    if not folder:
        pytest.skip("AMPREP_PARTS names no folder of STL files")
    parts = []
    for path in sorted(Path(folder).glob("*.[sS][tT][lL]")):
        part = load(path).parts[0]
        if part.is_solid and np.ptp(part.mesh.bounds, axis=0).max() <= 120:
            parts.append(part)
        if len(parts) == 24:
            break
    return parts


def bounded(part, maker):
    listed = HOST.choose("volume", maker)
    made = HOST.call(listed, part, params=HOST.params(listed, {}), rng=np.random.default_rng(0), stop=Stop())
    return as_turned(made).volume


def problem(parts, maker, room, objective):
    turns = Orientations("list", quarter_turns())
    volumes = [bounded(part, maker) for part in parts]
    items = [
        Item(n, 0, volume, part.volume_mm3, turns)
        for n, (part, volume) in enumerate(zip(parts, volumes, strict=True))
    ]
    return PackingProblem(tuple(items), BuildVolume(np.array(room, float)), objective)


def measure(benchmark, task, packer):
    listed = HOST.choose("packer", packer)
    packing = benchmark.pedantic(
        lambda: HOST.call(
            listed,
            task,
            params=HOST.params(listed, {}),
            rng=np.random.default_rng(0),
            stop=Stop.after(LIMIT_S.get(packer)),
            progress=silent,
        ),
        rounds=1,
    )
    assert check_packing(task, packing) == []
    placed = [task.items[placed.item].value for placed in packing.builds[0]] if packing.builds else []
    benchmark.extra_info["builds"] = len(packing.builds)
    benchmark.extra_info["density"] = sum(placed) / float(np.prod(task.space.size))


@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize("packer", PACKERS)
@pytest.mark.parametrize("kind", ["L", "T", "U", "LTU"])
def test_packing_parts_of_few_boxes(benchmark, kind, packer, maker):
    count, room = (8, (45, 45, 16)) if packer == "ip" else (48, (60, 60, 40))
    objective = PACKERS[packer]
    measure(benchmark, problem(made_parts(kind, count), maker, room, objective), packer)


@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize("packer", ["extreme-points", "auto"])
def test_packing_real_parts(benchmark, packer, maker):
    measure(benchmark, problem(real_parts(), maker, (150, 150, 100), PACKERS[packer]), packer)


@pytest.mark.parametrize("maker", MAKERS[1:])
def test_covering_a_part_of_a_hundred_thousand_triangles(benchmark, maker):
    from manifold3d import Manifold

    bracket = Manifold.cube([60, 12, 40]) + Manifold.cube([12, 50, 12]) - Manifold.cylinder(40, 6, 9, 500)
    part = part_of((bracket + Manifold.sphere(15, 560).translate([50, 6, 40])).rotate([0, 10, 0]))
    assert len(part.mesh.triangles) > 90_000
    bounded(part, maker)
    start = time.process_time()
    volume = benchmark.pedantic(lambda: bounded(part, maker), rounds=1)
    assert time.process_time() - start < 0.3  # 0.2 s on a quiet machine
    assert check_volume(part, volume) == []
    least, most = part.mesh.bounds
    assert isinstance(volume, Boxes)
    union = union_volume(np.hstack((volume.lo, volume.hi)))
    benchmark.extra_info["ratio to the enclosing box"] = union / float(np.prod(most - least))
