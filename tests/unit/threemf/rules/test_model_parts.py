"""A file with any fault that the specification forbids is refused under strict reading; without one it is accepted.

lib3mf's strict reader is a second opinion: it must accept the file without faults, and refuse what it can judge.
"""

import zipfile

import pytest

from amprep.errors import InputError
from amprep.threemf import read_parts

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
MATERIALS = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
KINDS = "http://schemas.microsoft.com/3dmanufacturing/2013/01"
THUMBNAIL = "http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail"
SPACE = "http://schemas.openxmlformats.org/package/2006"
TICKET = f'<Relationship Target="/3D/Textures/wood.png" Id="r2" Type="{KINDS}/printticket"/>'
SCHEMA = 'xmlns:s="http://www.w3.org/2001/XMLSchema-instance"'

TYPES = (
    f'<Types xmlns="{SPACE}/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
    '<Default Extension="xml" ContentType="application/vnd.ms-printing.printticket+xml"/>'
    '<Default Extension="png" ContentType="image/png"/></Types>'
)
ROOT = (
    f'<Relationships xmlns="{SPACE}/relationships">'
    f'<Relationship Target="/3D/3dmodel.model" Id="r0" Type="{KINDS}/3dmodel"/>'
    f'<Relationship Target="/Metadata/small.png" Id="r1" Type="{THUMBNAIL}"/></Relationships>'
)
OF_MODEL = (
    f'<Relationships xmlns="{SPACE}/relationships">'
    f'<Relationship Target="/3D/print.xml" Id="r0" Type="{KINDS}/printticket"/>'
    f'<Relationship Target="/3D/Textures/wood.png" Id="r1" Type="{KINDS}/3dtexture"/></Relationships>'
)
MODEL = f"""<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="{CORE}" xmlns:m="{MATERIALS}" xmlns:v="http://example.org/v">
  <metadata name="Title">Wedge</metadata>
  <metadata name="v:batch">7</metadata>
  <resources>
    <basematerials id="1"><base name="steel" displaycolor="#808080"/><base name="tin" displaycolor="#A0A0A0FF"/>
    </basematerials>
    <m:texture2d id="2" path="/3D/Textures/wood.png" contenttype="image/png"/>
    <m:colorgroup id="3"><m:color color="#FF0000"/><m:color color="#00FF00"/></m:colorgroup>
    <m:texture2dgroup id="4" texid="2"><m:tex2coord u="0" v="0"/><m:tex2coord u="1" v="0.5"/></m:texture2dgroup>
    <m:compositematerials id="5" matid="1" matindices="0 1"><m:composite values="0.25 0.75"/>
    </m:compositematerials>
    <m:multiproperties id="6" pids="5 3"><m:multi pindices="0 1"/></m:multiproperties>
    <object id="7" type="model" pid="1" pindex="0" name="wedge" thumbnail="/3D/Textures/wood.png">
      <mesh>
        <vertices>
          <vertex x="0" y="0" z="0"/><vertex x="10" y="0" z="0"/><vertex x="0" y="10" z="0"/>
          <vertex x="0" y="0" z="1.25e1"/>
        </vertices>
        <triangles>
          <triangle v1="0" v2="2" v3="1" pid="3" p1="0" p2="1" p3="1"/><triangle v1="0" v2="1" v3="3" pid="6" p1="0"/>
          <triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/>
        </triangles>
      </mesh>
    </object>
    <object id="8" type="other"><mesh>
        <vertices><vertex x="0" y="0" z="0"/><vertex x="10" y="0" z="0"/><vertex x="0" y="10" z="0"/></vertices>
        <triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh></object>
    <object id="9"><components><component objectid="7"/></components></object>
  </resources>
  <build>
    <item objectid="7" partnumber="a"/><item objectid="9" transform="1 0 0 0 1 0 0 0 1 30 0 0"/>
  </build>
</model>
"""
ENTRIES = {
    "[Content_Types].xml": TYPES,
    "_rels/.rels": ROOT,
    "3D/_rels/3dmodel.model.rels": OF_MODEL,
    "3D/3dmodel.model": MODEL,
    "3D/print.xml": "<PrintTicket/>",
    "3D/Textures/wood.png": "image",
    "Metadata/small.png": "image",
}


def planted(path, name, before, after):
    """Write the package with one replacement in one entry."""
    assert before in ENTRIES[name]
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for each, content in ENTRIES.items():
            archive.writestr(each, content.replace(before, after, 1) if each == name else content)
    return path


