"""An edited build is planned again: what still holds is kept, the rest is planned, and all promises hold."""

import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from tests.shared.edited import edit, shift, turn
from tests.shared.solids import mesh_of
from tests.shared.supported import box

import amprep
from amprep.errors import InputError
from amprep.model import Unsupported
from amprep.model.supports import ENCLOSED, NO_FREE_VOXEL_BELOW
from amprep.pipeline.replanning.course import new_name
from amprep.report.replanning import ReplannedPart, ReplanRecord, summary
from amprep.stl import write_stl
from amprep.threemf import read_build

NAMES = ["tee", "tee-2", "tee-3", "bar"]


@pytest.fixture(scope="module", params=["prusaslicer", "cura"])
def for_slicer(request, made):
    """The same build for a slicer; PrusaSlicer counts from the middle of its plate here."""
    build = read_build(made / "job.build-1.3mf")
    settings = replace(build.settings, target=request.param)
    if request.param == "prusaslicer":
        settings = replace(settings, plate_origin=(-125.0, -125.0))
    return amprep.write(replace(build, settings=settings), made / request.param / "for-slicer.3mf")


@pytest.fixture
def replanned(plate, tmp_path):
    """Edit the build, plan it again, and return the record by labels, and the new build."""

    def make(moved=None, bare=False, place=None, deleted=(), copied=(), **options):
        file = edit(
            plate, (place or tmp_path) / "edited.3mf", moved, deleted=deleted, copied=copied, bare=bare
        )
        record = amprep.replan(file, output=tmp_path, **options)
        return record, read_build(tmp_path / record.file)

    return make


def supports_of(record):
    return {each.label: (each.change, each.supports) for each in record.parts}


def corner(build, label):
    return next(each.mesh.bounds[0] for each in build.parts if each.label == label)


def digests(build):
    return {body.name: body.mesh.digest for body in build.supports}


def test_a_build_that_nobody_changed_stays_as_it_is(plate, replanned):
    record, build = replanned()
    assert supports_of(record) == dict.fromkeys(NAMES[:3], ("none", "kept")) | {
        "bar": ("none", "none needed")
    }
    assert record.faults == 0
    assert [each.name for each in amprep.diff(plate, build).settings] == ["build_id"]
    assert not amprep.diff(plate, build).supports


def test_a_part_that_moved_along_the_plate_takes_its_supports_along(plate, replanned, tmp_path):
    record, build = replanned({0: shift(y=120.0)})
    before = read_build(plate)
    assert supports_of(record)["tee"] == ("moved", "taken along")
    assert corner(build, "tee") == pytest.approx(corner(before, "tee") + (0.0, 120.0, 0.0), abs=1e-4)
    old, new = digests(before), digests(build)
    assert {name for name in old if old[name] != new[name]} == {"supports of tee"}
    moved = [each for each in build.supports if each.name == "supports of tee"]
    assert moved[0].mesh.signed_volume == pytest.approx(before.supports[0].mesh.signed_volume, rel=1e-4)
    assert amprep.verify(tmp_path / record.file).ok, "all supports, judged from the file alone"


def test_turned_and_raised_parts_are_planned_again_and_the_others_keep_their_supports(
    plate, replanned, tmp_path
):
    record, build = replanned({1: shift(y=60.0) @ turn(40.0, 40.0, 10.0), 2: shift(y=120.0, z=2.0)})
    found = supports_of(record)
    assert found == {
        "tee": ("none", "kept"),
        "tee-2": ("turned", "planned again"),
        "tee-3": ("moved", "planned again"),
        "bar": ("none", "none needed"),
    }
    assert record.parts[1].turned_deg == pytest.approx(40.0)
    assert len(build.supports) == 3
    assert digests(build)["supports of tee"] == digests(read_build(plate))["supports of tee"]
    assert amprep.verify(tmp_path / record.file).ok


