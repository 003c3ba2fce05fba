"""Faults planted in the entries of written packages, as a careless program or a malicious hand would plant them.

Verification must find each of them, and must accept the unchanged files. The file is long because it is one list.
"""

import re

from tests.shared.planted import (
    BEAMS,
    COMPONENTS,
    CONFIG,
    CURA,
    MODEL,
    PRUSASLICER,
    Entries,
    Fault,
    Planted,
    add,
    drop,
    scale_radii,
    sub,
)


def _swapped(entries: Entries) -> Entries:
    """Exchange the supports of both parts, with their names."""
    text = entries[MODEL].replace('objectid="2"', 'objectid="x"').replace('objectid="3"', 'objectid="2"')
    return entries | {MODEL: text.replace('objectid="x"', 'objectid="3"')}


_BLANK = '<?xml version="1.0"?><model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"/>'
_TRIANGLE = "<mesh><vertices>" + '<vertex x="0" y="0" z="0"/><vertex x="9" y="0" z="0"/>' * 2 + "</vertices>"
_STRAY = (
    f'<object id="90" name="stray" type="model">{_TRIANGLE}'
    '<triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh></object>'
)


_MODIFIER = '<metadata type="volume" key="modifier" value="1"/>'
_SLICES = '<s:slicestack id="50" zbottom="0"><s:slice ztop="1"/></s:slicestack>'
_INFILL = '<metadata name="cura:infill_mesh">True</metadata>'
RECORD = "record unchanged"


def _volume_type(kind: str, number: int) -> Fault:
    """Give the volume with a number another type in PrusaSlicer's configuration."""

    def fault(entries: Entries) -> Entries:
        pieces = entries[CONFIG].split("ModelPart")
        text = "ModelPart".join(pieces[: number + 1]) + kind + "ModelPart".join(pieces[number + 1 :])
        return entries | {CONFIG: text}

    return fault


def _record_of_another(entries: Entries) -> Entries:
    """Say of the settings what another build of the same parts says."""
    text = re.sub('"clearance": 5.0', '"clearance": 4.0', entries[MODEL])
    return entries | {MODEL: re.sub('(identifier"[^>]*>)[0-9a-f]{8}', r"\g<1>00000000", text)}


def _turn_clipping(entries: Entries) -> Entries:
    """Turn over the first triangle of the clipping mesh."""
    head, found, tail = entries[MODEL].partition('z="60.000000"')
    return entries | {
        MODEL: head + found + re.sub(r'v1="(\d+)" v2="(\d+)"', r'v1="\2" v2="\1"', tail, count=1)
    }


