"""Planted faults: whatever a slicer prints differently is named with its object, and an honest plate passes."""

import re
from dataclasses import replace

import numpy as np
import pytest
from manifold3d import CrossSection
from tests.shared.gcode import L_PRISMS, Prism, Slicer, build_of, prepared

from amprep.checks.gcode import bed, matching, sections, slicing
from amprep.checks.gcode.judge import NOT_JUDGED, NUMBER, POSITION, SHAPE, SIZE, judge_gcode
from amprep.errors import InputError
from amprep.model import PlacedPart
from amprep.model.mesh import join_meshes
from amprep.model.supports.rules import SupportRules
from amprep.slicers.gcode.read import read_gcode, read_head
from amprep.threemf.build.identifier import title_of

HEIGHTS = np.linspace(0.01, 5.9, 6)
CENTRE = np.array([15.0, 10.0])


def judged(path, build, title, gcode):
    path.write_text(gcode, encoding="utf-8")
    return judge_gcode(build, read_gcode(path, read_head(path), HEIGHTS), [title])


def verdict_of(path, slicer, printed=L_PRISMS, **settings):
    build, title = prepared(**settings)
    return judged(path, build, title, slicer.gcode(printed, title))


def faults(verdict):
    return [(each.promise, each.subject) for each in verdict.violations]


def test_an_honest_plate_passes(tmp_path):
    verdict = verdict_of(tmp_path / "a.gcode", Slicer())
    assert verdict.ok
    assert not any(words.startswith(NOT_JUDGED) for words in list(verdict.extent.values())[:6])
    assert [label for label, _ in verdict.pairs] == ["bracket", "bracket-2"]


def of_the_first(change):
    """Change the object that is at (20, 20), about the centre of its box."""

    def changed(points):
        if points[:, 0].max() > 60:
            return points
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        return change(points - middle) + middle

    return changed


TURN = np.array([[0.0, 1.0], [-1.0, 0.0]])
PLANTED = {
    "moved": (lambda p: p + [0.0, 3.0], POSITION, r"moved by \(0, 3\) mm"),
    "moved a little": (lambda p: p + [0.45, 0.0], POSITION, r"moved by \(0.45, 0\) mm"),
    "mirrored in x": (lambda p: p * [-1, 1], SHAPE, "mirrored in x"),
    "mirrored in y": (lambda p: p * [1, -1], SHAPE, "mirrored in y"),
    "turned half": (lambda p: -p, SHAPE, "turned by 180 degrees"),
    "turned a quarter": (lambda p: p @ TURN, SHAPE, "turned by 90 degrees"),
    "stretched": (lambda p: p * [1.1, 1.0], SIZE, "its size is 33.00 x 20.00 x 6.00 mm"),
}


@pytest.mark.parametrize("name", PLANTED)
def test_a_changed_object_is_named_with_what_happened_to_it(tmp_path, name):
    change, promise, words = PLANTED[name]
    verdict = verdict_of(tmp_path / "a.gcode", Slicer(change=of_the_first(change)))
    assert faults(verdict) == [(promise, "bracket")]
    assert re.search(words, verdict.violations[0].message)


@pytest.mark.parametrize("by", [(0.2, 0.0), (0.0, -0.2)])
def test_what_rounding_and_widths_of_lines_do_is_no_fault(tmp_path, by):
    assert verdict_of(tmp_path / "a.gcode", Slicer(change=lambda points: points + by)).ok


def test_a_scaled_plate_is_named_as_scaled(tmp_path):
    verdict = verdict_of(tmp_path / "a.gcode", Slicer(change=lambda points: points * 1.05, stretch=1.05))
    assert faults(verdict) == [(SIZE, "bracket"), (SIZE, "bracket-2")]
    assert all("scaled by 1.0" in each.message for each in verdict.violations)


def test_an_object_that_is_too_low_is_named_with_its_height(tmp_path):
    verdict = verdict_of(tmp_path / "a.gcode", Slicer(stretch=0.5))
    assert [each.message for each in verdict.violations] == ["it is 3.00 mm high, prepared were 6.00 mm"] * 2


def test_an_object_that_the_slicer_set_on_the_bed_is_named_as_lower(tmp_path):
    build, title = prepared()
    lifted = np.eye(4)
    lifted[2, 3] = 3.0
    parts = tuple(PlacedPart(each.label, each.part, lifted) for each in build.parts)
    verdict = judged(
        tmp_path / "a.gcode", replace(build, parts=parts), title, Slicer().gcode(L_PRISMS, title)
    )
    assert faults(verdict) == [(POSITION, "bracket"), (POSITION, "bracket-2")]
    assert "it is 3.00 mm lower than prepared" in verdict.violations[0].message


