"""The target programs, if installed, accept build files without moving anything."""

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.shared.optional import present

from amprep.threemf import write_build
from amprep.threemf.build.identifier import object_name, title_of

PRUSA_SLICER = shutil.which("prusa-slicer")
SYSTEM_PYTHON = "/usr/bin/python3"

LIST_NODES = """
import json, sys, zipfile, Savitar
model = zipfile.ZipFile(sys.argv[1]).read("3D/3dmodel.model")
def nodes(parents):
    for node in parents:
        settings = {name: entry.value for name, entry in node.getSettings().items()}
        size = len(node.getMeshData().getVerticesAsBytes()) // 12
        yield [node.getName(), settings.get("support_mesh"), node.getTransformation(), size]
        yield from nodes(node.getChildren())
print(json.dumps(list(nodes(Savitar.ThreeMFParser().parse(model).getSceneNodes()))))
"""


def has_savitar():
    return (
        Path(SYSTEM_PYTHON).exists()
        and not subprocess.run(
            [SYSTEM_PYTHON, "-c", "import Savitar"], capture_output=True, check=False
        ).returncode
    )


def slice_with_prusa_slicer(path):
    gcode = path.with_suffix(".gcode")
    options = ["--export-gcode", "--dont-arrange", "--no-ensure-on-bed", "--gcode-label-objects"]
    run = subprocess.run(
        [present(PRUSA_SLICER), *options, "-o", gcode, path],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    return gcode.read_text(encoding="utf-8").splitlines()


def extents(gcode):
    """Return the smallest and largest printed x and y of each labelled object."""
    found: dict[str, Any] = {}
    label, here = None, np.zeros(2)
    for line in gcode:
        if line.startswith("; printing object "):
            label = line.removeprefix("; printing object ").partition(" id:")[0]
        elif line.startswith("; stop printing object"):
            label = None
        elif line.startswith("G1 "):
            there = {axis: float(value) for axis, value in re.findall(r"([XYE])(-?[\d.]+)", line)}
            last, here = here, np.array([there.get("X", here[0]), there.get("Y", here[1])])
            if label and there.get("E", 0) > 0 and {"X", "Y"} & set(there):
                found.setdefault(label, []).extend([last, here])
    return {name: (np.min(points, axis=0), np.max(points, axis=0)) for name, points in found.items()}


@pytest.mark.skipif(PRUSA_SLICER is None, reason="PrusaSlicer is not installed")
@pytest.mark.parametrize("share", [False, True])
def test_prusaslicer_prints_parts_and_supports_in_their_positions(make_build, tmp_path, share):
    build = make_build("prusaslicer", share=share)
    write_build(build, tmp_path / "job.3mf")
    printed = extents(slice_with_prusa_slicer(tmp_path / "job.3mf"))
    groups = [([1, 2], [1])] if share else [([1], [1])]
    for parts, supports in [([0], [0]), *groups]:
        label = object_name(" + ".join(build.parts[index].label for index in parts), title_of(build))
        meshes = [build.parts[index].mesh for index in parts] + [
            build.supports[index].mesh for index in supports
        ]
        corners = np.vstack([mesh.vertices for mesh in meshes])[:, :2]
        # the middle of an extrusion lies up to half a line inside the contour
        assert printed[label][0] == pytest.approx(corners.min(axis=0), abs=0.5)
        assert printed[label][1] == pytest.approx(corners.max(axis=0), abs=0.5)


@pytest.mark.skipif(PRUSA_SLICER is None, reason="PrusaSlicer is not installed")
def test_prusaslicer_reads_a_part_and_its_support_as_one_object(make_build, tmp_path):
    write_build(make_build("prusaslicer"), tmp_path / "job.3mf")
    run = subprocess.run(
        [present(PRUSA_SLICER), "--info", tmp_path / "job.3mf"],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert re.findall(r"number_of_facets = +(\d+)", run.stdout) == ["24", "24", "12"]


@pytest.mark.skipif(not has_savitar(), reason="Cura's parser is not installed")
def test_the_parser_of_cura_marks_supports_and_places_parts(make_build, tmp_path):
    write_build(make_build("cura"), tmp_path / "job.3mf")
    listed = subprocess.run(
        [SYSTEM_PYTHON, "-c", LIST_NODES, tmp_path / "job.3mf"], capture_output=True, text=True, check=True
    )
    nodes = [node for node in json.loads(listed.stdout) if node[3]]
    assert nodes == [
        ["plate & <tray>", None, "1 0 0 0 1 0 0 0 1 10.123456 20 3", 8],
        ["support 1 of plate", "True", "", 8],
        ["bar", None, "0 1 0 -1 0 0 0 0 1 80.1 60.333333 3", 8],
        ["support 2", "True", "", 8],
        ["plate & <tray>", None, "1 0 0 0 1 0 0 0 1 123.456789 150 3", 8],
    ]
