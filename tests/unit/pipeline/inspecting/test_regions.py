"""`amprep support --explain` names every overhang region with its verdict and the rule that takes it."""

import json

import pytest
from manifold3d import Manifold
from tests.shared.solids import mesh_of
from typer.testing import CliRunner

import amprep
from amprep.cli.app import app
from amprep.errors import JobError
from amprep.stl import write_stl

JOB = """
inputs = ["hook.stl", "other.stl"]
material = "metal"
[[rule]]
kind = "ledge"
size = [9, 20]
connector = "teeth"
pitch_mm = 1.5
[[rule]]
part = "hook"
kind = "ledge"
support = false
"""


@pytest.fixture
def job(tmp_path):
    """A post with three arms on one side: 12, 6 and 0.6 mm long, at different heights."""
    hook = Manifold.cube([6, 10, 30]).translate([30, 30, 0])
    for length, height in ((12.0, 10), (6.0, 18), (0.6, 25)):
        hook += Manifold.cube([6 + length, 10, 2]).translate([30, 30, height])
    write_stl(mesh_of(hook), tmp_path / "hook.stl")
    write_stl(mesh_of(hook.translate([0, 40, -2])), tmp_path / "other.stl")
    path = tmp_path / "job.toml"
    path.write_text(JOB)
    return path


def test_each_region_has_its_verdict_and_the_rule_that_takes_it(job):
    record = amprep.explain_regions(job, part="ho?k")
    found = {round(each.height_mm): each for each in record.regions}
    assert set(found) == {10, 18, 25}
    assert {each.part for each in record.regions} == {"hook"}
    assert [found[height].rule for height in (10, 18, 25)] == ["[[rule]] 1", "[[rule]] 2", "self-supporting"]
    assert [found[height].size_mm for height in (10, 18, 25)] == pytest.approx([12.0, 6.0, 0.6], abs=0.1)
    assert found[10].verdict == "ledge 12.0 mm over 1.0: needs support"
    assert found[10].settings == "pitch_mm = 1.5, connector = teeth"
    assert found[18].settings == "support = false"
    assert found[25].settings == ""


def test_what_no_entry_takes_gets_the_settings_of_the_job_and_low_parts_are_raised(job):
    record = amprep.explain_regions(job, part="other", settings={"packing.lift_mm": 1.0})
    assert {round(each.height_mm): each.rule for each in record.regions}[19] == "default"
    assert min(each.height_mm for each in record.regions) == pytest.approx(1.0), (
        "its bottom is raised to the lift"
    )


def test_a_name_that_no_part_has_is_an_error_with_the_nearest(job):
    with pytest.raises(JobError, match=r"no part is called 'hok' \(did you mean 'hook'\?\)"):
        amprep.explain_regions(job, part="hok")


def test_the_command_prints_a_table_or_json_and_writes_nothing(job):
    before = sorted(job.parent.iterdir())
    shown = CliRunner().invoke(app, ["support", str(job), "--explain", "hook"])
    assert shown.exit_code == 0
    assert "[[rule]] 2" in shown.output
    done = CliRunner().invoke(app, ["support", str(job), "--explain", "*", "--json", "-q"])
    assert done.exit_code == 0
    regions = json.loads(done.stdout)["regions"]
    assert {each["part"] for each in regions} == {"hook", "other"}
    assert sorted(job.parent.iterdir()) == before


def test_the_table_begins_with_what_needs_support_and_has_one_row_for_alike_regions(job):
    hook = Manifold.cube([6, 10, 30]).translate([30, 30, 0]) + Manifold.cube([12, 10, 2]).translate(
        [30, 30, 18]
    )
    for y in (31, 34, 37):
        hook += Manifold.cube([6.4, 1, 2]).translate([30, y, 5])
    write_stl(mesh_of(hook), job.parent / "hook.stl")
    shown = CliRunner().invoke(app, ["support", str(job), "--explain", "hook", "-q"]).output
    rows = [line for line in shown.splitlines() if "overhang" in line][1:]
    assert ["ledge 6.0 mm" in row for row in rows] == [True, False]
    assert "39, 35, 18.00" in rows[0]
    assert "36, 31, 5.00" in rows[1] or "36, 32, 5.00" in rows[1]
    assert "0.4 mm (3" in shown
    assert "self-supporting: " in shown


def test_center_puts_parts_on_the_plate_where_their_bottom_is_no_overhang(job):
    """As `amprep support --center` does: the lowest part stands on the plate."""
    record = amprep.explain_regions(job, part="other", center=True)
    assert {round(each.height_mm) for each in record.regions} == {10, 18, 25}