def test_a_missing_object_is_named(tmp_path):
    verdict = verdict_of(tmp_path / "a.gcode", Slicer(), printed=L_PRISMS[:1])
    assert faults(verdict) == [(NUMBER, "bracket-2")]


def test_a_further_object_is_named(tmp_path):
    other = Prism("stranger", ((0, 0), (9, 0), (9, 9), (0, 9)), 2.0, (150.0, 100.0))
    verdict = verdict_of(tmp_path / "a.gcode", Slicer(), printed=(*L_PRISMS, other))
    assert [each.promise for each in verdict.violations] == [NUMBER]
    assert "stranger" in verdict.violations[0].subject


def test_two_objects_that_changed_places_are_both_named(tmp_path):
    first, second = L_PRISMS
    swapped = (replace(first, at=second.at), replace(second, at=first.at))
    verdict = verdict_of(tmp_path / "a.gcode", Slicer(), printed=swapped)
    assert faults(verdict) == [(POSITION, "bracket"), (POSITION, "bracket-2")]


def test_a_missing_piece_of_an_object_is_a_fault_of_its_shape(tmp_path):
    ring = Prism("ring", ((0, 0), (40, 0), (40, 40), (0, 40)), 4.0, (20.0, 20.0))
    notched = replace(
        ring, corners=((0, 0), (40, 0), (40, 40), (22, 40), (22, 20), (18, 20), (18, 40), (0, 40))
    )
    build, title = prepared((ring,))
    verdict = judged(tmp_path / "a.gcode", build, title, Slicer().gcode((notched,), title))
    assert faults(verdict) == [(SHAPE, "ring")]
    assert "of its lines are where no wall was prepared" in verdict.violations[0].message


def test_what_the_build_has_not_is_a_fault_of_its_shape(tmp_path):
    ring = Prism("ring", ((0, 0), (40, 0), (40, 40), (0, 40)), 4.0, (20.0, 20.0))
    notched = replace(
        ring, corners=((0, 0), (40, 0), (40, 40), (22, 40), (22, 20), (10, 20), (10, 40), (0, 40))
    )
    build, title = prepared((notched,))
    verdict = judged(tmp_path / "a.gcode", build, title, Slicer().gcode((ring,), title))
    assert faults(verdict) == [(SHAPE, "ring")]


def test_a_gap_that_slicers_close_is_no_fault(tmp_path):
    whole = Prism("plate", ((0, 0), (40, 0), (40, 40), (0, 40)), 4.0, (20.0, 20.0))
    left = replace(whole, corners=((0, 0), (19.98, 0), (19.98, 40), (0, 40)))
    right = replace(whole, corners=((20.02, 0), (40, 0), (40, 40), (20.02, 40)))
    halves = build_of((left, right))
    mesh = join_meshes([each.mesh for each in halves.parts])
    [first, _] = halves.parts
    build = replace(halves, parts=(replace(first, part=replace(first.part, mesh=mesh)),))
    title = title_of(build)
    assert judged(tmp_path / "a.gcode", build, title, Slicer().gcode((whole,), title)).ok


def test_supports_of_the_slicer_are_named_with_their_object(tmp_path):
    begin = Slicer().begin + ";TYPE:Support material\nG1 X25 Y25\nG1 X45 Y25 E1\n"
    verdict = verdict_of(tmp_path / "a.gcode", Slicer(begin=begin))
    assert faults(verdict) == [(slicing.OWN_SUPPORTS, "bracket"), (slicing.OWN_SUPPORTS, "bracket-2")]


def test_supports_outside_of_all_labels_are_found_too(tmp_path):
    extra = ";TYPE:Support material\nG1 X25 Y25\nG1 X90 Y25 E1\n"
    assert faults(verdict_of(tmp_path / "a.gcode", Slicer(extra=extra))) == [
        (slicing.OWN_SUPPORTS, "the plate")
    ]


def test_an_object_beyond_the_bed_is_named(tmp_path):
    verdict = verdict_of(tmp_path / "a.gcode", Slicer(tail="; bed_shape = 0x0,60x0,60x60,0x60\n"))
    assert faults(verdict) == [(bed.PROMISE, "bracket-2")]


