"""A run turns parts away from the recoater blade where it may, and lists the edges that meet it."""

import numpy as np
import pytest
from tests.shared.builds import box_mesh

import amprep
from amprep.stl import write_stl

PLATE = box_mesh((0, 0, 0), (30, 20, 6))


@pytest.fixture
def run(tmp_path):
    write_stl(PLATE, tmp_path / "plate.stl")

    def call(rotations, packer="extreme-points", printer="EOS M290", **packing):
        settings = {f"packing.{key}": value for key, value in {"strategy": packer, **packing}.items()}
        part = {"file": str(tmp_path / "plate.stl"), "rotations": rotations, "quantity": 2}
        return amprep.run(
            tmp_path / "plate.stl",
            output=tmp_path / "out",
            printer=printer,
            settings={**settings, "supports.enabled": False, "part": [part]},
            dry_run=True,
        )

    return call


def turns(record):
    matrices = [placed.matrix for build in record.builds for placed in build.build.parts]
    return [float(np.degrees(np.arctan2(matrix[1, 0], matrix[0, 0]))) for matrix in matrices]


@pytest.mark.parametrize("packer", ["extreme-points", "plates"])
@pytest.mark.parametrize("rotations", ["about-z", "z15", "free"])
def test_parts_that_may_turn_are_turned_and_the_report_says_so(run, rotations, packer):
    record = run(rotations, packer)
    assert all(min(turn % 90, -turn % 90) >= 5 for turn in turns(record)), turns(record)
    assert record.builds[0].blade_edges == ()
    assert any("recoater blade" in note for note in record.notes)
    assert record.faults == 0


def test_a_part_that_may_not_turn_is_listed_as_worth_a_check(run):
    record = run("none")
    first, second = record.builds[0].blade_edges
    assert (first.part, second.part) == (0, 1)
    assert (first.length_mm, first.low_mm, first.high_mm) == pytest.approx((20, 3, 9))
    assert record.faults == 0
    assert not any("recoater blade" in note for note in record.notes)
    found = [each for each in amprep_findings(record) if each.kind == "blade edge"]
    assert [each.triage for each in found] == ["worth a check"] * 2
    assert "20.0 mm is 0.0 degrees off the recoater blade, in layers from 3.0 to 9.0 mm" in found[0].words


def amprep_findings(record):
    from amprep.report.triage.findings import findings_of

    return findings_of(record)


@pytest.mark.parametrize(
    ("printer", "keys"),
    [
        ("EOS M290", {"blade_angle_deg": 0.0}),
        ("EOS M290", {"blade_edge_mm": 31.0}),
        ("Prusa MK4", {}),
        ("EOS P 396", {}),
    ],
)
def test_without_a_metal_blade_or_with_the_setting_off_nothing_is_turned(run, printer, keys):
    record = run("z90", printer=printer, **keys)
    assert all(turn % 90 == pytest.approx(0, abs=1e-6) for turn in turns(record))
    assert record.builds[0].blade_edges == ()


@pytest.mark.parametrize(("width", "turned"), [(21.0, False), (31.0, True)])
def test_a_part_is_turned_only_if_it_fits_the_printer_then(run, width, turned):
    narrow = {"name": "narrow", "size_mm": [width, 80.0, 50.0]}
    record = run("about-z", printer=narrow, clearance_mm=0.4)
    assert record.faults == 0
    assert len(record.builds[0].blade_edges) == (0 if turned else 2)


def test_the_blade_follows_the_direction_of_the_printers_recoater(run):
    across = {"name": "across", "size_mm": [100.0, 100.0, 50.0], "recoater_deg": 90.0}
    (first, _) = run("none", printer=across).builds[0].blade_edges
    assert first.length_mm == pytest.approx(30)