def refusal(path, *, strict):
    """Return why a file is refused, or "" if it is accepted."""
    try:
        read_parts(path, strict=strict)
    except InputError as error:
        assert "\n" not in str(error)  # noqa: PT017 - either outcome is right
        return str(error)
    return ""


def refused_by_lib3mf(path):
    import lib3mf

    reader = lib3mf.get_wrapper().CreateModel().QueryReader("3mf")
    reader.SetStrictModeActive(True)
    try:
        reader.ReadFromFile(str(path))
    except lib3mf.ELib3MFException as error:
        return str(error)
    return ""


def test_a_file_without_faults_is_accepted_by_both_readers_without_warnings(tmp_path):
    path = planted(tmp_path / "a.3mf", "3D/3dmodel.model", "Wedge", "Wedge")
    assert refused_by_lib3mf(path) == ""
    parts = read_parts(path, strict=True)
    assert [part.quantity for part in parts] == [1, 1]
    assert [part.warnings for part in parts] == [(), ()]


APPEARANCE = [
    ('"_rels/.rels"', "/Metadata/small.png", "/Metadata/none.png", "core 2.1.1"),
    ('"_rels/.rels"', 'Id="r1"', 'Id="r0"', "OPC 9.3"),
    ("types", 'Extension="png" ContentType="image/png"', 'Extension="png" ContentType="image/gif"', "core 2.1.3"),
    ("of model", "/3D/Textures/wood.png", "C:/Textures/wood.png", "core 2.1.1"),
    ("of model", "</Relationships>", f'{TICKET}</Relationships>', "core 2.1.4"),
    ("model", 'xml:lang="en-US"', 'xml:lang="en-US" xml:space="default"', "core 2.3.4"),
    ("model", 'xmlns:v="http://example.org/v"', f'xmlns:v="http://example.org/v" {SCHEMA} s:type="x"', "core 2.3.2"),
    ("model", "<vertices>", '<vertices v:new="1">', "core 2.3.2"),
    ("model", "<resources>", "<resources>words", "core 2.3.3"),
    ("model", ' name="Title"', "", "core 3.4.1"),
    ("model", 'name="v:batch"', 'name="Title"', "core 3.4.1"),
    ("model", 'name="v:batch"', 'name="w:batch"', "core 3.4.1"),
    ("model", 'name="v:batch"', 'name="undefined"', "core 3.4.1"),
    ("model", '<m:colorgroup id="3">', '<m:colorgroup id="2">', "core 3.4.2"),
    ("model", 'pid="1" pindex="0" name', 'pindex="0" name', "core 4"),
    ("model", 'pid="3" p1="0"', 'pid="33" p1="0"', "core 4.1.4.1"),
    ("model", 'pid="3" p1="0"', 'pid="3" p1="9"', "core 4.1.4.1"),
    ("model", 'pid="3" p1="0"', 'pid="1" p1="0"', "core 4.1.4.1"),
    ("model", '<triangle v1="1" v2="2" v3="3"/>', '<triangle v1="1" v2="3" v3="2"/>', "core 4.1"),
    ("model", '<triangle v1="1" v2="2" v3="3"/>', '<triangle v1="1" v2="2" v3="0"/>', "core 4.1"),
    ("model", 'displaycolor="#808080"', 'displaycolor="grey"', "core 5.1"),
    ("model", '<base name="steel"', "<base", "core 5.1"),
    ("model", '<m:color color="#FF0000"/>', "<m:color/>", "materials 2.1"),
    ("model", ' texid="2"', "", "materials 3"),
    ("model", ' texid="2"', ' texid="1"', "materials 3"),
    ("model", 'matid="1"', 'matid="3"', "materials 4"),
    ("model", ' matindices="0 1"', "", "materials 4"),
    ("model", ' pids="5 3"', "", "materials 5"),
    ("model", ' pids="5 3"', ' pids="3 5"', "materials 5"),
    ("model", ' pids="5 3"', ' pids="5 1"', "materials 5"),
    ("model", ' pids="5 3"', ' pids="3 3"', "materials 5"),
    ("model", ' pids="5 3"', ' pids="5 99"', "materials 5"),
    ("model", ' path="/3D/Textures/wood.png"', "", "materials 6"),
    ("model", "/3D/Textures/wood.png", "/3D/Textures/none.png", "materials 6"),
    ("model", 'contenttype="image/png"', 'contenttype=""', "materials 6"),
]  # fmt: skip
"""Faults that cannot touch geometry, units or placement: entry, before, after, chapter."""

