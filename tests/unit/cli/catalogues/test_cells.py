"""The commands ``amprep cells list`` and ``amprep cells check``."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from amprep.cli.catalogues.cells import app

TOML = """
name = "tripod"
summary = "A pin on three legs."
author = "A. N. Engineer"
licence = "CC0-1.0"
points = [[0.5, 0.5, 0], [0.5, 0.5, 1]]
struts = [[0, 1, 0.4]]
"""


def test_the_commands_list_and_check(tmp_path):
    run = CliRunner().invoke
    rows = {row["name"]: row for row in json.loads(run(app, ["list", "--json"]).output)}
    assert rows["bcc"]["kinds"] == ["graph"]
    assert rows["x-wall"]["kinds"] == ["code"]
    assert rows["hatch"]["params"]["wall_mm"] is None  # as thick as the limits ask for
    assert "strut" in run(app, ["list"]).output

    path, picture = tmp_path / "tripod.toml", tmp_path / "tripod.png"
    path.write_text(TOML)
    done = run(app, ["check", str(path), "--picture", str(picture), "--json"])
    found = json.loads(done.output)
    assert (done.exit_code, found["violations"], found["kinds"]) == (0, [], ["graph"])
    assert (found["name"], found["author"], found["licence"]) == ("tripod", "A. N. Engineer", "CC0-1.0")
    assert found["measures"]["density"] == pytest.approx(np.pi * 0.16 / 4, rel=1e-3)
    assert picture.read_bytes().startswith(b"\x89PNG")

    flat = run(app, ["check", str(path), "--angle", "60"])
    assert flat.exit_code == 1
    assert "steep enough" in flat.output
    thick = json.loads(run(app, ["check", "strut", "--set", "diameter_mm=1", "--json"]).output)
    assert thick["measures"]["feature"] == pytest.approx(1.0, abs=0.1)