FAULTS = (
    Planted("the unit is inch", sub('unit="millimeter"', 'unit="inch"')),
    Planted("the unit is micron", sub('unit="millimeter"', 'unit="micron"')),
    Planted("the unit is missing in name only", sub('unit="millimeter"', 'unit="furlong"'), promise=None),
    Planted("an item is not printed", sub("<item ", '<item printable="0" ')),
    Planted("an item is not printed, said otherwise", sub("<item ", '<item printable="false" ')),
    Planted("the first object is of type other", sub('type="model"', 'type="other"')),
    Planted("the first object is of type surface", sub('type="model"', 'type="surface"')),
    Planted("the first object is of type support", sub('type="model"', 'type="support"')),
    Planted("the second item is removed", sub(r"(<item .*?</item>)\s*<item .*?</item>", r"\1"), promise=None),
    Planted("the first item is there twice", sub(r"(<item .*?</item>)", r"\1\1"), promise=None),
    Planted("an object that nothing uses", sub("<resources>", f"<resources>{_STRAY}")),
    Planted("another model in the package", add("3D/other.model", _BLANK)),
    Planted("a comment in the model", sub("<resources>", "<!-- --><resources>"), promise=None),
    Planted("the item refers to nothing", sub(r'<item objectid="\d+"', '<item objectid="77"'), promise=None),
    Planted(
        "a triangle of a part is turned over",
        sub(r'(<triangle v1=")(\d+)(" v2=")(\d+)', r"\1\4\3\2"),
        promise="part unchanged",
    ),
    Planted(
        "a vertex of a part is moved",
        sub(r'<vertex x="0.000000"', '<vertex x="-0.020000"'),
        promise="part unchanged",
    ),
    Planted(
        "a support is of type other", sub('type="solidsupport"', 'type="other"'), ("generic", "beams", "cura")
    ),
    Planted("a support is of type surface", sub('type="solidsupport"', 'type="surface"'), COMPONENTS),
    Planted("a support is not filled", sub('type="solidsupport"', 'type="support"'), COMPONENTS),
    Planted("a support is a model", sub('type="solidsupport"', 'type="model"'), ("generic", "beams")),
    Planted(
        "the group is of type support",
        sub(r'(type=")model("[^>]*>\s*<components>)', r"\1support\2"),
        COMPONENTS,
    ),
    Planted(
        "the group is of type other", sub(r'(type=")model("[^>]*>\s*<components>)', r"\1other\2"), COMPONENTS
    ),
    Planted("another component", sub(r"(<component [^>]*/>)", r"\1\1"), COMPONENTS, promise=None),
    Planted(
        "the support's component is removed",
        sub(r"(<component [^>]*/>)\s*<component [^>]*/>", r"\1"),
        COMPONENTS,
        promise=None,
    ),
    Planted("supports are exchanged", _swapped, ("generic", "cura"), promise="support unchanged"),
    Planted(
        "a support is 0.02 mm off",
        sub(r'(<component objectid="2" )', r'\1transform="1 0 0 0 1 0 0 0 1 0.02 0 0" '),
        ("generic", "cura"),
        promise="support unchanged",
    ),
    Planted(
        "a support is shrunk",
        sub(r'(<component objectid="2" )', r'\1transform="0.999 0 0 0 0.999 0 0 0 1 0 0 0" '),
        ("generic", "cura"),
        promise="support unchanged",
    ),
    Planted(
        "a part is 0.02 mm off",
        sub(r'transform="1 0 0 0 1 0 0 0 1 10 ', 'transform="1 0 0 0 1 0 0 0 1 10.02 '),
        promise="part unchanged",
    ),
    Planted("Cura prints a support as a part", sub(r"(cura:support_mesh[^>]*>)True", r"\1False"), CURA),
    Planted(
        "the metadata of a support in Cura is removed",
        sub(r"<metadata name=.cura:support_mesh.*?</metadata>", ""),
        CURA,
    ),
    Planted("Cura fills the space below a support", sub(r"(drop_down[^>]*>)False", r"\1True"), CURA),
    Planted("Cura's support is an infill mesh", sub("cura:support_mesh", "cura:infill_mesh"), CURA),
    Planted("Cura's support is a blocker", sub("cura:support_mesh", "cura:anti_overhang_mesh"), CURA),
    Planted(
        "Cura's support has an infill of its own",
        sub(
            r"(<metadata name=.cura:support_mesh.*?</metadata>)",
            r'\1<metadata name="cura:infill_sparse_density">0</metadata>',
        ),
        CURA,
    ),
    Planted("settings of a Cura project", add("Cura/preferences.cfg", "[general]"), CURA),
    *(
        Planted(f"volume {number} is a {kind}", _volume_type(kind, number), PRUSASLICER)
        for number in (0, 1)
        for kind in ("NegativeVolume", "ParameterModifier", "SupportBlocker", "SupportEnforcer")
    ),
    Planted("half of a part is lost", sub(r'lastid="\d+"', 'lastid="9"', entry=CONFIG), PRUSASLICER),
    Planted("a volume begins later", sub(r'firstid="0"', 'firstid="2"', entry=CONFIG), PRUSASLICER),
    Planted(
        "a volume ends beyond the mesh",
        sub(r'lastid="\d+"', 'lastid="99999"', entry=CONFIG),
        PRUSASLICER,
        promise=None,
    ),
    Planted(
        "the volume of a support is removed",
        sub(r"(</volume>)\s*<volume .*?</volume>", r"\1", entry=CONFIG),
        PRUSASLICER,
    ),
    Planted("a volume is there twice", sub(r"(<volume .*?</volume>)", r"\1\1", entry=CONFIG), PRUSASLICER),
    Planted("an object is not configured", sub(r"<object .*?</object>", "", entry=CONFIG), PRUSASLICER),
    Planted(
        "an object is configured by another number",
        sub(r'<object id="2"', '<object id="7"', entry=CONFIG),
        PRUSASLICER,
    ),
    Planted("the configuration is removed", drop(CONFIG), PRUSASLICER),
    Planted(
        "a volume has settings",
        sub("</volume>", '<metadata type="volume" key="fill_density" value="0%"/></volume>', entry=CONFIG),
        PRUSASLICER,
    ),
    Planted(
        "an object has settings",
        sub("<volume ", '<metadata type="object" key="perimeters" value="0"/><volume ', entry=CONFIG),
        PRUSASLICER,
    ),
    Planted(
        "the package has settings",
        add("Metadata/Slic3r_PE.config", "; perimeters = 0"),
        PRUSASLICER,
        promise=None,
    ),
    Planted(
        "the package has settings of layers",
        add("Metadata/Prusa_Slicer_layer_config_ranges.xml", "<objects/>"),
        PRUSASLICER,
    ),
    Planted(
        "the version is removed", sub(r"<metadata name=.slic3rpe:Version3mf.*?</metadata>", ""), PRUSASLICER
    ),
    Planted("the version is 0", sub(r"(slic3rpe:Version3mf[^>]*>)1", r"\g<1>0"), PRUSASLICER),
    *(
        Planted(f"triangles have {each}", sub("<triangle ", f'<triangle slic3rpe:{each}="4" '), PRUSASLICER)
        for each in ("custom_supports", "mmu_segmentation")
    ),
    Planted(
        "a volume is a modifier, said otherwise",
        sub("(<metadata[^>]*ModelPart[^>]*>)", rf"\1{_MODIFIER}", entry=CONFIG),
        PRUSASLICER,
    ),
    Planted(
        "an object has several instances",
        sub('<object id="1"', r'\g<0> instances_count="3"', entry=CONFIG),
        PRUSASLICER,
    ),
    Planted("a volume ends one triangle later", sub('lastid="23"', 'lastid="24"', entry=CONFIG), PRUSASLICER),
    Planted(
        "Cura knows a setting of an item", sub("<metadatagroup>(?=.{20,60}bodies)", rf"\g<0>{_INFILL}"), CURA
    ),
    Planted("Cura knows a setting of the model", sub("(?=<metadata )", _INFILL), CURA),
    Planted(
        "Cura fills below, as it does by default",
        sub(r"<metadata name=.cura:support_mesh_drop.*?</metadata>", ""),
        CURA,
    ),
    Planted(
        "Cura's namespace is another one", sub('http://software.ultimaker[^"]*', "http://localhost"), CURA
    ),
    Planted("the file has slices", sub("<resources>", rf"\g<0>{_SLICES}"), ("beams",)),
    Planted(
        "geometry comes from another part",
        sub("<component ", r'\g<0>p:path="/3D/other.model" '),
        ("cura",),
        None,
    ),
    Planted("a number of other notation", sub('<vertex x="0.000000"', '<vertex x="0x1"'), ("generic",)),
    Planted("an extension is required", sub("<model ", '<model requiredextensions="s" '), ("generic",)),
    Planted(
        "a part is mirrored",
        sub('transform="1 0 0 0 1 0 0 0 1 10 ', 'transform="-1 0 0 0 1 0 0 0 1 27 '),
        ("prusaslicer",),
        "allowed motion",
    ),
    Planted("a support holds another part", sub('"holds": \\[0\\]', '"holds": [0, 1]'), ("beams",), RECORD),
    Planted("a part has another label", sub('"label": "bracket-2"', '"label": "x"'), ("cura",), RECORD),
    Planted(
        "supports are not demanded",
        sub('"supported": true', '"supported": false'),
        ("generic",),
        RECORD,
    ),
    Planted("a larger volume", sub(r'"size": \[100', '"size": [1000'), ("prusaslicer",), RECORD),
    Planted("places are not recorded", sub(r', "at": \[[^]]*\]', ""), ("prusaslicer",), RECORD),
    Planted(
        "numbers are not recorded",
        sub(r"<metadata name=.amprep:contents.*?</metadata>", ""),
        ("generic",),
        RECORD,
    ),
    Planted("the record of another build", _record_of_another, ("cura",), RECORD),
    Planted("all radii times 1.5", scale_radii(1.5), BEAMS, promise="support unchanged"),
    Planted("all radii times 0.01", scale_radii(0.01), BEAMS, promise="least wall"),
    Planted(
        "one radius of 10",
        sub(r'(<b:beam v1="8" v2="12")', r'\1 r1="10" r2="10"'),
        BEAMS,
        promise="support unchanged",
    ),
    Planted(
        "one radius is slightly more",
        sub(r'(<b:beam v1="8" v2="12")', r'\1 r1="0.76"'),
        BEAMS,
        promise="support unchanged",
    ),
    Planted("one beam is removed", sub(r"<b:beam v1=[^>]*/>", ""), BEAMS, promise="support unchanged"),
    Planted(
        "one beam is there twice", sub(r"(<b:beam v1=[^>]*/>)", r"\1\1"), BEAMS, promise="support unchanged"
    ),
    Planted(
        "one beam ends elsewhere",
        sub(r'<b:beam v1="8" v2="12"', '<b:beam v1="8" v2="14"'),
        BEAMS,
        promise="support unchanged",
    ),
    Planted(
        "the plate of the beams is removed",
        sub(r"</vertices><triangles>((?!</triangles>).)*</triangles><b:", "</vertices><b:"),
        BEAMS,
        promise="coverage",
    ),
    Planted("balls at nodes", sub("<b:beamlattice ", r'\g<0>ballmode="all" ballradius="3" '), BEAMS),
    Planted("a beam is added", sub("(?=<b:beam )", '<b:beam v1="8" v2="13"/>'), BEAMS, "support unchanged"),
    Planted("a triangle of the clipping mesh is turned over", _turn_clipping, BEAMS),
    Planted("another cap", sub('cap="sphere"', 'cap="butt"'), BEAMS),
    Planted("one beam has another cap", sub(r'(<b:beam v1="8" v2="12")', r'\1 cap1="hemisphere"'), BEAMS),
    Planted("beams must be longer", sub('minlength="0.001"', 'minlength="50"'), BEAMS),
    Planted("beams are clipped outside", sub('clippingmode="inside"', 'clippingmode="outside"'), BEAMS),
    Planted(
        "beams are not clipped",
        sub(r'clippingmode="inside" clippingmesh="\d+" ', ""),
        BEAMS,
        promise="support unchanged",
    ),
    Planted("the clipping mesh cuts everything away", sub(r'clippingmesh="\d+"', 'clippingmesh="1"'), BEAMS),
    Planted("the clipping mesh ends at half height", sub(r'z="60.000000"', 'z="4.000000"', count=4), BEAMS),
    Planted("readers need not know beams", sub(r' requiredextensions="b"', ""), BEAMS),
    Planted(
        "the mesh for other readers is another one",
        sub(r'representationmesh="\d+"', 'representationmesh="1"'),
        BEAMS,
        promise="support unchanged",
    ),
)
