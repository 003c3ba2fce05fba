"""Packages: the bytes depend on the contents alone, and contents are compressed as stated."""

import zlib
from zipfile import ZIP_DEFLATED, ZipFile

from amprep.threemf.package import write
from amprep.threemf.package.write import write_package

TEXT = b"".join(b'<vertex x="%.3f" y="%.3f"/>' % (i * 0.37, i * i % 91) for i in range(20_000))


def packed(path, *, most_bytes=2**20):
    write_package(path, [("small.xml", 4, [b"<a/>"]), ("3D/model", most_bytes, [TEXT[:777], TEXT[777:]])])
    return path


def test_the_contents_come_back_and_the_bytes_are_the_same_each_time(tmp_path):
    one, other = packed(tmp_path / "one.3mf"), packed(tmp_path / "other.3mf")
    assert one.read_bytes() == other.read_bytes()
    with ZipFile(one) as package:
        assert package.testzip() is None
        assert package.read("3D/model") == TEXT
        assert {(each.date_time, each.create_system) for each in package.infolist()} == {
            ((1980, 1, 1, 0, 0, 0), 3)
        }


def test_the_stated_level_compresses(tmp_path):
    with ZipFile(packed(tmp_path / "one.3mf")) as package:
        info = package.getinfo("3D/model")
    level = zlib.compressobj(write._COMPRESSION, zlib.DEFLATED, -15)
    assert info.compress_type == ZIP_DEFLATED
    assert info.compress_size == len(level.compress(TEXT) + level.flush())


def test_contents_that_may_be_large_get_the_headers_for_them(tmp_path):
    small, large = packed(tmp_path / "small.3mf"), packed(tmp_path / "large.3mf", most_bytes=3 * 2**30)
    assert large.stat().st_size > small.stat().st_size
    with ZipFile(large) as package:
        assert package.read("3D/model") == TEXT
