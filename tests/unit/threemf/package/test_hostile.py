"""Hostile and broken 3MF packages are refused in one line, with bounded work, and without other files."""

import io
import struct
import tracemalloc
import zipfile

import numpy as np
import pytest

from amprep.errors import InputError
from amprep.pipeline.reading import repair_part
from amprep.threemf import read_parts
from amprep.threemf.package import open as package_module
from amprep.threemf.package import scan as scan_module

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
TYPES = (
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
    "</Types>"
)
RELATIONS = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="r1" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)
CORNERS = (
    '<vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>'
    '<vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/>'
)
FACES = (
    '<triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>'
    '<triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/>'
)
TETRAHEDRON = (
    f'<object id="1"><mesh><vertices>{CORNERS}</vertices><triangles>{FACES}</triangles></mesh></object>'
)
ITEM = '<item objectid="1"/>'


def model(resources=TETRAHEDRON, build=ITEM, head=""):
    inside = f"<resources>{resources}</resources><build>{build}</build>"
    return f'{head}<model unit="millimeter" xmlns="{CORE}">{inside}</model>'


def packed(content=None, files=None):
    """Return the bytes of a package with one model, and `files` added or replaced."""
    entries = {"[Content_Types].xml": TYPES, "_rels/.rels": RELATIONS, "3D/3dmodel.model": content or model()}
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in (entries | (files or {})).items():
            archive.writestr(name, text)
    return stream.getvalue()


def refusal(path, content):
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        [repair_part(part, allow_surface=False) for part in read_parts(path)]
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)
    assert len(str(caught.value)) < 600
    return str(caught.value)


def test_the_intact_package_is_read(tmp_path):
    (tmp_path / "a.3mf").write_bytes(packed())
    (part,) = (repair_part(part, allow_surface=False) for part in read_parts(tmp_path / "a.3mf"))
    assert part.volume_mm3 == pytest.approx(1 / 6)
    assert part.notes == ()


def nested(levels):
    return "<a>" * levels + "</a>" * levels


def doubling(levels):
    """Objects 2, 3, ... each made of the one before, twice."""
    twice = [f'<component objectid="{n}"/>' * 2 for n in range(1, levels + 1)]
    return TETRAHEDRON + "".join(
        f'<object id="{n}"><components>{two}</components></object>' for n, two in enumerate(twice, 2)
    )


def chain(levels):
    return TETRAHEDRON + "".join(
        f'<object id="{n}"><components><component objectid="{n - 1}"/></components></object>'
        for n in range(2, levels + 2)
    )


LOOP = (
    '<object id="1"><components><component objectid="2"/></components></object>'
    '<object id="2"><components><component objectid="1"/></components></object>'
)
SELF = '<object id="1"><components><component objectid="1"/></components></object>'
ENTITIES = '<!DOCTYPE model [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
CONFIG = "Metadata/Slic3r_PE_model.config"
BEYOND = (
    '<config><object id="1"><volume firstid="2" lastid="99999999">'
    '<metadata key="volume_type" value="SupportBlocker"/></volume></object></config>'
)
OUTSIDE = '<!DOCTYPE model [<!ENTITY a SYSTEM "file:///etc/passwd">]>'


def test_an_archive_with_damaged_lzma_data_is_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.3mf", "w", zipfile.ZIP_LZMA) as package:
        package.writestr("3D/3dmodel.model", "abc" * 1000)
    content = bytearray((tmp_path / "a.3mf").read_bytes())
    content[55:65] = bytes(255 - byte for byte in content[55:65])
    assert "damaged" in refusal(tmp_path / "a.3mf", bytes(content))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "not a 3MF file"),
        (b"nonsense", "not a 3MF file"),
        (packed()[: len(packed()) // 2], "damaged"),
        (packed()[:-3], "damaged"),
        (packed()[:200] + b"\0" * 20 + packed()[220:], "damaged"),
        (packed(model(head=ENTITIES)), "document type definition"),
        (packed(model(head=OUTSIDE)), "document type definition"),
        (packed(model(head="<!DOCTYPE model>").encode("utf-16")), "document type definition"),
        (packed(files={CONFIG: ENTITIES + "<config/>"}), "document type definition"),
        (packed(files={"_rels/.rels": ENTITIES + RELATIONS}), "document type definition"),
        (packed(model(nested(100))), "nested deeper"),
        (packed(model(nested(100).replace("<a>", '<a b="/>">'))), "nested deeper"),
        (packed(model(nested(100).replace("<a>", "<a b='\"/>'>"))), "nested deeper"),
        (packed(model(f'<a b="{CORNERS}"/>')), "well-formed"),
        (packed(model()[:-10]), "well-formed"),
        (packed(model(doubling(40), '<item objectid="41"/>')), "instances"),
        (packed(model(chain(500), '<item objectid="501"/>')), "nested 501 deep"),
        (packed(model(LOOP)), "object that is defined before"),
        (packed(model(SELF)), "a.3mf"),
        (packed(model(build=ITEM * 100_001)), "instances"),
        (packed(model(TETRAHEDRON.replace('x="1"', 'x="nan"'))), "a.3mf"),
        (packed(model(TETRAHEDRON.replace('x="1"', 'x="1e999"'))), "a.3mf"),
        (packed(model(TETRAHEDRON.replace('v1="1"', 'v1="77"'))), "a.3mf"),
        (packed(model(TETRAHEDRON.replace('v1="1"', 'v1="-1"'))), "a.3mf"),
        (packed(model(TETRAHEDRON.replace(FACES, ""))), "a.3mf"),
        (packed(model(build='<item objectid="1" transform="1 0 0 0 1 0 0 0 0 0 0 0"/>')), "flattens"),
        (packed(model(build='<item objectid="1" transform="nan 0 0 0 1 0 0 0 1 0 0 0"/>')), "a.3mf"),
        (packed(model(build='<item objectid="9"/>')), "a.3mf"),
        (packed(model(build="")), "nothing that can be printed"),
        (packed(model("", "")), "nothing that can be printed"),
        (packed("<model/>"), "a.3mf"),
        (packed(files={"_rels/.rels": "<a/>", "3D/3dmodel.model": "<b/>"}), "a.3mf"),
        (packed(files={"/evil.model": "x"}), "points outside the package"),
        (packed(files={"../evil.model": "x"}), "points outside the package"),
        (packed(files={"3D/../../evil.model": "x"}), "points outside the package"),
        (packed(files={"C:\\evil": "x"}), "points outside the package"),
        (packed(files={"3d/3DMODEL.model": model()}), "same name"),
        (packed(files={CONFIG: "<config><object/></config>"}), "PrusaSlicer"),
        (packed(files={CONFIG: BEYOND}), "triangles that do not exist"),
    ],
)  # fmt: skip
def test_a_hostile_or_broken_package_is_refused_in_one_line(tmp_path, content, words):
    assert words in refusal(tmp_path / "a.3mf", content)


