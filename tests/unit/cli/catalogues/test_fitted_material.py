"""`amprep printers fit` writes a profile that jobs can name."""

import json
from pathlib import Path

import numpy as np
from typer.testing import CliRunner

from amprep.cli.app import app
from amprep.materials.catalogue import find_material


def log(folder: Path) -> Path:
    area = 1000.0 + 500.0 * np.sin(np.arange(90) / 7.0)
    rows = (f"{number},{12.0 + each / 80.0:.4f},{each:.3f}" for number, each in enumerate(area, 1))
    path = folder / "our machine.csv"
    path.write_text("\n".join(["layer,seconds,area", *rows]))
    return path


def test_the_profile_has_the_fitted_speed_and_the_other_keys_of_its_model(tmp_path: Path) -> None:
    target = tmp_path / "ours.toml"
    call = ["printers", "fit", str(log(tmp_path)), "--like", "AlSi10Mg", "-o", str(target), "--json"]
    found = CliRunner().invoke(app, call)
    assert found.exit_code == 0, found.output
    values = json.loads(found.stdout)
    assert (round(values["recoating_s"], 2), round(values["scan_mm2_s"], 1)) == (12.0, 80.0)
    profile, model = find_material(str(target)), find_material("AlSi10Mg")
    assert (profile.name, profile.recoating_s) == ("our machine", 12.0)
    assert (profile.ledge_mm, profile.density_g_cm3) == (model.ledge_mm, model.density_g_cm3)
    assert "every third" in profile.source
    again = CliRunner().invoke(app, call[:-1])
    assert "use --force" in str(again.exception)


def test_without_a_file_the_profile_is_printed(tmp_path: Path) -> None:
    found = CliRunner().invoke(app, ["printers", "fit", str(log(tmp_path)), "--name", "x"])
    assert found.exit_code == 0, found.output
    assert 'name = "x"' in found.stdout
    assert "scan_mm2_s = 80.0" in found.stdout
