"""What was planned again in an edited build, in words and as JSON."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from amprep import __version__
from amprep.checks.violation import Violation
from amprep.model import Unsupported
from amprep.model.counting import counted
from amprep.model.summary import Summarised
from amprep.report.json_values import plain, stages_json, violations_json
from amprep.report.record import StageTime
from amprep.report.terminal import printable

if TYPE_CHECKING:
    from rich.console import RenderableType

FORMAT = 1
"""Version of the JSON; it increases when a key changes its meaning or is removed."""

PartChange = Literal["none", "moved", "turned", "copied", "added"]
"""What happened to a part of an edited build."""

SupportsOf = Literal["kept", "taken along", "planned again", "none needed", "not planned"]
"""What happened to the supports of a part."""

_MOST_LINES = 40
"""Lines of the closing list; the JSON has all."""


@dataclass(frozen=True)
class ReplannedPart:
    """A part of an edited build.

    Attributes
    ----------
    label
        Its name in the build.
    change
        What was done to it.
    moved_mm, turned_deg
        Largest distance that one of its points moved, and angle of its rotation.
    supports
        What became of its supports.
    reason
        Why they were planned again; empty if they were not.
    """

    label: str
    change: PartChange
    moved_mm: float
    turned_deg: float
    supports: SupportsOf
    reason: str = ""


@dataclass(frozen=True, eq=False, repr=False)
class ReplanRecord(Summarised):
    """A build that was planned again.

    Attributes
    ----------
    edited
        Name of the file that was read.
    source
        Where parts, places and settings of the original come from.
    build_id
        Name of the new build.
    parts
        Its parts, in their order.
    deleted
        Labels of the parts that are gone; of those that left no trace, how many there were.
    unsupported
        Overhangs that have no support, those that are no fault left out.
    violations
        Broken promises.
    judged_all
        Whether the supports that were kept were judged, too.
    notes
        Sentences for the user.
    stages
        Durations of the stages.
    file, report_file, sha256
        The files that were written, and the digest of the build file; empty after a dry run.
    page_file
        The page, empty if none was asked for.
    """

    edited: str
    source: str
    build_id: str
    parts: tuple[ReplannedPart, ...]
    deleted: tuple[str, ...] = ()
    unsupported: tuple[Unsupported, ...] = ()
    violations: tuple[Violation, ...] = ()
    judged_all: bool = False
    notes: tuple[str, ...] = ()
    stages: tuple[StageTime, ...] = ()
    file: str = ""
    report_file: str = ""
    sha256: str = ""
    page_file: str = ""

    @property
    def faults(self) -> int:
        """Number of unsupported regions and broken promises."""
        return len(self.unsupported) + len(self.violations)

    def __str__(self) -> str:
        """Return the counts in one line."""
        return f"{self.build_id}: {counts_in_words(self)}, {counted(self.faults, 'fault')}"


def counts_in_words(record: ReplanRecord) -> str:
    """Return for how many parts supports were kept, taken along, and planned again."""
    count = Counter(each.supports for each in record.parts)
    return ", ".join(f"{number} {what}" for what, number in sorted(count.items()))


def to_json(record: ReplanRecord) -> dict[str, Any]:
    """Return a record as plain values."""
    values = {
        "format": FORMAT,
        "amprep_version": __version__,
        "edited": record.edited,
        "source": record.source,
        "id": record.build_id,
        "file": record.file or None,
        "sha256": record.sha256 or None,
        "parts": [vars(each) for each in record.parts],
        "deleted": list(record.deleted),
        "unsupported": [
            {"region": each.label, "reason": each.reason, "kind": each.kind, "measure": each.measure}
            for each in record.unsupported
        ],
        "verified": "all supports" if record.judged_all else "what was planned again or moved",
        "violations": violations_json(record.violations),
        "notes": list(record.notes),
        "stages": stages_json(record.stages),
    }
    result: dict[str, Any] = plain(values)
    return result


def summary(record: ReplanRecord, folder: Path = Path()) -> "RenderableType":
    """Return the closing list: what was kept, what was planned again and why, faults and files."""
    from rich.console import Group
    from rich.text import Text

    blocks = [Text(f"{record.build_id}: {counts_in_words(record)}"), Text(record.source, style="dim")]
    lines = [(each, "") for each in part_lines(record)]
    lines += [(f"! {words}", "yellow") for words in _unsupported_words(record)]
    lines += [(f"! {each}", "red") for each in record.violations]
    shown = lines[:_MOST_LINES]
    if len(lines) > len(shown):
        shown.append((f"... and {len(lines) - len(shown)} more in the JSON", "dim"))
    blocks += [Text(printable(line), style=style) for line, style in shown]
    blocks += [Text(printable(line), style="dim") for line in (*record.notes, verified_words(record))]
    files = [record.page_file, record.report_file, record.file]
    blocks += [Text(printable(f"wrote {folder / name}"), style="dim") for name in files if name]
    return Group(*blocks)


def part_lines(record: ReplanRecord) -> list[str]:
    """Return one line for each part that was changed or planned again, and for each that is gone."""
    changed = [each for each in record.parts if each.change != "none" or each.reason]
    return [*map(_part_words, changed), *(f"{label}: deleted" for label in record.deleted)]


def _unsupported_words(record: ReplanRecord) -> Iterator[str]:
    """Yield for each part how many of its overhangs have no support, and why."""
    for number, part in enumerate(record.parts):
        own = [each for each in record.unsupported if each.part == number]
        if own:
            reasons = ", ".join(sorted({each.reason for each in own}))
            count = counted(len({each.label for each in own}), "unsupported overhang")
            yield f"{part.label}: {count} ({reasons})"


def _part_words(part: ReplannedPart) -> str:
    turned = f" by {part.turned_deg:.2f} degrees" if part.change == "turned" else ""
    moved = f" by {part.moved_mm:.2f} mm" if part.change == "moved" else ""
    change = "not moved" if part.change == "none" else f"{part.change}{turned}{moved}"
    reason = f" ({part.reason})" if part.reason else ""
    return f"{part.label}: {change}; supports {part.supports}{reason}"


def verified_words(record: ReplanRecord) -> str:
    """Return whether the build keeps its promises, and what was judged."""
    result = (
        "every promise holds" if not record.violations else counted(len(record.violations), "broken promise")
    )
    scope = "all supports judged" if record.judged_all else "kept supports not judged again (--verify-all)"
    return f"verified: {result}; {scope}"
