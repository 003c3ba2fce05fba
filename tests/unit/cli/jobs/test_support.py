"""`amprep support --explain` prints its table, which is its result, whatever else is quiet."""

import pytest
import trimesh
from typer.testing import CliRunner

from amprep.cli.app import app


@pytest.mark.parametrize("quiet", [(), ("-q",)])
def test_the_table_of_regions_is_printed_also_if_progress_is_not(tmp_path, quiet):
    path = tmp_path / "box.stl"
    trimesh.creation.box((10, 10, 10)).export(path)
    result = CliRunner().invoke(app, ["support", str(path), "--explain", "box", *quiet])
    assert result.exit_code == 0, result.output
    assert "overhang 1" in result.stdout
    assert "not self-supporting" in result.stdout
