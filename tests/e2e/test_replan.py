"""`amprep replan`: an edited build is planned again from the command line."""

from tests.e2e.test_support import plate_3mf
from tests.shared.edited import edit, shift

import amprep as api


def test_a_moved_part_takes_its_supports_along_and_a_collision_is_refused(amprep, tmp_path):
    settings = {"packing.strategy": "extreme-points", "packing.lift_mm": 6, "cells.strategy": "prism"}
    loaded = api.load(plate_3mf(tmp_path / "plate.3mf", (0, 0, 0), (20, 0, 0)), settings=settings)
    (packed,) = api.pack(loaded).builds
    build, out = api.write(api.emit_cells(api.plan_supports(packed)), tmp_path / "x.3mf"), tmp_path / "out"
    moved = amprep("replan", edit(build, tmp_path / "a.3mf", {0: shift(y=40.0)}), "-o", out, "--json")
    assert moved.code == 0
    assert [each["supports"] for each in moved.json["parts"]] == ["taken along", "kept"]
    assert sorted(path.name for path in out.iterdir()) == ["a.replanned.3mf", "a.replanned.report.json"]
    refused = amprep("replan", edit(build, tmp_path / "b.3mf", {0: shift(x=9.0)}), "-o", out)
    assert refused.code == 2
    assert "plate-2" in refused.err
    assert len(list(out.iterdir())) == 2
