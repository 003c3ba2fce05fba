"""The packing in the HTML report: key figures, what bounds it, steps of the packer, and values of parts."""

from html import escape

from amprep.report.objective import (
    amount,
    excess_words,
    gap_of,
    objective_words,
    part_values,
    status_words,
    step_rows,
    total_value,
)
from amprep.report.page.cells import Cell, table
from amprep.report.record import RunRecord

_BOUNDS = {
    "fill": "Bound on the value",
    "height": "Bound on the height",
    "builds": "Bound on the builds",
}
"""Objective -> heading of its bound."""


def objective_figures(record: RunRecord) -> list[tuple[str, str, bool]]:
    """Return the objective that was reached, its bound and the gap, as headings, HTML, and whether it is a fault."""
    if record.reached is None:
        return []
    unit = {"fill": "", "height": " <small>mm</small>", "builds": ""}[record.objective]
    known = record.bound if record.parts_bound is None else record.parts_bound
    bound = "unknown" if known is None else amount(known) + unit
    found = {
        "fill": [
            ("Value placed", f"{amount(record.reached)} <small>of {amount(total_value(record))}</small>")
        ],
        "height": [("Packing height", f"{amount(record.reached)}{unit}")],
        "builds": [],
    }[record.objective]
    found.append((_BOUNDS[record.objective], bound))
    gap = gap_of(record)
    if gap is not None and record.objective != "builds":
        found.append(("Gap to the bound", f"{100 * gap:.1f} <small>%</small>"))
    return [(name, value, False) for name, value in found]


def packing_section(record: RunRecord) -> str:
    """Return what the packing reached, what its bounds bound, the excess of pieces, and the steps of the packer."""
    found = filter(None, (status_words(record).capitalize(), objective_words(record)))
    words = "" if record.reached is None else ": ".join(found)
    steps: list[tuple[Cell, ...]] = [
        (name, *(("number", each) for each in figures)) for name, *figures in step_rows(record)
    ]
    headings = ("Step", "Reached|", "Height|", "Duration|")
    pieces = excess_words(record)
    sentences = [found for found in (words, pieces[:1].upper() + pieces[1:]) if found]
    return "".join(f"<p>{escape(found)}.</p>" for found in sentences) + (
        table(headings, steps) if steps else ""
    )


def values_section(record: RunRecord) -> str:
    """Return the table of values of the parts; empty unless the objective is fill."""
    rows = [
        (
            each.name,
            ("number", amount(each.value)),
            each.placed,
            each.copies,
            ("number", amount(each.value * each.placed)),
        )
        for each in part_values(record)
    ]
    headings = ("Part", "Value of a copy|", "Copies placed|", "Copies|", "Value placed|")
    return table(headings, rows) if rows else ""
