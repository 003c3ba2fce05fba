"""State the objective that a packing reached, its bound and gap, and the value of each part of a fill problem."""

from collections import Counter
from dataclasses import dataclass

from amprep.measures.objective import relative_gap
from amprep.model.counting import counted
from amprep.report.record import RunRecord


@dataclass(frozen=True)
class PartValue:
    """The value of one copy of a part, and how many of its copies are placed."""

    name: str
    value: float
    placed: int
    copies: int


def part_values(record: RunRecord) -> tuple[PartValue, ...]:
    """Return the value of each part of a fill problem, in the order of the builds; empty for other objectives."""
    if record.objective != "fill" or record.reached is None:
        return ()
    parts = [placed.part for entry in record.builds for placed in entry.build.parts]
    placed, left = Counter(part.name for part in parts), Counter(each.name for each in record.unplaced)
    values = {part.name: part.fill_value for part in parts} | {
        each.name: each.value for each in record.unplaced
    }
    return tuple(
        PartValue(name, value, placed[name], placed[name] + left[name]) for name, value in values.items()
    )


def total_value(record: RunRecord) -> float:
    """Return the value of all copies, placed or not."""
    return sum(each.value * each.copies for each in part_values(record))


def gap_of(record: RunRecord) -> float | None:
    """Return the gap to the bound as a fraction of what was reached; None if it is not known."""
    return None if record.reached is None else relative_gap(record.objective, record.reached, record.bound)


def status_words(record: RunRecord) -> str:
    """Return the status of the packing; why it ended, unless it is optimal; and for what it is optimal."""
    if record.status != "optimal":
        return f"packing {record.status} ({record.stop_reason})"
    return "packing optimal" if record.bound_for == "shapes" else "packing optimal for the bounding volumes"


def objective_words(record: RunRecord) -> str:
    """Return what the packing reached and what its bound bounds; empty if nothing was packed."""
    if record.reached is None:
        return ""
    match record.objective:
        case "fill":
            reached = f"value {amount(record.reached)} of {amount(total_value(record))}"
        case "height":
            reached = f"height {record.reached:.2f} mm"
        case _:
            return f"{counted(round(record.reached), 'build')}, {_bound(record)}"
    return f"{reached}, {_bound(record)}{_gap(record)}"


def amount(value: float) -> str:
    """Return a value with six digits, or all digits before the point if there are more."""
    return f"{value:,.0f}" if abs(value) >= 1e5 else f"{value:,.6g}"


def _bound(record: RunRecord) -> str:
    """Return what the bound bounds, and for which packings."""
    if record.bound is None:
        return "no bound known"
    packing = f"no packing of the {'parts' if record.bound_for == 'shapes' else 'bounding volumes'}"
    match record.objective:
        case "fill":
            return f"{packing} has more than {amount(record.bound)}"
        case "height":
            return f"{packing} is lower than {record.bound:.2f} mm"
        case _:
            return f"{packing} has fewer than {record.bound:g}"


def _gap(record: RunRecord) -> str:
    gap = gap_of(record)
    return "" if gap is None else f", gap {100 * gap:.1f} %"
