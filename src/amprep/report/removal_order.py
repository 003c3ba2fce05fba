"""State in words how the parts of a build can be taken out, and which of them are locked into each other."""

import math
from collections.abc import Sequence
from typing import Any

from amprep.geometry.removal.order import RemovalStep
from amprep.geometry.removal.paths import Motion
from amprep.model.counting import counted
from amprep.report.record import BuildRecord

MOST_NAMES = 6
"""Parts of a group that a sentence names."""


def removal_summary(entry: BuildRecord) -> str:
    """Return in a few words how the parts of a build leave."""
    order = entry.removal_order
    if order.locked:
        return f"{counted(len(order.locked), 'group')} of parts locked into each other"
    if order.unknown:
        return "stopped before the order was known"
    upwards = all(len(step.path) == 1 and step.path[0][0] == (0.0, 0.0, 1.0) for step in order.steps)
    return "all parts can be taken out upwards" if upwards else "all parts can be taken out"


def hindrances_of(entry: BuildRecord) -> list[str]:
    """Return one sentence without a full stop for each group of parts that are locked, and for parts not judged."""
    order = entry.removal_order
    reason = "no motion without a turn was found that separates them"
    lines = [f"{_names(entry, group)} are locked into each other: {reason}" for group in order.locked]
    if order.unknown:
        lines.append(f"stopped before it was known how {_names(entry, order.unknown)} can be taken out")
    return lines


def waiting_parts(entry: BuildRecord) -> list[str]:
    """Return one sentence without a full stop for each part that can be lifted off only after others."""
    return [
        f"{_names(entry, step.bodies)} can be lifted off only after {_names(entry, step.after)}"
        for step in entry.removal_order.steps
        if step.after
    ]


def removal_rows(entry: BuildRecord) -> list[tuple[str, str, str]]:
    """Return for each step its parts, the motions, and the parts that must leave before."""
    return [
        (
            _names(entry, step.bodies) + (f" (from {_names(entry, step.within)})" if step.within else ""),
            motions_in_words(step.path),
            _names(entry, step.after or ()),
        )
        for step in entry.removal_order.steps
    ]


def motions_in_words(path: Sequence[Motion]) -> str:
    """Return motions as words, for example ``4.5 mm along -y, then upwards``."""
    return ", then ".join(
        _direction(direction) if math.isinf(length) else f"{length:.1f} mm {_direction(direction)}"
        for direction, length in path
    )


def removal_order_json(entry: BuildRecord) -> dict[str, Any]:
    """Return the steps, the groups of locked parts, and the parts not judged, by their names."""
    order = entry.removal_order
    return {
        "steps": [_step(entry, step) for step in order.steps],
        "locked": [_labels(entry, group) for group in order.locked],
        "unknown": _labels(entry, order.unknown),
    }


def _step(entry: BuildRecord, step: RemovalStep) -> dict[str, Any]:
    return {
        "parts": _labels(entry, step.bodies),
        "path": [{"direction": list(direction), "length_mm": length} for direction, length in step.path],
        "within": _labels(entry, step.within),
        "after": None if step.after is None else _labels(entry, step.after),
    }


def _direction(direction: Sequence[float]) -> str:
    """Return a direction as words, such as ``upwards`` or ``along +x -y and upwards``."""
    x, y, z = direction
    sideways = " ".join(f"{'+' if value > 0 else '-'}{axis}" for axis, value in (("x", x), ("y", y)) if value)
    vertical = "upwards" if z > 0 else "downwards" if z < 0 else ""
    return " and ".join(words for words in (f"along {sideways}" if sideways else "", vertical) if words)


def _labels(entry: BuildRecord, parts: Sequence[int]) -> list[str]:
    return [entry.build.parts[part].label for part in parts]


def _names(entry: BuildRecord, parts: Sequence[int]) -> str:
    labels = _labels(entry, parts[:MOST_NAMES])
    more = len(parts) - len(labels)
    listed = [*labels, f"{more} more"] if more > 0 else labels
    return " and ".join(filter(None, (", ".join(listed[:-1]), *listed[-1:])))
