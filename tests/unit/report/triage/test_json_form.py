"""The JSON report has every region with its class and sizes, and lists what must be fixed first."""

import pytest
from tests.shared.findings import overhang, run_of

from amprep.report.json_report import to_json


def test_every_region_has_class_kind_size_limit_and_verdict():
    record = overhang("overhang 1", "supported", size=6.0, limit=1.0, measure=12.0)
    (found,) = to_json(run_of([record]))["builds"][0]["supports"]["overhangs"]
    expected = {
        "name": "overhang 1",
        "triage": "supported",
        "kind": "ledge",
        "verdict": record.verdict,
        "size_mm": 6.0,
        "limit_mm": 1.0,
        "area_mm2": 12.0,
        "length_mm": None,
        "height_mm": None,
        "lowest_mm": 30.0,
        "starts_in_air": False,
    }
    assert expected.items() <= found.items()


@pytest.mark.parametrize(("kind", "key"), [("edge", "length_mm"), ("tip", "height_mm"), ("bore", "area_mm2")])
def test_each_kind_has_one_measure(kind, key):
    (found,) = to_json(run_of([overhang("a", kind=kind)]))["builds"][0]["supports"]["overhangs"]
    measures = ("area_mm2", "length_mm", "height_mm")
    assert [name for name in measures if found[name] is not None] == [key]


def test_all_regions_are_listed_and_the_urgent_ones_are_findings():
    triages = ["self-supporting", "worth a check", "supported", "must fix"] * 300
    report = to_json(run_of([overhang(f"{k}", triage) for k, triage in enumerate(triages)]))
    assert len(report["builds"][0]["supports"]["overhangs"]) == 1200
    assert report["triage"] == dict.fromkeys(
        ("must_fix", "worth_a_check", "supported", "self_supporting"), 300
    )
    assert [each["triage"] for each in report["findings"]] == ["must fix"] * 300 + ["worth a check"] * 300
