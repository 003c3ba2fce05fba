"""The sections of the HTML report on what was found, by what must be done: must fix first."""

from collections.abc import Iterator, Sequence
from html import escape

from amprep.geometry.overhangs.regions import NOT_FACES
from amprep.model.counting import counted
from amprep.model.supports import REASONS
from amprep.report.page.cells import Cell, table
from amprep.report.record import OverhangRecord, RunRecord
from amprep.report.triage.classes import CHECK, MUST_FIX, SELF_SUPPORTING, SUPPORTED, TRIAGES, Triage
from amprep.report.triage.findings import Finding, findings_of
from amprep.report.triage.groups import FindingGroup, count_by_triage, grouped
from amprep.report.triage.words import position_words

MOST_ROWS = 3000
"""Rows of all groups together that the page has; the JSON report has the rest."""

ROWS_EACH = (5, 250)
"""Fewest and most rows of one group."""

MOST_GROUPS = 400
"""Groups of one class that the page has; the first are those with the largest finding."""

MOST_OPEN = 25
"""Findings of a class up to which its groups are unfolded at first."""

CSS_CLASSES = {MUST_FIX: "must", CHECK: "check", SUPPORTED: "held", SELF_SUPPORTING: "self"}

_EXPLAINED = {
    MUST_FIX: "Overhangs without support, and whatever else breaks a promise.",
    CHECK: "Nothing that breaks a promise, but an engineer should look at it before the build is released.",
    SUPPORTED: "Overhangs that the supports of this build carry.",
    SELF_SUPPORTING: "Overhangs that the part itself carries, within the limits of the material.",
}


def chips(findings: Sequence[Finding]) -> str:
    """Return the number of findings of each class as links to their sections; each has its name in words."""
    counts = count_by_triage(findings)
    shown = [triage for triage in TRIAGES if counts[triage]]
    links = [
        f'<a class="chip {CSS_CLASSES[triage]}" href="#{CSS_CLASSES[triage]}">{counts[triage]:,} {triage}</a>'
        for triage in shown
    ]
    return (
        "".join(links)
        if counts[MUST_FIX]
        else f'<span class="chip">nothing must be fixed</span>{"".join(links)}'
    )


def finding_sections(record: RunRecord) -> str:
    """Return a section for each class with its groups; what is in order is folded."""
    findings = findings_of(record)
    if not findings:
        return ""
    groups, counts = grouped(findings), count_by_triage(findings)
    most = min(max(MOST_ROWS // len(groups), ROWS_EACH[0]), ROWS_EACH[1])
    several = len(record.builds) > 1
    search = (
        '<div id="search" hidden><label>Search parts, regions and verdicts <input type="search"></label> '
        "<span></span></div>\n"
    )
    return search + "".join(
        _section(triage, counts[triage], [each for each in groups if each.triage == triage], most, several)
        for triage in TRIAGES
        if counts[triage]
    )


def _section(triage: Triage, count: int, groups: Sequence[FindingGroup], most: int, several: bool) -> str:
    urgent = triage in (MUST_FIX, CHECK)
    opened = urgent and count <= MOST_OPEN
    body = f"<p>{_EXPLAINED[triage]}</p>\n{_reasons(groups)}" + "".join(
        _group(each, most, several, opened) for each in groups[:MOST_GROUPS]
    )
    if len(groups) > MOST_GROUPS:
        body += f'<p class="empty">{len(groups) - MOST_GROUPS} more groups are in the JSON report.</p>\n'
    title = f"{triage.capitalize()} ({count:,})"
    name = CSS_CLASSES[triage]
    if urgent:
        return f'<section class="triage {name}" id="{name}"><h2>{title}</h2>\n{body}</section>\n'
    return (
        f'<section class="triage {name}" id="{name}"><details><summary><h2>{title}</h2></summary>\n'
        f"{body}</details></section>\n"
    )


def _reasons(groups: Sequence[FindingGroup]) -> str:
    """Return the explanation of each reason for which regions have no support."""
    found = {
        reason
        for group in groups
        for each in group.findings
        if each.overhang is not None
        for reason in each.overhang.reasons
    }
    items = "".join(
        f"<li><b>{escape(reason)}</b>: {escape(words.replace('`', ''))}</li>"
        for reason, words in REASONS.items()
        if reason in found
    )
    return f'<ul class="reasons">{items}</ul>\n' if items else ""


def _group(group: FindingGroup, most: int, several: bool, opened: bool) -> str:
    """Return a group that unfolds to its findings, at most `most` of them."""
    shown, rest = group.findings[:most], len(group.findings) - most
    note = (
        f'<p class="empty">The {most} largest; {counted(rest, "more row is", "more rows are")} in the JSON report.</p>'
        if rest > 0
        else ""
    )
    summary = (
        f'<span class="tag {CSS_CLASSES[group.triage]}">{group.triage}</span> <b>{escape(group.part)}</b>: '
        f"{escape(group.words)}"
    )
    listed = _table(shown, several)
    return (
        f'<details class="findings"{" open" if opened else ""}><summary>{summary}</summary>\n'
        f"{listed}{note}</details>\n"
    )


def _table(findings: Sequence[Finding], several: bool) -> str:
    """Return one row for each finding, without columns that would be empty."""
    overhangs = [each.overhang for each in findings if each.overhang is not None]
    columns: list[tuple[str, list[Cell]]] = [
        ("Build|", [("number", str(each.build or "")) for each in findings]),
        ("Name", [each.name for each in findings]),
        ("Verdict", [each.words for each in findings]),
        *(_sizes(overhangs, findings[0].kind) if len(overhangs) == len(findings) else ()),
        ("Position mm", [("place", position_words(each)) for each in findings]),
    ]
    headings, cells = zip(*(columns if several else columns[1:]), strict=True)
    return table(headings, zip(*cells, strict=True), map(_tag, findings))


def _sizes(overhangs: Sequence[OverhangRecord], kind: str) -> Iterator[tuple[str, list[Cell]]]:
    """Yield the columns of figures of regions of one kind."""
    regions = [each.region for each in overhangs]
    amount = "Length mm|" if kind == "edge" else "Area mm²|"
    columns = [
        ("Size mm|", [f"{each.size_mm:.2f}" if each.size_mm > 0.0 else "" for each in regions]),
        ("Limit mm|", [f"{each.limit_mm:g}" if each.limit_mm > 0.0 else "" for each in regions]),
        (amount, [f"{each.measure:.2f}" if each.measure > 0.0 else "" for each in regions]),
        ("Angle °|", ["" if kind in NOT_FACES else f"{each.angle_deg:.1f}" for each in regions]),
        ("Lowest mm|", [f"{each.lowest_mm:.2f}" for each in regions]),
    ]
    for heading, figures in columns:
        if any(figures):
            yield heading, [("number", figure) for figure in figures]


def _tag(finding: Finding) -> str:
    """Return the attributes with which the script shows a finding in the 3D view."""
    if finding.position_mm is None or not finding.build:
        return ""
    at = " ".join(f"{value:.3f}" for value in finding.position_mm)
    return f'data-build="{finding.build - 1}" data-at="{at}" data-triage="{CSS_CLASSES[finding.triage]}" tabindex="0"'
