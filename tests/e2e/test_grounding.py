"""Supports that stand on the part where no way leads to the plate, when the user allows it."""

import manifold3d
import pytest
import trimesh

from amprep.threemf import read_build

Solid = manifold3d.Manifold
CHEST = Solid.cube((40, 40, 40)) - Solid.cube((30, 30, 25)).translate((5, 5, 8))
"""A closed chest: its lid hangs over a floor at 8 mm."""


def write(solid, path):
    mesh = solid.to_mesh()
    trimesh.Trimesh(mesh.vert_properties[:, :3], mesh.tri_verts, process=False).export(path)
    return path


def supported(amprep, tmp_path, solid, *more):
    path = write(solid, tmp_path / "part.stl")
    options = ["--center", "--json", "-o", tmp_path / "out", *more]
    outcome = amprep("support", path, *options)
    build = read_build(tmp_path / "out" / "part.supported.3mf")
    return outcome, outcome.json["builds"][0]["supports"], build


def test_by_default_everything_stands_on_the_plate_and_the_rest_is_enclosed(amprep, tmp_path):
    outcome, supports, build = supported(amprep, tmp_path, CHEST)
    assert outcome.code == 1
    assert {square["reason"] for square in supports["unconnected_squares"]} == {"enclosed"}
    assert build.settings.rules.grounding == "plate-only"
    assert build.supports == ()


@pytest.mark.parametrize("cell", ["prism", "x-wall"])
def test_columns_stand_on_the_floor_of_a_closed_chest(amprep, tmp_path, cell):
    outcome, supports, build = supported(amprep, tmp_path, CHEST, "--grounding", "anywhere", "--cell", cell)
    assert outcome.code == 0
    assert "columns on parts" in supports["notes"][0]
    assert build.settings.rules.grounding == "anywhere"
    low, high = build.supports[0].mesh.bounds
    assert low[2] == pytest.approx(8.0 - 0.1, abs=1e-3), "as deep in the floor as in the lid"
    assert high[2] == pytest.approx(33.1, abs=1e-3)
    assert amprep("verify", tmp_path / "out" / "part.supported.3mf").code == 0


def test_feet_meet_a_slanting_floor_all_over(amprep, tmp_path):
    """Full columns fill the cavity, from the floor to the lid: no wedge of air is left under them."""
    floor = Solid.cube((80, 80, 40)).rotate((20, 12, 0)).translate((-10, -20, -24))
    cavity = Solid.cube((30, 30, 34)).translate((5, 5, 10)) - floor
    slant = Solid.cube((40, 40, 50)) - cavity
    _, _, build = supported(
        amprep, tmp_path, slant, "--grounding", "anywhere", "--cell", "prism", "--set", "supports.pitch_mm=2"
    )
    (body,) = build.supports
    overlaps = 2 * 30 * 30 * 0.1
    assert body.mesh.signed_volume == pytest.approx(cavity.volume() + overlaps, rel=0.01)
    assert amprep("verify", tmp_path / "out" / "part.supported.3mf").code == 0


def test_what_reaches_the_plate_still_does(amprep, tmp_path):
    table = Solid.cube((30, 30, 3)).translate((0, 0, 20)) + Solid.cube((6, 6, 20)).translate((12, 12, 0))
    _, _, plate = supported(amprep, tmp_path, table, "--cell", "prism")
    _, supports, anywhere = supported(amprep, tmp_path, table, "--cell", "prism", "--grounding", "anywhere")
    assert not [words for words in supports["notes"] if "columns on parts" in words]
    assert supports["shared_supports"] == []
    assert anywhere.supports[0].mesh.digest == plate.supports[0].mesh.digest


def test_a_file_that_claims_the_plate_is_judged_by_it(amprep, tmp_path):
    """The judge knows from the file alone whether supports may stand on parts."""
    import zipfile

    supported(amprep, tmp_path, CHEST, "--grounding", "anywhere", "--cell", "prism")
    claimed = tmp_path / "claimed.3mf"
    with (
        zipfile.ZipFile(tmp_path / "out" / "part.supported.3mf") as old,
        zipfile.ZipFile(claimed, "w") as new,
    ):
        for name in old.namelist():
            new.writestr(
                name, old.read(name).replace(b'"grounding": "anywhere"', b'"grounding": "plate-only"')
            )
    outcome = amprep("verify", claimed, "--json")
    assert outcome.code == 1
    assert "support stands on the plate" in {each["promise"] for each in outcome.json["violations"]}


def test_walls_without_thickness_and_wrong_words_are_refused(amprep, tmp_path):
    path = write(CHEST, tmp_path / "part.stl")
    thin = ["--set", "cells.params.wall_mm=0", "--set", "cells.connector=extend"]
    outcome = amprep("support", path, "--center", "--grounding", "anywhere", "--cell", "x-wall", *thin)
    assert outcome.code == 2
    assert "thickness" in outcome.err
    assert amprep("support", path, "--center", "--grounding", "somewhere").code == 2
