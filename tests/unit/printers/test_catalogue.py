"""Printers are found by name among the built-in profiles and those of the project and the user."""

import json

import pytest
from tests.shared.profiles import Places, assert_refused
from typer.testing import CliRunner

from amprep.cli.catalogues.printers import app
from amprep.errors import JobError
from amprep.job import find_printer, list_printers
from amprep.printers.catalogue import DEFAULT_PRINTER
from amprep.profiles import user_folder

PROFILE = 'name = "My Printer"\nsize_mm = [10, 20, 30]\n'


@pytest.fixture
def places(tmp_path):
    return Places("printer", tmp_path)


@pytest.mark.parametrize(
    ("name", "shape", "size"),
    [
        ("EOS M290", "box", [250, 250, 325]),
        ("SLM 280 2.0", "box", [280, 280, 365]),
        ("TruPrint 1000", "cylinder", [100, 100, 100]),
        ("Renishaw AM 400", "box", [250, 250, 300]),
        ("Prusa MK4", "box", [250, 210, 220]),
        ("HP MJF 4200", "box", [380, 284, 380]),
    ],
)
def test_well_known_printers_have_the_sizes_of_their_data_sheets(name, shape, size):
    printer = find_printer(name, env={})
    assert (printer.name, printer.space.shape, printer.space.size.tolist()) == (name, shape, size)


def test_every_built_in_profile_states_its_source_and_can_be_found_by_its_name(places):
    printers, warnings = list_printers(*places)
    assert warnings == []
    assert len(printers) >= 20
    assert DEFAULT_PRINTER in {printer.name for printer in printers}
    for printer in printers:
        assert printer.source, printer.name
        assert find_printer(printer.name, *places) is printer


@pytest.mark.parametrize("name", ["eos-m290", "EOSM290", "eos m 290", "Eos_M290"])
def test_case_spaces_and_dashes_do_not_matter(name):
    assert find_printer(name, env={}).name == "EOS M290"


def test_own_printers_come_from_the_project_and_from_the_users_folder(places):
    folder, env = places
    (folder / "printers" / "mine.toml").write_text(PROFILE)
    user = user_folder(env, "printers")
    (user / "lab.toml").write_text('size_mm = [50, 60]\nshape = "cylinder"\ntechnology = "filament"')
    (user / "mine.toml").write_text(PROFILE.replace("10", "99"))
    assert find_printer("my printer", folder, env).space.size.tolist() == [10, 20, 30]
    assert find_printer("lab", folder, env).space.size.tolist() == [50, 50, 60]
    assert find_printer("mine", None, env).space.size.tolist() == [99, 20, 30]
    assert {printer.origin for printer in list_printers(folder, env)[0]} == {"project", "user", "built-in"}


def test_an_own_printer_hides_a_built_in_one_of_the_same_name(places):
    folder, env = places
    (folder / "printers" / "big.toml").write_text('name = "eos m290"\nsize_mm = [1, 1, 1]')
    assert find_printer("EOS M290", folder, env).space.size.tolist() == [1, 1, 1]


def test_a_profile_is_found_by_path_and_zones_are_kept(places):
    folder, env = places
    (folder / "p.toml").write_text(PROFILE + "zones = [[0, 0, 0, 5, 5, 5]]")
    printer = find_printer("p.toml", folder, env)
    assert (printer.name, printer.origin) == ("My Printer", "job")
    assert (printer.space.zone_lo.tolist(), printer.space.zone_hi.tolist()) == ([[0, 0, 0]], [[5, 5, 5]])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"expected size_mm = \[x, y, z\], found none"),
        ("size_mm = [1, 2]", "size_mm of a box must be x, y and z"),
        ('size_mm = [1, 1, 2]\nshape = "cylinder"', "size_mm of a cylinder must be diameter and height"),
        ("size_mm = [1, 2, 0]", "size_mm must be above 0"),
        ("size_mm = [1, 2, 1e9]", "size_mm must be at most 10000"),
        ("size_mm = [1, 2, nan]", "size_mm: expected a list of a number"),
        ("size = [1, 2, 3]\nsize_mm = [1, 2, 3]", r"unknown key 'size' \(did you mean 'size_mm'\?\)"),
        (PROFILE + 'technology = "metal"', "technology: expected one of 'metal-powder-bed'"),
        (PROFILE + "zones = [[5, 0, 0, 1, 1, 1]]", "zones must be x0, y0, z0, x1, y1, z1"),
        (PROFILE + "recoater_deg = 361", "recoater_deg must be .*, got 361"),
        ("size_mm = [", "not a TOML file"),
    ],
)
def test_an_invalid_profile_is_refused_by_name_and_gives_a_warning_in_the_list(places, text, message):
    assert_refused(places, find_printer, list_printers, text, message)
    assert find_printer("prusa mk4", *places).name == "Prusa MK4"


@pytest.mark.parametrize(
    ("keys", "directions"),
    [
        ("", (0, 90)),
        ("recoater_deg = 90\ngas_flow_deg = 180", (90, 180)),
        ("recoater_deg = 270", (270, 90)),
        ('technology = "polymer-powder-bed"', (0, None)),
        ('technology = "filament"', (None, None)),
    ],
)
def test_recoater_and_gas_flow_have_the_usual_directions_unless_the_profile_states_them(
    places, keys, directions
):
    folder, env = places
    (folder / "printers" / "mine.toml").write_text(PROFILE + keys)
    printer = find_printer("mine", folder, env)
    assert (printer.recoater_deg, printer.gas_flow_deg) == directions
    assert printer.packing_defaults["blade_angle_deg"] == (
        5.0 if printer.technology == "metal-powder-bed" else 0.0
    )


def test_an_unknown_printer_is_refused_with_the_nearest(places):
    with pytest.raises(JobError, match=r"no printer is called 'Prusa MK5' \(did you mean 'Prusa MK4'\?\)"):
        find_printer("Prusa MK5", *places)
    with pytest.raises(JobError, match="'amprep printers list' lists them"):
        find_printer("xyzzy", *places)
    with pytest.raises(JobError, match="expected a printer file, found nothing"):
        find_printer("nowhere.toml", *places)


def test_the_command_lists_and_shows_printers(tmp_path):
    run = CliRunner().invoke
    listing = run(app, [])
    assert listing.exit_code == 0
    assert "EOS M290 (default)" in listing.output
    records = json.loads(run(app, ["list", "--json"]).output)
    cylinder = next(record for record in records if record["name"] == "TruPrint 1000")
    assert (cylinder["shape"], cylinder["size_mm"]) == ("cylinder", [100, 100])
    copy = tmp_path / "copy.toml"
    copy.write_text(run(app, ["show", "truprint-1000"]).output)
    assert find_printer(str(copy)).space.size.tolist() == [100, 100, 100], "what is shown is a profile itself"
