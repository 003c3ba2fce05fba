"""The identifier of a build: follows from what is built, is in the file, and survives what slicers do to names."""

import re
import zipfile
from dataclasses import replace

import numpy as np
import pytest

from amprep.model import TARGETS
from amprep.threemf import write_build
from amprep.threemf.build.identifier import identifier_of, identifiers_in, read_identifier, title_of


@pytest.mark.parametrize("target", TARGETS)
def test_the_file_states_the_identifier_of_its_build(make_build, tmp_path, target):
    build = make_build(target)
    write_build(build, tmp_path / "job.3mf")
    assert read_identifier(tmp_path / "job.3mf") == identifier_of(build)


def test_equal_builds_have_one_identifier_and_others_have_others(make_build):
    build = make_build()
    moved = np.eye(4)
    moved[0, 3] = 0.5
    shifted = replace(build.parts[0], matrix=moved @ build.parts[0].matrix)
    others = [
        replace(build, settings=replace(build.settings, build_id="other.build-1")),
        replace(build, parts=(shifted, *build.parts[1:])),
        replace(build, supports=()),
    ]
    assert identifier_of(make_build()) == identifier_of(build)
    assert len({identifier_of(each) for each in (build, *others)}) == 4


@pytest.mark.parametrize("kept", ["[^0-9a-zA-Z]", r"[^\w.]", "[ ]"])
def test_it_is_found_in_a_name_whose_special_characters_a_slicer_replaced(make_build, kept):
    build = make_build()
    name = re.sub(kept, "_", f"plate-2 ({title_of(build)})")
    assert identifiers_in(f"{name}_id_0_copy_0") == [identifier_of(build)]


def test_other_files_have_none(tmp_path):
    text, archive = tmp_path / "text.3mf", tmp_path / "zip.3mf"
    text.write_text("no zip", encoding="utf-8")
    with zipfile.ZipFile(archive, "w") as package:
        package.writestr("3D/3dmodel.model", "<model><resources/></model>")
    assert [read_identifier(each) for each in (text, archive, tmp_path / "missing.3mf")] == [None] * 3


@pytest.mark.parametrize("method", [zipfile.ZIP_DEFLATED, zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2])
def test_a_damaged_archive_has_none(tmp_path, method):
    path = tmp_path / "damaged.3mf"
    with zipfile.ZipFile(path, "w", method) as package:
        package.writestr("3D/3dmodel.model", "<model>" + "abc" * 1000 + "<resources/></model>")
    content = bytearray(path.read_bytes())
    content[50:65] = bytes(255 - byte for byte in content[50:65])
    path.write_bytes(content)
    assert read_identifier(path) is None


def test_a_date_in_the_name_of_a_part_is_no_identifier(make_build):
    title = title_of(make_build())
    assert identifiers_in(f"bracket 20240101 ({title})") == [identifier_of(make_build())]
    assert identifiers_in("bracket_20240101.stl") == []
    assert identifiers_in("plate_job_supported_0a1b2c3d_") == ["0a1b2c3d"]
