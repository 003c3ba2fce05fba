"""The compiled parser of G-code finds what a plain parser finds, and arcs where the formulas of circles put them."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.shared.gcode import PlainParser

from amprep.slicers.gcode import read as reading
from amprep.slicers.gcode.read import read_gcode, read_head

HEIGHTS = np.array([0.1, 1.0])


def read(path, text):
    path.write_text(text, encoding="utf-8", newline="")
    return read_gcode(path, read_head(path), HEIGHTS)


NUMBERS = st.one_of(
    st.integers(-300, 300).map(str), st.decimals(-300, 300, places=3).map(lambda v: f"{v:f}"), st.just(".5")
)
WORDS = st.fixed_dictionaries(
    {},
    optional={
        "X": NUMBERS,
        "Y": NUMBERS,
        "Z": st.sampled_from(["0.2", "0.4", "1", "1.25"]),
        "E": NUMBERS,
        "F": st.just("1800"),
    },
)
MOVES = st.builds(
    lambda code, words, gap, end: code + "".join(f"{gap}{w}{v}" for w, v in words.items()) + end,
    st.sampled_from(["G1", "G0", "G01"]),
    WORDS,
    st.sampled_from([" ", "  ", ""]),
    st.sampled_from(["", " ; X99 Y99 E99", " ;retract", "\r"]),
)
OTHERS = st.sampled_from(
    [
        *("G90", "G91", "M82", "M83", "G20", "G21", "G28", "G28 X Y", "G92 E0", "G92 X5 Z1", "M104 S200"),
        *(";TYPE:External perimeter", ";TYPE:Solid infill", ";TYPE:Support material", ";TYPE:Skirt/Brim"),
        *("; printing object one (x) id:0 copy 0", "; printing object two id:1 copy 0", "", ";WIDTH:0.6"),
        *("; stop printing object one (x) id:0 copy 0", "G4 P100", "T0", "; a comment = 5", "   "),
    ]
)
PROGRAMS = st.lists(st.one_of(MOVES, MOVES, OTHERS), max_size=40)
BEGIN = ["G90", "; printing object one (x) id:0 copy 0", ";TYPE:External perimeter"]


@settings(max_examples=40)
@given(lines=PROGRAMS, block=st.sampled_from([64, 4 << 20]))
def test_it_finds_what_a_plain_parser_finds(tmp_path_factory, lines, block):
    text = "\n".join([*BEGIN, *lines])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reading, "_BLOCK", block)  # lines are cut by the ends of small blocks
        plate = read(tmp_path_factory.getbasetemp() / "any.gcode", text)
    found = {each.name: each.body for each in (*plate.objects, plate.apart)}
    found |= {f"{each.name}+": each.supports for each in (*plate.objects, plate.apart)}
    expected = PlainParser().read(text)
    assert {name for name, body in found.items() if not body.is_empty} == set(expected)
    for name, track in expected.items():
        points, tops = np.array(track["points"]), track["tops"]
        body = found[name]
        assert body.low == pytest.approx(points.min(axis=0), abs=1e-6)
        assert body.high == pytest.approx(points.max(axis=0), abs=1e-6)
        assert body.length == pytest.approx(track["length"], rel=1e-9)
        assert body.layers == len(tops)
        assert body.thickest == pytest.approx(max(track["thick"][1:], default=0.0), abs=1e-9)


@pytest.mark.parametrize(
    ("arc", "low", "high", "sweep"),
    [
        ("G3 X0 Y10 I-10 J0 E1", (0.0, 0.0), (10.0, 10.0), math.pi / 2),
        ("G2 X0 Y10 I-10 J0 E1", (-10.0, -10.0), (10.0, 10.0), 3 * math.pi / 2),
        ("G2 I-10 J0 E1", (-10.0, -10.0), (10.0, 10.0), 2 * math.pi),
        ("G3 X0 Y10 R10 E1", (0.0, 0.0), (10.0, 10.0), math.pi / 2),
        ("G3 X0 Y10 R-10 E1", (0.0, 0.0), (20.0, 20.0), 3 * math.pi / 2),
        ("G2 X0 Y10 R10 E1", (0.0, 0.0), (10.0, 10.0), math.pi / 2),
    ],
)
def test_an_arc_has_the_extent_and_length_of_its_circle(tmp_path, arc, low, high, sweep):
    text = "\n".join([*BEGIN, ";WIDTH:0.4", "M83", "G1 X10 Y0 Z0.2", arc])
    body = read(tmp_path / "arc.gcode", text).objects[0].body
    assert body.low[:2] == pytest.approx(np.array(low) - 0.2, abs=0.02)
    assert body.high[:2] == pytest.approx(np.array(high) + 0.2, abs=0.02)
    assert body.length == pytest.approx(10 * sweep, rel=0.002)


def test_the_lines_of_the_layers_at_given_heights_are_kept(tmp_path):
    layers = [
        f"G1 X0 Y0 Z{z}\nG1 X{10 * z} E1\n;TYPE:Solid infill\nG1 X5 Y5 E1\n;TYPE:Perimeter"
        for z in (0.2, 0.9, 1.1, 2)
    ]
    samples = read(tmp_path / "a.gcode", "\n".join([*BEGIN, "M83", *layers])).objects[0].body.samples
    assert [(each.z, round(each.thickness, 6)) for each in samples] == [(0.2, 0.2), (1.1, 0.2)]
    assert samples[1].lines[:, :4].tolist() == [pytest.approx([0.0, 0.0, 11.0, 0.0])]  # without infill


def test_a_layer_above_a_gap_is_as_thick_as_the_layers_of_others_there(tmp_path):
    def line(z, name):
        return f"; printing object {name} id:0 copy 0\nG1 X0 Z{z:.1f}\nG1 X9 E1"

    both = [line(z / 5, name) for z in range(1, 30) for name in "ab" if name == "a" or not 9 < z < 20]
    objects = read(tmp_path / "a.gcode", "\n".join([*BEGIN, "M83", *both])).objects
    assert [round(each.body.thickest, 6) for each in objects] == [0.2, 0.2]
    assert [each.body.layers for each in objects] == [29, 19]


def test_a_letter_without_a_number_is_no_word(tmp_path):
    text = "\n".join([*BEGIN, "G1 X10 Z0.2 E5", "G92 E-1", "G1 X0 Y{machine_depth} ; present"])
    assert read(tmp_path / "a.gcode", text).objects[0].body.length == pytest.approx(10.0)


def test_a_numbered_line_with_a_check_sum_is_read(tmp_path):
    text = "\n".join([*BEGIN, "N1 M83", "N2 G1 X10 Z0.2 E1*71", "N3 ; printing object two id:1 copy 0"])
    assert read(tmp_path / "a.gcode", text).objects[0].body.length == pytest.approx(10.0)