ROUND = [(60 + 40.6 * np.cos(angle), 30 + 40.6 * np.sin(angle)) for angle in np.linspace(0, 2 * np.pi, 300)]
STEPPED = [(0, 0), (0, 60), (120, 60), (120, 0), (80, 0), (80, -5), (40, -5), (40, 0)]
NOTCHED = [(0, 0), (60, 0), (60, 15), (105, 15), (105, 45), (90, 45), (90, 30), (80, 30), (80, 45), (0, 45)]


@pytest.mark.parametrize(
    ("shape", "beyond"),
    [
        pytest.param(ROUND, ["bracket", "bracket-2"], id="corners are outside of the circle"),
        pytest.param([(60 + 1.1 * (x - 60), y) for x, y in ROUND], [], id="all corners are in the ellipse"),
        pytest.param(STEPPED, [], id="a step in front"),
        pytest.param(NOTCHED, [], id="a notch that the L encloses"),
        pytest.param([(x, y - 3) for x, y in NOTCHED], ["bracket-2"], id="the outline crosses the notch"),
    ],
)
def test_beds_of_any_shape_are_judged_by_what_is_printed(tmp_path, shape, beyond):
    """Both brackets are an L of 30 x 20 mm with arms of 8 mm, with their corners at (20, 20) and (70, 20)."""
    outline = ",".join(f"{x:.5f}x{y:.5f}" for x, y in shape)
    verdict = verdict_of(tmp_path / "a.gcode", Slicer(tail=f"; bed_shape = {outline}\n"))
    assert faults(verdict) == [(bed.PROMISE, each) for each in beyond]


def test_on_a_bed_of_another_origin_the_build_lies_centred(tmp_path):
    tail = "; bed_shape = -125x-105,125x-105,125x105,-125x105\n"
    verdict = verdict_of(tmp_path / "a.gcode", Slicer(change=lambda points: points - [125, 105], tail=tail))
    assert verdict.ok
    assert "from the corner of the bed, moved by (-125, -105) mm" in verdict.extent[POSITION]


@pytest.mark.parametrize(("layer", "count"), [(0.2, 0), (0.3, 1)])
def test_layers_thicker_than_supports_were_planned_for_are_a_fault(tmp_path, layer, count):
    rules = SupportRules(rules="limits", layer_mm=0.2)
    verdict = verdict_of(tmp_path / "a.gcode", Slicer(layer=layer), rules=rules)
    assert [each.promise for each in verdict.violations] == [slicing.LAYER_HEIGHT] * count


def test_without_labels_the_plate_is_judged_as_a_whole(tmp_path):
    verdict = verdict_of(tmp_path / "a.gcode", Slicer(begin="", end=""))
    assert verdict.ok
    assert verdict.extent[NUMBER].startswith(NOT_JUDGED)
    moved = verdict_of(
        tmp_path / "a.gcode", Slicer(begin="", end="", change=of_the_first(lambda p: p + [0, 3.0]))
    )
    assert [each.subject for each in moved.violations] == ["the whole plate"]


def test_objects_with_numbers_instead_of_names_are_found_by_their_places(tmp_path):
    slicer = Slicer(
        begin="; start printing object, unique label id: {number}\n",
        end="; stop printing object, unique label id: {number}\n",
        feature="; FEATURE: Outer wall\n",
    )
    verdict = verdict_of(tmp_path / "a.gcode", slicer)
    assert verdict.ok
    assert [label for label, _ in verdict.pairs] == ["bracket", "bracket-2"]


def test_copies_that_a_slicer_shows_as_instances_have_one_name(tmp_path):
    build = build_of(L_PRISMS[:1])
    aside = np.eye(4)
    aside[0, 3] = 50.0
    [first] = build.parts
    build = replace(build, parts=(first, PlacedPart("bracket-2", first.part, aside)))
    copies = (L_PRISMS[0], replace(L_PRISMS[1], label="bracket"))
    assert judged(tmp_path / "a.gcode", build, "job", Slicer().gcode(copies, "job")).ok


def test_more_objects_than_can_be_matched_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(matching, "MOST_PAIRS", 3)
    with pytest.raises(InputError, match="prints 2 objects and the build has 2: more than 3 pairs"):
        verdict_of(tmp_path / "a.gcode", Slicer())


def test_a_section_with_long_outlines_gets_few_points(monkeypatch):
    section = CrossSection([[(0, 0), (4000, 0), (4000, 4000), (0, 4000)]])
    monkeypatch.setattr(sections, "_MOST_POINTS", 100)
    assert 100 <= len(sections._points_of(section)) <= 110
