"""The built-in profiles are complete and plausible, and the page about materials shows the same figures."""

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from amprep.cli.catalogues.materials import app
from amprep.job import make_job
from amprep.materials.catalogue import find_material, list_materials
from amprep.materials.profile import MaterialProfile

PAGE = (Path(__file__).parents[3] / "docs" / "materials.md").read_text(encoding="utf-8")
MATERIALS = {each.name: each.profile for each in list_materials(env={"HOME": "/nowhere"})[0]}
ALLOYS = {"AlSi10Mg", "Ti6Al4V", "316L", "IN718", "CoCr", "MS1"}
PLASTICS = {"PLA", "PETG", "PA12"}


@pytest.mark.parametrize("name", sorted(MATERIALS))
def test_every_profile_states_its_sources(name):
    assert len(MATERIALS[name].source) > 20


def test_no_two_profiles_share_a_name():
    names = [word for each in MATERIALS.values() for word in (each.name, *each.aliases)]
    assert len({word.casefold() for word in names}) == len(names)


@pytest.mark.parametrize("name", sorted(ALLOYS | PLASTICS))
def test_every_alloy_and_plastic_has_a_density_and_the_limits_of_its_base(name):
    profile = MATERIALS[name]
    base = MATERIALS[profile.based_on]
    assert (2.0 if name in ALLOYS else 0.9) < present_density(profile) < (9.0 if name in ALLOYS else 1.5)
    assert [getattr(profile, key) for key in ("ledge_mm", "bridge_mm", "bore_mm", "plate_mm")] == [
        getattr(base, key) for key in ("ledge_mm", "bridge_mm", "bore_mm", "plate_mm")
    ]


def present_density(profile: MaterialProfile) -> float:
    assert profile.density_g_cm3 is not None
    return profile.density_g_cm3


def test_the_page_shows_the_figures_of_the_alloys():
    rows = re.findall(r"^\| `(\w+)` \| ([\d.]+) \| ([\d.]+) \| ([\w. `]+) \|", PAGE, re.MULTILINE)
    shown = {name: (float(density), float(layer)) for name, density, layer, _ in rows if name in ALLOYS}
    assert shown == {name: (MATERIALS[name].density_g_cm3, MATERIALS[name].layer_mm) for name in ALLOYS}
    speeds = {
        name: float(speed) for name, *_, speed in rows if re.fullmatch(r"[\d.]+", speed) and name in ALLOYS
    }
    assert speeds == {name: MATERIALS[name].scan_mm2_s for name in speeds}
    assert len(speeds) == 3


def test_the_page_shows_the_limits_of_metal():
    rows = re.findall(r"^\| `([\w-]+)` \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \| [a-z]", PAGE, re.MULTILINE)
    shown = {
        name: tuple(map(float, limits)) for name, *limits in rows if name.startswith(("metal", "plastic"))
    }
    assert shown == {
        name: (MATERIALS[name].ledge_mm, MATERIALS[name].bridge_mm, MATERIALS[name].bore_mm) for name in shown
    }
    assert len(shown) == 4


def test_a_job_takes_the_limits_and_the_layer_height_of_its_alloy_unless_it_states_its_own():
    table = {"inputs": ["a.stl"], "material": "ti64", "supports": {"bore_mm": 5}}
    job = make_job(table, name="a", folder=None, source="test")
    assert (job.material.name, job.supports.layer_mm) == ("Ti6Al4V", 0.03)
    assert (job.supports.ledge_mm, job.supports.bore_mm) == (1.0, 5.0)


def test_the_command_lists_and_shows_materials(tmp_path):
    run = CliRunner().invoke
    listing = run(app, [], env={"COLUMNS": "200"})
    assert listing.exit_code == 0
    assert "metal (default)" in listing.output
    records = json.loads(run(app, ["list", "--json"]).output)
    assert {record["name"] for record in records} >= ALLOYS | PLASTICS
    assert json.loads(run(app, ["show", "Inconel 718", "--json"]).output)["name"] == "IN718"
    copy = tmp_path / "copy.toml"
    copy.write_text(run(app, ["show", "1.2709"]).output, encoding="utf-8")
    shown, original = find_material(str(copy)), find_material("MS1")
    assert (shown.density_g_cm3, shown.support_defaults) == (
        original.density_g_cm3,
        original.support_defaults,
    )


def test_the_option_names_the_material_of_a_run(tmp_path):
    from tests.shared.builds import box_mesh

    from amprep.cli.app import app as every
    from amprep.stl import write_stl

    write_stl(box_mesh((0, 0, 0), (10, 10, 10)), tmp_path / "cube.stl")
    own = tmp_path / "own.toml"
    own.write_text('based_on = "316L"\ndensity_g_cm3 = 8', encoding="utf-8")
    sets = ["--dry-run", "--json", "-q", "--set", "supports.enabled=false", "--set", "packing.lift_mm=0"]
    for material, mass in (("AlSi10Mg", 2.67), (str(own), 8.0)):
        done = CliRunner().invoke(every, ["run", str(tmp_path / "cube.stl"), "--material", material, *sets])
        assert done.exit_code == 0, done.output
        (build,) = json.loads(done.stdout)["builds"]
        assert build["printing"]["parts_g"] == pytest.approx(mass)
