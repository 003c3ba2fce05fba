"""Terminal, JSON and HTML say what a packing reached, what its bound bounds, the gap, and the value of parts."""

from dataclasses import replace
from io import StringIO

import pytest
from rich.console import Console

from amprep.model.packing import PackingStep
from amprep.report.json_report import to_json
from amprep.report.objective import amount, gap_of, objective_words, part_values, total_value
from amprep.report.page.html import html_text
from amprep.report.record import BuildRecord, RunRecord, UnplacedRecord
from amprep.report.terminal import summary


@pytest.fixture
def filled(make_build) -> RunRecord:
    """A fill problem: a build of parts, and two copies of a crane of value 30 that are left."""
    left = tuple(UnplacedRecord("crane", copy, "no room left", 30.0) for copy in (1, 2))
    build = make_build()
    placed = sum(placed.part.fill_value for placed in build.parts)
    return RunRecord(
        "job", "1", 0, "MK4", "generic", (BuildRecord(build),), left,
        objective="fill", reached=placed, bound=1.25 * placed,
    )  # fmt: skip


def printed(record):
    console = Console(width=200, record=True, file=StringIO())
    console.print(summary(record))
    return console.export_text()


def test_a_fill_run_tells_value_bound_gap_and_the_value_of_each_part_everywhere(filled):
    placed = filled.reached
    words = (
        f"value {amount(placed)} of {amount(placed + 60)}, no packing of the bounding volumes has "
        f"more than {amount(1.25 * placed)}"
    )
    assert objective_words(filled) == f"{words}, gap 25.0 %"
    assert total_value(filled) == pytest.approx(placed + 60)
    text, page, report = printed(filled), html_text(filled), to_json(filled)
    assert words in text
    assert words in page
    assert "crane: 0 of 2 placed, value 30 each" in text
    assert (report["reached"], report["gap"]) == (placed, pytest.approx(0.25))
    assert report["total_value"] == pytest.approx(placed + 60)
    assert [each["value"] for each in report["unplaced"]] == [30.0, 30.0]
    assert sum(part["value"] for part in report["builds"][0]["parts"]) == pytest.approx(placed)


def test_the_copies_of_a_part_are_counted_together(filled):
    crane = part_values(filled)[-1]
    assert (crane.name, crane.value, crane.placed, crane.copies) == ("crane", 30.0, 0, 2)


@pytest.mark.parametrize(
    ("objective", "reached", "bound", "words"),
    [
        ("builds", 3.0, 2.0, "no packing of the bounding volumes has fewer than 2 builds"),
        ("builds", 1.0, None, "no bound known"),
        (
            "height",
            50.0,
            40.0,
            "height 50.00 mm, no packing of the bounding volumes is lower than 40.00 mm, gap 20.0 %",
        ),
        ("fill", None, None, ""),
    ],
)
def test_other_objectives_say_what_their_bound_bounds(filled, objective, reached, bound, words):
    record = replace(filled, objective=objective, reached=reached, bound=bound)
    assert objective_words(record) == words
    assert part_values(record) == ()
    assert (gap_of(record) is None) == (bound is None)
    assert html_text(record)


def test_a_bound_names_the_parts_where_it_is_for_any_packing_of_them(filled):
    record = replace(filled, objective="builds", reached=3.0, bound=2.0, bound_for="shapes")
    assert objective_words(record) == "no packing of the parts has fewer than 2 builds"
    assert to_json(record)["bound_for"] == "shapes"


@pytest.mark.parametrize(
    ("status", "bound_for", "words"),
    [
        ("feasible", "volumes", "packing feasible (time limit)"),
        ("optimal", "volumes", "packing optimal for the bounding volumes"),
        ("optimal", "shapes", "packing optimal"),
    ],
)
def test_a_stop_reason_is_shown_only_where_the_packing_is_not_optimal(filled, status, bound_for, words):
    record = replace(filled, status=status, stop_reason="time limit", bound_for=bound_for)
    assert f"{words};" in printed(record).replace(":", ";")
    assert f"{words} ·" in html_text(record)


def test_a_bound_for_boxes_is_beside_the_one_for_the_parts(filled):
    boxes = replace(
        filled,
        objective="builds",
        reached=3.0,
        bound=3.0,
        parts_bound=2.0,
        packed_as="enclosing boxes",
        unplaced=(),
    )
    optimal = replace(boxes, status="optimal")
    words = "packing optimal for the enclosing boxes: no packing of the parts has fewer than 2 builds"
    assert words in printed(optimal)
    assert words.capitalize() in html_text(optimal)
    assert to_json(optimal)["parts_bound"] == 2.0
    searched = replace(boxes, reached=4.0)
    assert objective_words(searched) == (
        "no packing of the enclosing boxes has fewer than 3 builds; no packing of the parts has fewer than 2 builds"
    )
    best = replace(optimal, reached=2.0, bound=2.0)
    assert "packing optimal: no packing of the parts has fewer builds;" in printed(best)
    single = replace(best, reached=1.0, bound=1.0, parts_bound=1.0)
    assert "packing optimal; seed" in printed(single)
    assert "<p>Packing optimal.</p>" in html_text(single)


def test_the_steps_of_a_packer_are_shown_with_what_they_gained(filled):
    steps = (PackingStep("enclosing boxes", 3.0, 120.0, 0.1), PackingStep("true shapes", 2.0, 90.5, 8.0))
    record = replace(filled, objective="builds", reached=2.0, steps=steps)
    words = "enclosing boxes: 3 builds, 120.0 mm high in 0.1 s; true shapes: 2 builds, 90.5 mm high in 8.0 s"
    assert words in printed(record)
    assert "true shapes" in html_text(record)
    assert [each["reached"] for each in to_json(record)["steps"]] == [3.0, 2.0]


def test_what_convex_pieces_cost_is_said_in_all_and_for_the_worst_part(filled):
    parts = {placed.part.name: placed.part for entry in filled.builds for placed in entry.build.parts}
    copies = [placed.part for entry in filled.builds for placed in entry.build.parts]
    excess = {name: 0.05 * (k + 1) for k, name in enumerate(parts)}
    whole = sum(part.volume_mm3 for part in copies)
    larger = sum((1.0 + excess[part.name]) * part.volume_mm3 for part in copies)
    record, worst = replace(filled, excess=excess), list(parts)[-1]
    words = f"convex pieces {100 * (larger / whole - 1):.1f} % larger than the parts"
    words = f"{words}; most: {worst}, {100 * excess[worst]:.1f} %"
    assert words in printed(record)
    assert words in html_text(record)
    assert to_json(record)["excess"] == excess
    exact = replace(filled, excess=dict.fromkeys(parts, 0.0))
    assert "packed as convex pieces as large as the parts" in printed(exact)
    assert "convex pieces" not in printed(filled)
    assert "convex pieces" not in printed(replace(filled, builds=(), excess=excess))


def test_large_values_keep_all_digits_before_the_point():
    assert [amount(value) for value in (1234567.8, 99999.5, 0.125, 0.0)] == [
        "1,234,568",
        "99,999.5",
        "0.125",
        "0",
    ]