def test_files_for_slicers_are_replanned_alike_with_and_without_their_record(for_slicer, tmp_path):
    moved = {0: shift(y=120.0), 1: shift(y=60.0) @ turn(40.0, 40.0, 10.0)}
    if "prusaslicer" in str(for_slicer):
        moved[1] = shift(y=60.0) @ turn(40.0, 40.0 - 125.0, 10.0 - 125.0)
    for bare, folder in ((False, tmp_path), (True, for_slicer.parent)):
        file = edit(for_slicer, folder / "edited.3mf", moved, bare=bare)
        record = amprep.replan(file, output=tmp_path)
        found = supports_of(record)
        assert (found["tee"], found["tee-3"]) == (("moved", "taken along"), ("none", "kept"))
        assert found["tee-2"] == ("turned", "planned again")
        assert record.faults == 0
        assert amprep.verify(tmp_path / record.file).ok


def test_copies_and_deleted_parts_are_named(replanned, tmp_path):
    record, build = replanned(deleted=[0], copied=[(1, shift(y=100.0)), (3, shift(y=50.0))])
    found = supports_of(record)
    assert found["tee"] == ("copied", "taken along")
    assert found["bar-2"] == ("copied", "none needed")
    assert record.deleted == ("1 part",)
    assert sorted(body.name for body in build.supports) == [f"supports of {each}" for each in NAMES[:3]]
    assert amprep.verify(tmp_path / record.file).ok


def test_a_record_that_is_gone_is_found_by_the_report_beside_the_build(made, replanned, tmp_path):
    with pytest.raises(InputError, match=r"record of amprep is gone.*--report.*--job"):
        replanned({0: shift(y=120.0)}, bare=True)
    record, _ = replanned({0: shift(y=120.0)}, bare=True, report=made / "job.report.json")
    assert supports_of(record)["tee"] == ("moved", "taken along")
    assert "by job.report.json" in record.source
    assert amprep.verify(tmp_path / record.file).ok


def test_a_build_beside_the_file_is_found_by_the_identifier_in_its_names(made, replanned):
    record, _ = replanned({0: shift(y=120.0)}, bare=True, place=made)
    (made / "edited.3mf").unlink()
    assert supports_of(record)["tee"] == ("moved", "taken along")
    assert "identifier" in record.source


def test_parts_that_collide_leave_the_plate_or_are_too_near_are_refused_by_name(replanned, tmp_path):
    with pytest.raises(InputError, match=r"tee.* overlaps tee-2 by"):
        replanned({0: shift(x=10.0)})
    with pytest.raises(InputError, match=r"bar: it extends 5\d\d.* beyond the"):
        replanned({3: shift(x=700.0)})
    with pytest.raises(InputError, match=r"mm from tee-2, expected at least 4 mm"):
        replanned({0: shift(x=1.0)})
    assert [path.name for path in tmp_path.iterdir()] == ["edited.3mf"]


def test_a_scaled_part_is_refused_by_name(replanned):
    with pytest.raises(InputError, match=r"^tee\S* has another shape"):
        replanned({0: np.diag([1.0, 1.0, 1.2, 1.0])})


def test_the_same_file_gives_the_same_bytes(replanned, tmp_path):
    contents = []
    for _ in range(2):
        record, _ = replanned({1: shift(y=60.0) @ turn(40.0, 40.0, 10.0)})
        contents.append((tmp_path / record.file).read_bytes())
    assert contents[0] == contents[1]


def test_a_job_gives_parts_and_settings_when_nothing_else_is_left(made, plate, tmp_path):
    file = edit(plate, tmp_path / "edited.3mf", bare=True)
    record = amprep.replan(file, output=tmp_path, job=made / "job.toml", dry_run=True)
    assert sorted(supports_of(record)) == sorted(NAMES)
    assert {each.supports for each in record.parts} == {"planned again", "none needed"}
    assert record.violations == ()
    assert record.file == ""


