"""`amprep lattice` from the command line: files, reports and errors."""

import json

import pytest
import trimesh

WEB = 7798.146
"""mm3 of the wheel that the modifier marks; fixtures/README.md."""

WHEEL = 14466.126


def read(path):
    return trimesh.load(path, force="mesh")


def test_the_web_of_a_wheel_becomes_cells_in_a_file_that_run_packs(amprep, fixtures, tmp_path):
    done = amprep(
        "lattice", fixtures / "wheel.3mf", "--cell", "strut", "--size", 4.5, "-o", tmp_path, "--stl",
        "--set", "cells.density_g_cm3=4.4",
    )  # fmt: skip
    assert done.code == 0
    assert "wrote wheel.lattice.3mf" in done.out
    report = json.loads((tmp_path / "wheel.lattice.report.json").read_text(encoding="utf-8"))
    (part,) = report["parts"]
    assert (part["name"], part["regions"], part["violations"]) == ("wheel", ["web"], [])
    assert part["region_volume_mm3"] == pytest.approx(WEB, rel=1e-5)
    assert part["volume_after_mm3"] == pytest.approx(WHEEL - WEB + part["cell_volume_mm3"], rel=1e-5)
    assert part["mass_after_g"] == pytest.approx(part["volume_after_mm3"] * 0.0044)
    for name in ("wheel.lattice.3mf", "wheel.lattice.001.wheel.stl"):
        mesh = read(tmp_path / name)
        assert mesh.is_watertight
        assert mesh.volume == pytest.approx(part["volume_after_mm3"], rel=1e-4)
    assert sorted(report["files"]) == sorted(path.name for path in tmp_path.iterdir())
    packed = amprep(
        "run", tmp_path / "wheel.lattice.3mf", "--dry-run", "--json", "--set", "supports.enabled=false"
    )
    assert packed.code == 0
    (only,) = packed.json["builds"][0]["parts"]
    assert (only["name"], only["triangles"]) == ("wheel", part["triangles"])


def test_beams_are_written_with_the_solid_and_clipped_by_the_part(amprep, fixtures, tmp_path):
    import lib3mf

    file = tmp_path / "beams.3mf"
    words = ("--cell", "bcc", "--size", 9, "--lattice", "beams", "-q")
    done = amprep("lattice", fixtures / "wheel.3mf", *words, "-o", file)
    assert (done.code, done.out) == (0, "")
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(file))
    objects = model.GetMeshObjects()
    found = {}
    while objects.MoveNext():
        found[objects.GetCurrentMeshObject().GetName()] = objects.GetCurrentMeshObject()
    beams = found["wheel"].BeamLattice()
    assert beams.GetBeamCount() > 100
    mode, clipping = beams.GetClipping()
    assert (mode, clipping) == (lib3mf.BeamLatticeClipMode.Inside, found["outline of wheel"].GetResourceID())


def test_a_mesh_file_marks_a_region_and_trapped_powder_is_reported(amprep, tmp_path):
    trimesh.creation.box((20, 20, 20)).export(tmp_path / "block.stl")
    trimesh.creation.box((12, 12, 12)).export(tmp_path / "core.stl")
    done = amprep(
        "lattice", tmp_path / "block.stl", "--region", tmp_path / "core.stl", "--cell", "strut", "--dry-run"
    )
    assert done.code == 0
    assert "of powder in 1 pocket cannot leave" in " ".join(done.out.split())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["block.stl", "core.stl"]


def test_a_shell_leaves_a_wall_around_cells(amprep, tmp_path):
    trimesh.creation.box((16, 16, 16)).export(tmp_path / "block.stl")
    done = amprep(
        "lattice", tmp_path / "block.stl", "--shell", 2, "--cell", "strut", "--dry-run", "--json", "-q"
    )
    assert done.code == 0
    (part,) = done.json["parts"]
    assert 0.95 * 12**3 < part["region_volume_mm3"] <= 12**3 + 1e-6


def test_a_cell_that_does_not_hold_the_part_together_gives_exit_code_1(amprep, tmp_path):
    trimesh.creation.box((12, 12, 12)).export(tmp_path / "block.stl")
    trimesh.creation.box((14, 14, 4)).export(tmp_path / "cut.stl")
    trimesh.creation.box((0.5, 0.5, 0.5)).apply_translation([0.5, 0.5, 0.5]).export(tmp_path / "crumb.stl")
    done = amprep(
        "lattice", tmp_path / "block.stl", "--region", tmp_path / "cut.stl", "--cell", tmp_path / "crumb.stl",
        "--size", 4, "--dry-run",
    )  # fmt: skip
    assert done.code == 1
    assert "in one piece" in done.out


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ((), "no region to fill: mark one as a modifier"),
        (("--region", "nowhere.stl"), "nowhere.stl: no such file"),
        (("--shell", "-1"), "--shell must be above 0 and below 10000 mm, got -1"),
        (("--shell", "9"), "block must be thicker than twice the shell of 9 mm"),
        (("--shell", "2", "--region-name", "x"), "use it without --region and --region-name"),
        (("--shell", "2", "--cell", "bbc"), "no lattice cell is called 'bbc' (did you mean 'bcc'?)"),
        (("--region", "far.stl"), "the region is outside all parts"),
        (("--region", "open.stl"), "the region 'open' is not a closed mesh"),
    ],
)
def test_user_errors_give_one_line_and_nothing_is_written(amprep, tmp_path, monkeypatch, words, line):
    monkeypatch.chdir(tmp_path)
    box = trimesh.creation.box((8, 8, 8))
    box.export("block.stl")
    trimesh.creation.box((1, 1, 1)).apply_translation([50, 0, 0]).export("far.stl")
    trimesh.Trimesh(box.vertices, box.faces[1:]).export("open.stl")
    done = amprep("lattice", "block.stl", *words)
    (said,) = [each for each in done.err.splitlines() if each.startswith("amprep:")]
    assert done.code == 2
    assert line in said
    assert len(list(tmp_path.iterdir())) == 3


def test_a_region_is_chosen_by_its_name(amprep, fixtures, tmp_path):
    done = amprep("lattice", fixtures / "wheel.3mf", "--region-name", "wep", "-o", tmp_path)
    assert done.code == 2
    assert "no region is called 'wep' (did you mean 'web'?)" in done.err
