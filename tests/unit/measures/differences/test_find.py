"""Two builds differ where something was changed, and nowhere else; the dialect of their files does not matter."""

import json
from dataclasses import replace

import pytest
from tests.shared.builds import QUARTER_TURN, box_mesh
from typer.testing import CliRunner

from amprep.cli.app import app
from amprep.measures.differences.find import find_differences
from amprep.measures.differences.records import BuildDifferences, PartDifference
from amprep.model.supports.rules import SupportRules
from amprep.threemf import read_build, write_build


def with_part(build, index, **changes):
    parts = list(build.parts)
    parts[index] = replace(parts[index], **changes)
    return replace(build, parts=tuple(parts))


def test_a_build_equals_itself_and_its_files_in_every_dialect(make_build, tmp_path):
    build = make_build()
    assert find_differences(build, build) == BuildDifferences()
    for target in ("generic", "cura", "prusaslicer"):
        write_build(make_build(target), tmp_path / f"{target}.3mf")
        found = find_differences(build, read_build(tmp_path / f"{target}.3mf"))
        assert [each.name for each in found.settings] == (["target"] if target != "generic" else [])
        assert replace(found, settings=()).none


@pytest.mark.parametrize("offset", [0.01, 5.0])
def test_a_moved_part_is_named_with_its_distance(make_build, offset):
    build = make_build()
    matrix = build.parts[1].matrix.copy()
    matrix[0, 3] += offset
    (found,) = find_differences(build, with_part(build, 1, matrix=matrix)).parts
    assert (found.label, found.change, found.turned_deg) == ("bar", "moved", 0.0)
    assert found.moved_mm == pytest.approx(offset)


def test_a_turned_part_is_named_with_its_angle(make_build):
    build = make_build()
    matrix = build.parts[0].matrix.copy()
    matrix[:3, :3] = QUARTER_TURN
    (found,) = find_differences(build, with_part(build, 0, matrix=matrix)).parts
    assert found.change == "turned"
    assert found.turned_deg == pytest.approx(90.0)
    assert found.moved_mm == pytest.approx(40.0)  # the corner (20, 20) goes to (-20, 20)


def test_parts_that_come_go_and_change_are_named(make_build):
    build = make_build()
    fewer = replace(build, parts=build.parts[:2], unsupported=())
    assert find_differences(build, fewer).parts == (PartDifference("plate & <tray>-2", "removed"),)
    assert find_differences(fewer, build).parts == (PartDifference("plate & <tray>-2", "added"),)
    other = replace(build.parts[1].part, mesh=box_mesh((0.1, 0.2, 0.3), (7, 8, 9.5)))
    assert find_differences(build, with_part(build, 1, part=other)).parts == (
        PartDifference("bar", "other geometry"),
    )


def test_supports_listed_overhangs_and_settings_are_compared(make_build):
    build = make_build()
    longer = replace(build.supports[1], mesh=box_mesh((76, 62, 0), (2, 2, 4)))
    rules = SupportRules(**{**vars(build.settings.rules), "ledge_mm": 0.7})
    changed = replace(
        build,
        supports=(build.supports[0], longer),
        unsupported=(),
        settings=replace(build.settings, clearance=1.5, rules=rules),
    )
    found = find_differences(build, changed)
    (support,) = found.supports
    assert support.parts == ("bar",)
    assert support.after_mm3 == pytest.approx(16.0)
    assert [(each.part, each.before, each.after) for each in found.listed] == [("plate & <tray>-2", 1, 0)]
    assert {each.name: each.after for each in found.settings} == {"clearance": 1.5, "rules.ledge_mm": 0.7}


def test_the_command_prints_each_difference_and_its_exit_code_tells_them(make_build, tmp_path):
    build = make_build()
    write_build(build, tmp_path / "a.3mf")
    write_build(replace(build, settings=replace(build.settings, clearance=2.0)), tmp_path / "b.3mf")
    same = CliRunner().invoke(app, ["diff", str(tmp_path / "a.3mf"), str(tmp_path / "a.3mf")])
    assert (same.exit_code, same.stdout.strip()) == (0, "the builds are equal")
    other = CliRunner().invoke(app, ["diff", str(tmp_path / "a.3mf"), str(tmp_path / "b.3mf")])
    assert (other.exit_code, other.stdout.strip()) == (1, "setting clearance: 0.5 before, 2.0 after")
    listed = CliRunner().invoke(app, ["diff", str(tmp_path / "a.3mf"), str(tmp_path / "b.3mf"), "--json"])
    assert json.loads(listed.stdout)["settings"] == [{"name": "clearance", "before": 0.5, "after": 2.0}]