def test_the_report_says_what_happened(replanned, tmp_path):
    record, _ = replanned({0: shift(y=120.0)})
    report = json.loads((tmp_path / record.report_file).read_text(encoding="utf-8"))
    assert report["parts"][0]["supports"] == "taken along"
    assert (report["file"], report["sha256"]) == (record.file, record.sha256)


def test_a_build_that_was_planned_again_and_then_changed_is_not_replaced(replanned, tmp_path):
    first, _ = replanned({0: shift(y=120.0)})
    again, _ = replanned({0: shift(y=110.0)})
    assert first.sha256 != again.sha256
    edit(tmp_path / again.file, tmp_path / "copy.3mf", {0: shift(y=5.0)}).replace(tmp_path / again.file)
    with pytest.raises(InputError, match=r"edited\.replanned\.3mf was changed since .* --force"):
        replanned()
    forced, _ = replanned({0: shift(y=110.0)}, force=True)
    assert forced.sha256 == again.sha256


def test_the_page_has_the_build_and_says_what_was_planned_again(replanned, tmp_path):
    record, _ = replanned({0: shift(y=120.0)}, page=True)
    page = (tmp_path / record.page_file).read_text(encoding="utf-8")
    assert "tee: moved by 120.00 mm; supports taken along" in page
    assert "overhang 1 of tee-2" in page
    assert "kept supports not judged again" in page


def test_the_closing_list_names_what_was_planned_again_and_each_part_without_support():
    again = ReplannedPart("tee", "turned", 3.0, 30.0, "planned again", "turned")
    kept = ReplannedPart("bar", "none", 0.0, 0.0, "kept")
    listed = [
        Unsupported(1, f"overhang {number} of bar", "face", ENCLOSED, 1.0, np.zeros((1, 3)), 1.0)
        for number in (1, 2)
    ]
    record = ReplanRecord("a.3mf", "by a.3mf", "a.replanned", (again, kept), unsupported=tuple(listed))
    console = Console(width=200, record=True, file=io.StringIO())
    console.print(summary(record))
    lines = console.export_text()
    assert "tee: turned by 30.00 degrees; supports planned again (turned)" in lines
    assert f"bar: 2 unsupported overhangs ({ENCLOSED})" in lines
    assert "1 kept, 1 planned again" in lines
    assert record.faults == 2


def test_an_enclosed_overhang_is_planned_again_when_something_near_it_went(plate, tmp_path):
    build = read_build(plate)
    for reason, supports in ((ENCLOSED, "planned again"), (NO_FREE_VOXEL_BELOW, "kept")):
        region = Unsupported(
            1, "overhang 1 of tee-2", "face", reason, 1.0, np.array([[40.0, 10.0, 9.0]]), 1.0
        )
        file = amprep.write(replace(build, unsupported=(region,)), tmp_path / f"{supports}.3mf")
        record = amprep.replan(edit(file, tmp_path / "edited.3mf", {0: shift(y=120.0)}), output=tmp_path)
        assert supports_of(record)["tee-2"] == ("none", supports)


def test_new_names_count():
    names = [new_name(Path(each)) for each in ("a.build-1.3mf", "a.replanned.3mf", "a.replanned-2.3mf")]
    assert names == ["a.build-1.replanned", "a.replanned-2", "a.replanned-3"]


def test_a_part_that_is_named_like_a_support_is_a_part(tmp_path):
    write_stl(mesh_of(box((12, 6, 5), (0, 0, 0))), tmp_path / "walls of garage.stl")
    settings = {"printer": "EOS M290", "supports.enabled": False, "packing.strategy": "extreme-points"}
    amprep.run(tmp_path / "walls of garage.stl", output=tmp_path, settings=settings)
    (file,) = tmp_path.glob("*.3mf")
    record = amprep.replan(file, output=tmp_path / "out")
    assert [(part.label, part.change) for part in record.parts] == [("walls of garage", "none")]
    assert record.deleted == ()