NAMES = {
    '"_rels/.rels"': "_rels/.rels",
    "types": "[Content_Types].xml",
    "of model": "3D/_rels/3dmodel.model.rels",
    "model": "3D/3dmodel.model",
}


@pytest.mark.parametrize(("entry", "before", "after", "chapter"), APPEARANCE)
def test_a_fault_beside_the_geometry_is_refused_if_strict_and_else_a_warning(
    tmp_path, entry, before, after, chapter
):
    path = planted(tmp_path / "a.3mf", NAMES[entry], before, after)
    assert f"{chapter}: " in refusal(path, strict=True)
    parts = read_parts(path)
    assert sum(part.quantity for part in parts) == 2
    assert max(part.mesh.bounds[1][2] for part in parts) == pytest.approx(12.5)
    assert any(chapter in warning for warning in parts[0].warnings)


@pytest.mark.parametrize(
    ("entry", "before", "after", "chapter"),
    [
        ('"_rels/.rels"', f"{KINDS}/3dmodel", f"{KINDS}/model", "core 2.1.1"),
        ('"_rels/.rels"', "/3D/3dmodel.model", "/3D/none.model", "core 2.1.1"),
        ('"_rels/.rels"', 'Id="r0"', 'Id="r0" TargetMode="External"', "core 2.1.1"),
        ('"_rels/.rels"', THUMBNAIL, f"{KINDS}/3dmodel", "core 2.1.1"),
        ("model", 'encoding="UTF-8"', 'encoding="ISO-8859-1"', "core 2.3.2"),
        ("model", "<resources>", "<x:y/><resources>", "core 2.3.3.1"),
        ("model", "<resources>", "<parts/><resources>", "core 2.3.2"),
        ("model", '<item objectid="7"', '<item objectid="7" trasnform="1"', "core 2.3.2"),
        ("model", 'unit="millimeter"', 'unit="mm"', "core 3.4"),
        ("model", 'unit="millimeter"', 'unit="millimeter" requiredextensions="v"', "core 2.3.1"),
        ("model", 'unit="millimeter"', 'unit="millimeter" requiredextensions="w"', "core 3.4"),
        ("model", MODEL[MODEL.index("  <build>") : MODEL.index("</model>")], "", "core 3.4"),
        ("model", MODEL[MODEL.index("  <resources>") : MODEL.index("  <build>")], "", "core 3.4"),
        ("model", 'id="8"', 'id="7"', "core 3.4.2"),
        ("model", '<item objectid="7"', '<item objectid="77"', "core 3.4.3.1"),
        ("model", '<item objectid="7"', '<item objectid="8"', "core 3.4.3.1"),
        ("model", "1 0 0 0 1 0 0 0 1 30 0 0", "1 0 0 0 1 0 0 0 1 30 0", "core 3.4.3.1"),
        ("model", 'type="model"', 'type="part"', "core 4"),
        ("model", 'z="1.25e1"', 'z="12,5"', "core 4.1.3.1"),
        ("model", 'z="1.25e1"', 'z="1e999"', "core 4.1.3.1"),
        ("model", 'v1="1" v2="2"', 'v1="9" v2="2"', "core 4.1.4.1"),
        ("model", '<triangle v1="1" v2="2" v3="3"/>', '<triangle v1="1" v2="2"/>', "core 4.1.4.1"),
        ("model", '<component objectid="7"/>', '<component objectid="10"/>', "core 4.2.1"),
    ],
)  # fmt: skip
def test_a_fault_that_may_touch_parts_is_always_refused_with_its_rule(
    tmp_path, entry, before, after, chapter
):
    path = planted(tmp_path / "a.3mf", NAMES[entry], before, after)
    for strict in (False, True):
        assert f"3MF {chapter}: " in refusal(path, strict=strict)


def test_what_lib3mf_refuses_strictly_the_rules_refuse_too(tmp_path):
    """Of the faults that lib3mf's strict reader finds, none is missed; it finds at least a third of them."""
    found = 0
    for entry, before, after, _ in APPEARANCE:
        path = planted(tmp_path / "a.3mf", NAMES[entry], before, after)
        found += refused_by_lib3mf(path) != ""
        assert refusal(path, strict=True)
    assert found > len(APPEARANCE) / 3
