"""Jobs with cells that engineers declare: by name, drawn in OpenSCAD, written as TOML; and the command `cells`."""

import pytest

CORNERS = [[x, y, z] for z in (0, 1) for y in (0.25, 0.75) for x in (0.25, 0.75)]
TRIANGLES = (
    *((0, 2, 3), (0, 3, 1), (4, 7, 6), (4, 5, 7), (0, 1, 5), (0, 5, 4)),
    *((2, 7, 3), (2, 6, 7), (0, 4, 6), (0, 6, 2), (1, 7, 5), (1, 3, 7)),
)

TREE = """
author = "A. N. Engineer"
points = [[0.5, 0.5, 0], [0.5, 0.5, 1]]
struts = [[0, 1, 0.6]]

[[variant]]
when = {role = "foot"}
points = [[0.5, 0.5, 0], [0.5, 0.5, 1]]
struts = [[0, 1, 1.0, 0.6]]
"""

BY_PROMISES_OF_CELLS = (
    *("--set", "supports.leg_ratio=0", "--set", "supports.least_wall_mm=0"),
    *("--set", "supports.least_contact_mm2=0"),
)
"""Settings without the limits of metal: at a pitch of 4 mm, lone pins of 0.8 mm are legs longer than ten widths, so
that supports are left out and the job ends with 1. `bcc` and `hatch` keep the limits."""

LIMITS_OF: dict[str, tuple[str, ...]] = {"strut": BY_PROMISES_OF_CELLS, "bcc": (), "hatch": ()}
"""Settings for each built-in lattice."""


def openscad_stl():
    lines = ["solid OpenSCAD_Model"]
    for triangle in TRIANGLES:
        lines += ["  facet normal 0 0 0", "    outer loop"]
        lines += ["      vertex {:g} {:g} {:g}".format(*CORNERS[corner]) for corner in triangle]
        lines += ["    endloop", "  endfacet"]
    return "\n".join([*lines, "endsolid OpenSCAD_Model", ""])


@pytest.mark.parametrize(("name", "content"), [("post.stl", openscad_stl()), ("tree.toml", TREE)])
def test_a_cell_from_a_file_supports_a_job_that_passes_every_judge(amprep, fixtures, tmp_path, name, content):
    cell = tmp_path / name
    cell.write_text(content, encoding="utf-8")
    checked = amprep("cells", "check", cell, "--pitch", "4")
    assert checked.code == 0, checked.out + checked.err
    done = amprep(
        "run",
        fixtures / "table.stl",
        "--cell",
        cell,
        "--set",
        "supports.pitch_mm=4",
        "--set",
        "supports.reach_mm=5",
        *BY_PROMISES_OF_CELLS,
        "-o",
        tmp_path,
    )
    assert done.code == 0, done.err
    assert "yes" in done.out
    assert amprep("verify", tmp_path / "table.build-1.3mf").code == 0


@pytest.mark.parametrize("name", ["strut", "bcc", "hatch"])
def test_a_built_in_lattice_supports_a_job_that_passes_every_judge(amprep, fixtures, tmp_path, name):
    done = amprep(
        "run",
        fixtures / "table.stl",
        "--cell",
        name,
        "--set",
        "supports.pitch_mm=4",
        "--set",
        "supports.reach_mm=5",
        *LIMITS_OF[name],
        "-o",
        tmp_path,
    )
    assert done.code == 0, done.err
    assert amprep("verify", tmp_path / "table.build-1.3mf").code == 0


def test_a_cell_that_breaks_a_promise_gives_1_and_a_wrong_file_2(amprep, tmp_path):
    flat = tmp_path / "flat.toml"
    flat.write_text(
        "points = [[0.5, 0.5, 0], [0.5, 0.5, 1], [0, 0.5, 0.2], [1, 0.5, 0.2]]\nstruts = [[0, 1], [0, 2], [0, 3]]\n"
    )
    assert amprep("cells", "check", flat).code == 1
    flat.write_text("points = 3")
    wrong = amprep("cells", "check", flat)
    assert (wrong.code, wrong.out) == (2, "")
    assert "points must be a list of rows of 3 numbers" in wrong.err
    missing = amprep("cells", "check", tmp_path / "none.stl")
    assert missing.code == 2


@pytest.mark.parametrize("name", ["strut", "bcc"])
def test_beams_hold_a_part_in_a_file_that_verifies(amprep, fixtures, tmp_path, name):
    from amprep.threemf import read_build

    done = amprep(
        *("run", fixtures / "table.stl", "--cell", name, "--lattice", "beams", "--supports-as", "model"),
        *("--set", "supports.pitch_mm=4", "--set", "supports.reach_mm=5", "-o", tmp_path),
        *LIMITS_OF[name],
    )
    assert done.code == 0, done.err
    path = tmp_path / "table.build-1.3mf"
    assert amprep("verify", path).code == 0
    build = read_build(path)
    assert build.settings.supports_as == "model"
    assert all(body.lattice is not None for body in build.supports)


def test_slicers_and_whoever_asks_for_meshes_get_no_beams(amprep, fixtures, tmp_path):
    from amprep.threemf import read_build

    for option, word in (("--lattice", "mesh"), ("--for", "prusaslicer")):
        done = amprep(
            *("run", fixtures / "table.stl", "--cell", "strut", "--set", "cells.params.solid=false"),
            *(
                option,
                word,
                "--set",
                "supports.pitch_mm=4",
                "--set",
                "supports.reach_mm=5",
                "-o",
                tmp_path / word,
                *BY_PROMISES_OF_CELLS,
            ),
        )
        assert done.code == 0, done.err
        build = read_build(tmp_path / word / "table.build-1.3mf")
        assert all(body.lattice is None for body in build.supports)


def test_beams_with_connectors_of_cells_are_refused_in_one_line(amprep, fixtures, tmp_path):
    done = amprep(
        *("run", fixtures / "table.stl", "--cell", "strut", "--lattice", "beams"),
        *(
            "--set",
            "cells.connector=extend",
            "--set",
            "supports.pitch_mm=4",
            "--set",
            "supports.reach_mm=5",
            "-o",
            tmp_path,
        ),
    )
    assert (done.code, "cells.connector = 'full'" in done.err) == (2, True)