def test_a_zip_bomb_is_refused_before_it_is_inflated(tmp_path):
    bomb = packed(files={"bomb.png": b"\0" * (200 << 20)})
    tracemalloc.start()
    assert "inflates to more than" in refusal(tmp_path / "a.3mf", bomb)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 120 << 20, "the entry has 200 MiB, and 64 MiB are allowed"


def test_a_zip_bomb_that_states_a_wrong_size_is_refused(tmp_path):
    content = bytearray(packed(files={"bomb.png": b"\0" * (100 << 20)}))
    size = struct.pack("<I", 100 << 20)
    assert content.count(size) == 2
    lie = bytes(content).replace(size, struct.pack("<I", 10))
    assert "damaged" in refusal(tmp_path / "a.3mf", lie)


def test_many_small_entries_are_refused(tmp_path):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for number in range(package_module.MOST_ENTRIES + 1):
            archive.writestr(f"{number}.png", "")
    assert "entries" in refusal(tmp_path / "a.3mf", stream.getvalue())


def test_the_total_size_of_all_entries_is_limited(tmp_path, monkeypatch):
    monkeypatch.setattr(package_module, "MOST_BYTES", 1000)
    assert "inflates" in refusal(tmp_path / "a.3mf", packed(files={"a.png": "x" * 400, "b.png": "y" * 400}))


def test_the_number_of_xml_elements_is_limited(tmp_path, monkeypatch):
    monkeypatch.setattr(scan_module, "MOST_ELEMENTS", 10)
    assert "XML elements" in refusal(tmp_path / "a.3mf", packed())


def test_a_folder_or_a_missing_file_is_refused_in_one_line(tmp_path):
    (tmp_path / "folder.3mf").mkdir()
    for name in ("folder.3mf", "none.3mf"):
        with pytest.raises(InputError, match="cannot read the file"):
            read_parts(tmp_path / name)


def test_an_encrypted_package_is_refused(tmp_path):
    content = bytearray(packed())
    for at in range(len(content) - 4):
        if content[at : at + 4] == b"PK\1\2":
            content[at + 8] |= 1
        if content[at : at + 4] == b"PK\3\4":
            content[at + 6] |= 1
    assert "kind of zip" in refusal(tmp_path / "a.3mf", bytes(content))


def test_a_relationship_to_a_target_outside_the_package_is_not_followed(tmp_path):
    outward = (
        '<Relationship Target="file:///etc/passwd" TargetMode="External" Id="r2" '
        'Type="http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail"/></Relationships>'
    )
    content = packed(files={"_rels/.rels": RELATIONS.replace("</Relationships>", outward)})
    (tmp_path / "a.3mf").write_bytes(content)
    (part,) = read_parts(tmp_path / "a.3mf")
    assert part.notes == ()
    assert "no relationship may refer to anything outside the package" in part.warnings[0]


def test_any_changed_byte_gives_parts_or_an_error_of_one_line(tmp_path):
    rng = np.random.default_rng(11)
    stored = io.BytesIO()
    with zipfile.ZipFile(stored, "w") as archive:
        for name, text in {"[Content_Types].xml": TYPES, "_rels/.rels": RELATIONS}.items():
            archive.writestr(name, text)
        archive.writestr("3D/3dmodel.model", model())
    for content in (packed(), stored.getvalue()):
        for _ in range(60):
            changed = bytearray(content)
            changed[rng.integers(len(changed))] = rng.integers(256)
            (tmp_path / "a.3mf").write_bytes(changed)
            try:
                [repair_part(part, allow_surface=True) for part in read_parts(tmp_path / "a.3mf")]
            except InputError as error:
                assert "\n" not in str(error)  # noqa: PT017 - either outcome is right


def test_any_change_in_the_model_gives_parts_or_an_error_of_one_line(tmp_path):
    """Changed before packing, so that the checksum does not catch it."""
    rng = np.random.default_rng(12)
    text = model(TETRAHEDRON + '<object id="2"><components><component objectid="1"/></components></object>')
    for _ in range(150):
        changed = bytearray(text.encode())
        changed[rng.integers(len(changed))] = rng.choice(list(b'<>/"=0 9x-&'))
        (tmp_path / "a.3mf").write_bytes(packed(bytes(changed)))
        try:
            [repair_part(part, allow_surface=True) for part in read_parts(tmp_path / "a.3mf")]
        except InputError as error:
            assert "\n" not in str(error)  # noqa: PT017 - either outcome is right
