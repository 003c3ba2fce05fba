"""Builds that are written and read back, as they are or with changes in the file."""

import io
import zipfile

import pytest
from tests.shared.records import MODEL

from amprep.threemf import read_build, write_build


@pytest.fixture
def round_trip(tmp_path):
    def run(build):
        write_build(build, tmp_path / "build.3mf")
        return read_build(tmp_path / "build.3mf")

    return run


@pytest.fixture
def edited(make_build, tmp_path):
    """Return a function that reads a build whose model text was edited."""

    def run(old, new, target="generic", count=1, **options):
        path = tmp_path / "edited.3mf"
        write_build(make_build(target, **options), path)
        with zipfile.ZipFile(path) as package:
            contents = {name: package.read(name) for name in package.namelist()}
        assert contents[MODEL].count(old.encode()) >= 1
        contents[MODEL] = contents[MODEL].replace(old.encode(), new.encode(), count)
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w") as package:
            for name, content in contents.items():
                package.writestr(name, content)
        path.write_bytes(packed.getvalue())
        return read_build(path)

    return run
