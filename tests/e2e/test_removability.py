"""The report states contacts, mass, scanned area and trapped powder of supports."""

import json

import pytest
import trimesh


def supports(amprep, tmp_path, fixture, *sets):
    """Return the figures of the supports of a run, and its exit code."""
    keys = [
        word for key in ("cells.removability=true", "packing.lift_mm=3", *sets) for word in ("--set", key)
    ]
    done = amprep("run", fixture, "--cell", "x-wall", "-o", tmp_path, *keys)
    name = f"{fixture.stem}.report.json"
    return json.loads((tmp_path / name).read_text(encoding="utf-8"))["builds"][0]["supports"], done


def test_low_x_walls_with_gaps_trap_no_powder_below_a_horizontal_plate(amprep, tmp_path):
    trimesh.creation.box((24, 24, 4)).export(tmp_path / "plate.stl")
    found, done = supports(amprep, tmp_path, tmp_path / "plate.stl", "supports.pitch_mm=2")
    assert found["trapped_powder_mm3"] == 0.0
    assert "powder that cannot leave" not in " ".join(done.out.split())


def test_x_walls_without_gaps_trap_powder_which_is_not_a_fault(amprep, fixtures, tmp_path):
    joined = ("supports.pitch_mm=4", "supports.reach_mm=5", "cells.params.join_every=1")
    found, done = supports(amprep, tmp_path, fixtures / "table.stl", *joined)
    assert done.code == 0
    assert "powder that cannot leave" in " ".join(done.out.split())
    pockets = [pocket for body in found["bodies"] for pocket in body["pockets"]]
    assert len(pockets) > 50
    assert found["trapped_powder_mm3"] == pytest.approx(sum(pocket["volume_mm3"] for pocket in pockets))


@pytest.mark.parametrize("name", ["ball", "two-balls"])
def test_x_walls_with_gaps_trap_no_powder_and_joined_ones_do(amprep, fixtures, tmp_path, name):
    gap, done = supports(amprep, tmp_path / "gap", fixtures / f"{name}.stl")
    assert (
        gap["trapped_powder_mm3"] < 0.01
    )  # at most one voxel of the measurement, beside a rest that was cut away
    assert done.code == 0
    joined, _ = supports(amprep, tmp_path / "joined", fixtures / f"{name}.stl", "cells.params.join_every=1")
    assert joined["trapped_powder_mm3"] > 100.0


def test_mass_and_scanned_area_follow_from_the_volume(amprep, fixtures, tmp_path):
    keys = ("supports.pitch_mm=4", "supports.reach_mm=5", "cells.density_g_cm3=8", "supports.layer_mm=0.05")
    found, _ = supports(amprep, tmp_path, fixtures / "table.stl", *keys)
    assert found["mass_g"] == pytest.approx(found["volume_mm3"] * 0.008)
    assert found["scanned_area_mm2"] == pytest.approx(found["volume_mm3"] / 0.05)
    assert 0.0 < found["contact_area_mm2"] <= 1600.0
    assert found["contact_patches"] >= 1
