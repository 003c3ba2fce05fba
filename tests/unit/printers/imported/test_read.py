"""Printers come in from the profiles of PrusaSlicer, OrcaSlicer and Cura, with what they inherit."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from amprep.cli.catalogues.printers import app
from amprep.errors import AmprepError, InputError
from amprep.printers.catalogue import find_printer
from amprep.printers.imported import read
from amprep.printers.imported.read import read_printers

BUNDLE = """
[vendor]
name = Maker
[printer_model:M1]
name = Maker One
[printer_model:M2]
name = Maker Two
[printer:*common*]
bed_shape = 0x0,250x0,250x210,0x210
max_print_height = 200
[printer:*tall*]
max_print_height = 300
[printer:M1 0.4]
inherits = *common*
printer_model = M1
[printer:M1 0.6]
inherits = M1 0.4
[printer:M2 0.4]
# the later parent has precedence
inherits = *common*; *tall*
printer_model = M2
bed_shape = -100x-90,100x-90,100x90,-100x90
[printer:M2 0.8]
inherits = M2 0.4
max_print_height = 290
"""


def saved(folder, name, content):
    path = folder / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def beds(path):
    printers, warnings = read_printers(path)
    assert warnings == []
    return {each.name: (each.size_mm, each.origin_mm) for each in printers}


def test_variants_of_a_model_with_the_same_bed_are_one_printer(tmp_path):
    assert beds(saved(tmp_path, "maker.ini", BUNDLE)) == {
        "Maker One": ((250.0, 210.0, 200.0), (0.0, 0.0)),
        "M2 0.4": ((200.0, 180.0, 300.0), (-100.0, -90.0)),
        "M2 0.8": ((200.0, 180.0, 290.0), (-100.0, -90.0)),
    }


def test_a_configuration_is_one_printer(tmp_path):
    flat = "printer_settings_id = Mine\nbed_shape = 5x5,95x5,95x95,5x95\nmax_print_height = 80\nlayer_height = 0.2\n"
    assert beds(saved(tmp_path, "config.ini", flat)) == {"Mine": ((90.0, 90.0, 80.0), (5.0, 5.0))}


def test_orcaslicer_profiles_inherit_from_files_beside_them(tmp_path):
    common = {"type": "machine", "name": "common", "instantiation": "false", "printable_area": ["0x0"]}
    own = {"type": "machine", "name": "X", "inherits": "common", "printable_height": "250"}
    area = ["0x0", "256x0", "256x256", "0x256"]
    saved(tmp_path, "common.json", common)
    corner = ["0x0", "18x0", "18x28", "0x28"]
    saved(tmp_path, "X.json", {**own, "printable_area": area, "bed_exclude_area": corner})
    saved(tmp_path, "X child.json", {"type": "machine", "name": "Y", "inherits": "X"})
    assert beds(tmp_path) == dict.fromkeys(("X", "Y"), ((256.0, 256.0, 250.0), (0.0, 0.0)))
    (zone,) = read_printers(tmp_path / "X child.json")[0][0].zones
    assert zone == (0.0, 0.0, 0.0, 18.0, 28.0, 250.0)


def test_cura_definitions_inherit_and_their_disallowed_areas_count_from_the_middle_to_the_front(tmp_path):
    root = {"name": "root", "settings": {"machine": {"children": {"machine_height": {"default_value": 99}}}}}
    own = {"name": "Ultra", "inherits": "root", "metadata": {"visible": True}, "overrides": {}}
    own["overrides"] = {
        "machine_width": {"default_value": 1, "value": "200"},
        "machine_depth": {"default_value": 150, "value": "machine_width * 2"},
        "machine_disallowed_areas": {"default_value": [[[-100, 75], [-90, 75], [-90, 60], [-100, 60]]]},
        "machine_center_is_zero": {"default_value": True},
    }
    saved(tmp_path, "root.def.json", root)
    saved(tmp_path, "ultra.def.json", own)
    (printer,), _ = read_printers(tmp_path)
    assert (printer.size_mm, printer.origin_mm) == ((200.0, 150.0, 99.0), (0.0, 0.0))
    assert printer.zones == ((0.0, 0.0, 0.0, 10.0, 15.0, 99.0),)  # at the front, left


def test_round_and_elliptic_beds_of_cura(tmp_path):
    for width in (180, 120):
        sizes = {
            "machine_width": width,
            "machine_depth": 180,
            "machine_height": 300,
            "machine_shape": "elliptic",
        }
        overrides = {key: {"default_value": value} for key, value in sizes.items()}
        saved(tmp_path, f"d{width}.def.json", {"name": f"D{width}", "overrides": overrides})
    assert read_printers(tmp_path / "d180.def.json")[0][0].shape == "cylinder"
    ellipse = read_printers(tmp_path / "d120.def.json")[0][0]
    assert ellipse.size_mm == (120.0, 180.0, 300.0)
    assert len(ellipse.zones) > 20


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("a.ini", "layer_height = 1", "no printer"),
        ("a.ini", "[printer:A]\ninherits = B\n[printer:B]\ninherits = A", "inherits from itself"),
        ("a.ini", "[printer:A]\ninherits = Missing", "'Missing'"),
        ("a.ini", "bed_shape = what", "corners"),
        ("a.ini", "bed_shape = 0x0,9x0,9x9\nmax_print_height = high", "height"),
        ("a.json", [], "no printer"),
        ("a.json", "{", "not JSON"),
        ("a.json", {"type": "machine", "inherits": "b"}, "'b'"),
        ("a.json", {"type": "machine", "inherits": "a"}, "inherits from itself"),
        ("a.def.json", [], "not a definition"),
        ("a.def.json", {"inherits": "a"}, "inherits from itself"),
        ("a.def.json", {"overrides": {"machine_width": {"default_value": "wide"}}}, "width"),
        (
            "a.def.json",
            {"overrides": {"machine_disallowed_areas": {"default_value": [[1, 2, 3]]}}},
            "corners",
        ),
        ("a.txt", "", "expected a profile"),
    ],
)
def test_what_is_no_printer_is_refused_in_a_sentence(tmp_path, name, content, reason):
    with pytest.raises(InputError, match=reason):
        read_printers(saved(tmp_path, name, content))
    with pytest.raises(InputError):
        read_printers(tmp_path)


def test_the_command_writes_profiles_that_jobs_can_name(tmp_path, monkeypatch):
    source = saved(tmp_path, "maker.ini", BUNDLE)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "settings"))
    run = CliRunner().invoke(app, ["import", str(source), "--json"])
    assert len(json.loads(run.stdout)["files"]) == 3
    printer = find_printer("m2 0.8", env={"XDG_CONFIG_HOME": str(tmp_path / "settings")})
    assert (printer.space.size.tolist(), printer.plate_origin) == ([200.0, 180.0, 290.0], (-100.0, -90.0))
    again = CliRunner().invoke(app, ["import", str(source), "--only", "maker one"])
    assert isinstance(again.exception, AmprepError)
    assert "--force" in str(again.exception)
    forced = CliRunner().invoke(app, ["import", str(source), "--only", "maker one", "--force"])
    assert forced.stdout.splitlines()[0] == "Maker One: 250 x 210 x 200 mm"
    wrong = CliRunner().invoke(app, ["import", str(source), "--only", "makr one"])
    assert "did you mean 'Maker One'" in str(wrong.exception)


def test_a_damaged_file_in_a_folder_is_a_warning(tmp_path):
    saved(tmp_path, "config.ini", "bed_shape = 0x0,90x0,90x90,0x90\nmax_print_height = 80\n")
    for name in ("a.json", "a.def.json"):
        saved(tmp_path, name, "no JSON")
    printers, warnings = read_printers(tmp_path)
    assert [each.name for each in printers] == ["config"]
    assert len(warnings) == 2


def test_overrides_of_another_type_are_none(tmp_path):
    own = {"name": "A", "overrides": [1], "metadata": {"visible": True}}
    assert beds(saved(tmp_path, "a.def.json", own)) == {"A": ((100.0, 100.0, 100.0), (0.0, 0.0))}


def test_each_section_is_read_once_however_often_others_inherit_from_it(tmp_path):
    levels = [f"[printer:*{k}*]\ninherits = *{k + 1}*; *{k + 1}*; *{k + 1}*\n" for k in range(25)]
    text = "".join([*levels, "[printer:*25*]\nmax_print_height = 70\n[printer:A]\ninherits = *0*\n"])
    assert beds(saved(tmp_path, "maker.ini", text)) == {"A": ((200.0, 200.0, 70.0), (0.0, 0.0))}


def test_printers_with_names_that_files_cannot_tell_apart_get_files_of_their_own(tmp_path):
    names = ("Maker One", "Maker/One", "maker one")
    area = {"type": "machine", "printable_area": ["0x0", "90x0", "90x90", "0x90"]}
    for number, name in enumerate(names):
        own = {**area, "name": name, "printable_height": str(100 + number)}
        saved(tmp_path / "source", f"{number}.json", own)
    target = tmp_path / "out"
    run = CliRunner().invoke(app, ["import", str(tmp_path / "source"), "-o", str(target)])
    assert run.exit_code == 0
    assert sorted(path.name for path in target.iterdir()) == [
        "Maker-One-2.toml",
        "Maker-One.toml",
        "maker-one-3.toml",
    ]


def test_imported_printers_appear_all_or_none(tmp_path, monkeypatch):
    monkeypatch.setattr(Path, "write_text", failing_at("M2-0.8.toml", Path.write_text))
    source = tmp_path / "maker.ini"
    source.write_bytes(BUNDLE.encode())
    run = CliRunner().invoke(app, ["import", str(source), "-o", str(tmp_path / "out")])
    assert isinstance(run.exception, AmprepError)
    assert "No space left" in str(run.exception)
    assert not (tmp_path / "out").exists()


def failing_at(name, write):
    """A function that writes files but for one of a name, for which there is no space."""

    def fail(path, *arguments, **named):
        if path.name == name:
            raise OSError(28, "No space left on device")
        return write(path, *arguments, **named)

    return fail


def test_folders_of_too_many_files_and_profiles_too_large_are_refused(tmp_path, monkeypatch):
    saved(tmp_path, "maker.ini", BUNDLE)
    monkeypatch.setattr(read, "MOST_FILES", 0)
    with pytest.raises(InputError, match="more than 0 files"):
        read_printers(tmp_path)
    monkeypatch.setattr(read, "LARGEST_JSON", 10)
    with pytest.raises(InputError, match=r"expected a profile, but the file is larger than"):
        read_printers(saved(tmp_path, "machine.json", {"type": "machine"}))


def test_a_value_of_an_inherited_cura_definition_hides_a_default_value(tmp_path):
    sizes = {"machine_width": {"value": 120}, "machine_depth": {"default_value": 90}}
    saved(tmp_path, "parent.def.json", {"name": "Parent", "overrides": sizes})
    own = {"machine_width": {"default_value": 300}, "machine_depth": {"default_value": 300}}
    path = saved(tmp_path, "own.def.json", {"name": "Own", "inherits": "parent", "overrides": own})
    ((printer,), _) = read_printers(path)
    assert list(printer.size_mm) == [120, 300, 100]


def test_a_missing_file_is_told_apart_from_one_of_another_format(tmp_path):
    with pytest.raises(InputError, match="no such file or folder"):
        read_printers(tmp_path / "FILE")


def test_the_bed_that_prusaslicer_takes_where_a_printer_states_none_is_told(tmp_path):
    path = saved(tmp_path, "bundle.ini", "[printer:A]\nmax_print_height = 250\n")
    ((printer,), _) = read_printers(path)
    assert list(printer.size_mm) == [200, 200, 250]
    assert "states no bed" in printer.source
