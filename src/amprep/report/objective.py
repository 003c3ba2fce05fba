"""State the objective that a packing reached, its bound and gap, and the value of each part of a fill problem."""

import math
from collections import Counter
from dataclasses import dataclass

from amprep.measures.objective import relative_gap
from amprep.model.counting import counted
from amprep.report.record import RunRecord

ROUNDING = 1e-9
"""Gap that is rounding."""

EXACT = 5e-4
"""Excess of convex pieces below which it is 0.0 % when rounded."""


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
    parts = record.bound_for == "shapes" or _is_best_of_parts(record)
    return "packing optimal" if parts else f"packing optimal for the {record.packed_as}"


def step_words(record: RunRecord) -> str:
    """Return what each step of the packer reached, and how long it took; empty for a packer without steps."""
    return "; ".join(
        f"{method}: {reached}{'' if record.objective == 'height' else f', {height} high'} in {seconds}"
        for method, reached, height, seconds in step_rows(record)
    )


def step_rows(record: RunRecord) -> list[tuple[str, str, str, str]]:
    """Return what the steps of the packer did, what they reached, the height, and the duration, in words."""
    return [
        (step.method, _amount_reached(record, step.reached), f"{step.height:.1f} mm", f"{step.seconds:.1f} s")
        for step in record.steps
    ]


def excess_words(record: RunRecord) -> str:
    """Return by how much the convex pieces that were packed are larger than the parts; empty without such pieces."""
    parts = [placed.part for entry in record.builds for placed in entry.build.parts]
    packed = [part for part in parts if part.name in record.excess]
    total = sum(part.volume_mm3 for part in packed)
    if not total > 0.0:
        return ""
    wasted = sum(record.excess[part.name] * part.volume_mm3 for part in packed)
    worst = max(packed, key=lambda part: record.excess[part.name])
    most = record.excess[worst.name]
    if most < EXACT:
        return "packed as convex pieces as large as the parts"
    words = f"packed as convex pieces {100.0 * wasted / total:.1f} % larger than the parts"
    return f"{words}; most: {worst.name}, {100.0 * most:.1f} %"


def objective_words(record: RunRecord) -> str:
    """Return what the packing reached and what its bound bounds; empty if nothing was packed, or for a single build.

    The number of builds is not repeated: it is in the line before.
    """
    if record.reached is None:
        return ""
    best = _is_best_of_parts(record)
    if record.objective == "builds":
        return "" if best and record.reached <= 1.0 else _bound(record)
    return f"{_amount_reached(record, record.reached)}, {_bound(record)}{'' if best else _gap(record)}"


def _amount_reached(record: RunRecord, reached: float) -> str:
    """Return a value of the objective in words."""
    match record.objective:
        case "fill":
            return f"value {amount(reached)} of {amount(total_value(record))}"
        case "height":
            return f"height {reached:.2f} mm"
        case _:
            return counted(round(reached), "build")


def amount(value: float) -> str:
    """Return a value with six digits, or all digits before the point if there are more."""
    return f"{value:,.0f}" if abs(value) >= 1e5 else f"{value:,.6g}"


def _bound(record: RunRecord) -> str:
    """Return what the bounds bound, and for which packings."""
    if _is_best_of_parts(record):
        return "no packing of the parts " + {"fill": "has more", "height": "is lower"}.get(
            record.objective, "has fewer builds"
        )
    words = []
    parts = record.bound if record.bound_for == "shapes" else record.parts_bound
    proved = record.status == "optimal" and parts is not None  # which the status says
    if record.bound is not None and record.bound_for == "volumes" and not proved:
        words.append(_none_better(record, record.packed_as, record.bound))
    if parts is not None:
        words.append(_none_better(record, "parts", parts))
    return "; ".join(words) or "no bound known"


def _none_better(record: RunRecord, packed: str, bound: float) -> str:
    """Return what a bound bounds."""
    match record.objective:
        case "fill":
            return f"no packing of the {packed} has more than {amount(bound)}"
        case "height":
            return f"no packing of the {packed} is lower than {bound:.2f} mm"
        case _:
            least = counted(math.ceil(bound - ROUNDING), "build")
            return f"no packing of the {packed} has fewer than {least}"


def _is_best_of_parts(record: RunRecord) -> bool:
    """Return whether the packing is complete and meets the bound for the parts themselves."""
    bound = record.bound if record.bound_for == "shapes" else record.parts_bound
    if bound is None or record.reached is None or (record.unplaced and record.objective != "fill"):
        return False
    gap = relative_gap(record.objective, record.reached, bound)
    return gap is not None and gap <= ROUNDING


def _gap(record: RunRecord) -> str:
    gap = gap_of(record)
    return "" if gap is None else f", gap {100 * gap:.1f} %"
