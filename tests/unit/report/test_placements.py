"""The map of placements says where each copy is, and whose file and geometry it has."""

import csv

import numpy as np
from tests.shared.builds import box_mesh, placement

from amprep.model import Build, BuildSettings, BuildVolume, Part, PlacedPart
from amprep.report.placements import COLUMNS, write_placements
from amprep.report.record import BuildRecord, RunRecord

TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])


def test_each_copy_has_a_line_and_copies_are_numbered_over_all_builds(tmp_path):
    part = Part("=bar", box_mesh((1, 2, 3), (4, 6, 8)), 192.0, source="/x/bar.stl", source_sha256="ab" * 32)
    placed = [
        PlacedPart("bar", part, placement(turn, *at))
        for turn, at in ((np.eye(3), (10, 0, 0)), (TURN, (50, 5, 3)))
    ]
    space = BuildVolume((100, 100, 100))
    builds = tuple(
        BuildRecord(
            Build(BuildSettings(f"job.build-{number}", space), (each,), ()), file=f"job.build-{number}.3mf"
        )
        for number, each in enumerate(placed, start=1)
    )
    path = tmp_path / "map.csv"
    write_placements(RunRecord("job", "0.1.0", 0, "MK4", "generic", builds), path)
    with path.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert tuple(rows[0]) == COLUMNS
    assert [(row["build"], row["copy"], row["copies"]) for row in rows] == [
        ("job.build-1", "1", "2"), ("job.build-2", "2", "2"),
    ]  # fmt: skip
    assert rows[0]["part"] == "'=bar"
    assert (rows[0]["source"], rows[0]["source_sha256"]) == ("bar.stl", "ab" * 32)
    assert rows[0]["mesh_sha256"] == part.mesh.digest
    for row, each in zip(rows, placed, strict=True):
        low, high = each.mesh.bounds
        assert [float(row[name]) for name in ("x_mm", "y_mm", "z_mm")] == low.tolist()
        assert [float(row[f"size_{axis}_mm"]) for axis in "xyz"] == (high - low).tolist()
        turn = np.array([[float(row[f"r{i}{j}"]) for j in (1, 2, 3)] for i in (1, 2, 3)])
        moved = part.mesh.vertices @ turn.T + [float(row[f"t{axis}_mm"]) for axis in (1, 2, 3)]
        np.testing.assert_allclose(moved, each.mesh.vertices)
