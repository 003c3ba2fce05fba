"""The words and tables of the HTML report; every string is escaped where it enters."""

import json
from collections import Counter
from collections.abc import Iterable, Sequence
from html import escape
from textwrap import dedent

from amprep.measures.density import part_volume
from amprep.model import PlacedPart
from amprep.report.json_report import plain
from amprep.report.picture.colours import part_colours
from amprep.report.record import BuildRecord, RunRecord

Cell = str | float | tuple[str, str]
"""Text (escaped), a number (right aligned, as formatted), or (class, HTML made here)."""


def header(record: RunRecord) -> str:
    """Return title, verdict and key figures."""
    faults = record.faults
    chip = (
        f'<span class="chip look">{faults} to look at</span>' if faults else '<span class="chip">ready</span>'
    )
    words = " · ".join(
        escape(word)
        for word in (
            record.printer,
            f"for {record.target}",
            f"{record.status}, {record.stop_reason}",
            f"seed {record.seed}",
        )
    )
    figures = "".join(
        f"<div{' class=bad' if bad else ''}><dt>{name}</dt><dd>{value}</dd></div>"
        for name, value, bad in _figures(record)
    )
    title = f'<header><h1>{escape(record.job)}{chip}</h1>\n<p class="lead">{words}</p></header>\n'
    return f'{title}<dl class="figures">{figures}</dl>\n'


def body_sections(record: RunRecord) -> str:
    """Return every table below the 3D view."""
    sections = [
        ("Builds", _builds(record)),
        ("Unplaced", _unplaced(record)),
        ("Unsupported", _unsupported(record)),
        ("Supports", "".join(_supports(n, entry) for n, entry in enumerate(record.builds, start=1))),
        ("Removing supports", "".join(_removal(n, each) for n, each in enumerate(record.builds, start=1))),
        ("Overhangs", "".join(_overhangs(n, entry) for n, entry in enumerate(record.builds, start=1))),
        ("Verification", _verification(record)),
        ("Parts", "".join(_parts(number, entry) for number, entry in enumerate(record.builds, start=1))),
        ("Warnings and notes", _words(record)),
        ("Time", _stages(record)),
        ("Settings", _settings(record)),
    ]
    body = "".join(
        f"<section><h2>{title}</h2>\n{content}</section>\n" for title, content in sections if content
    )
    return f"{body}<footer>Made by amprep {escape(record.version)}. Lengths in mm, plate at z = 0.</footer>\n"


def table(headings: Sequence[str], rows: Iterable[Sequence[Cell]]) -> str:
    """Return a table; headings that end with ``|`` stand over numbers."""
    head = "".join(
        f"<th{' class=number' if heading.endswith('|') else ''}>{escape(heading.rstrip('|'))}</th>"
        for heading in headings
    )
    body = "".join("<tr>" + "".join(map(_cell, row)) + "</tr>\n" for row in rows)
    return f'<div class="scroll"><table><thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table></div>\n'


def _cell(value: Cell) -> str:
    if isinstance(value, tuple):
        return f'<td class="{value[0]}">{value[1]}</td>'
    if isinstance(value, str):
        return f"<td>{escape(value)}</td>"
    return f'<td class="number">{value:,}</td>'


def _figures(record: RunRecord) -> list[tuple[str, str, bool]]:
    """Return name, value (HTML) and whether it is bad news."""
    builds = record.builds
    placed = sum(len(entry.build.parts) for entry in builds)
    area = sum(entry.unsupported_mm2 for entry in builds)
    broken = sum(len(entry.verification or ()) for entry in builds)
    judged = bool(builds) and all(entry.verification is not None for entry in builds)
    verdict = str(broken) if broken else ("none" if judged else "not judged")
    volume = sum(entry.support_volume_mm3 for entry in builds) / 1000
    density = sum(entry.density for entry in builds) / max(len(builds), 1)
    return [
        ("Builds", str(len(builds)), False),
        ("Parts placed", str(placed), False),
        ("Unplaced", str(len(record.unplaced)), bool(record.unplaced) and record.objective != "fill"),
        ("Density" if len(builds) == 1 else "Mean density", f"{100 * density:.1f} <small>%</small>", False),
        ("Height", f"{max((e.height_mm for e in builds), default=0.0):.1f} <small>mm</small>", False),
        ("Supports", f"{volume:.2f} <small>cm³</small>", False),
        ("Unsupported", f"{area:.1f} <small>mm²</small>", any(e.unsupported for e in builds)),
        ("Violations", verdict, bool(broken)),
        ("Time", f"{sum(stage.seconds for stage in record.stages):.1f} <small>s</small>", False),
    ]


def _builds(record: RunRecord) -> str:
    headings = (
        "Build",
        "File",
        "Parts|",
        "Density|",
        "Height mm|",
        "Supports cm³|",
        "Red squares|",
        "Unsupported mm²|",
    )
    rows = (
        (
            entry.build.settings.build_id,
            ", ".join(name for name in (entry.file, entry.picture) if name) or "not written",
            len(entry.build.parts),
            ("number", f"{100 * entry.density:.1f} %"),
            ("number", f"{entry.height_mm:.2f}"),
            ("number", f"{entry.support_volume_mm3 / 1000:.3f}"),
            entry.red,
            ("number", f"{entry.unsupported_mm2:.2f}"),
        )
        for entry in record.builds
    )
    return table(headings, rows) if record.builds else '<p class="empty">No build was made.</p>'


def _parts(number: int, entry: BuildRecord) -> str:
    colours = part_colours(entry.build)
    rows = (_part_row(placed, colour) for placed, colour in zip(entry.build.parts, colours, strict=True))
    headings = ("Part", "Number", "Size mm", "Volume cm³|", "Least corner mm", "Transform (row-major, mm)")
    name = f"Build {number}: {len(entry.build.parts)} parts"
    return f"<details><summary>{name}</summary>\n{table(headings, rows)}</details>\n"


def _part_row(placed: PlacedPart, colour: str) -> tuple[Cell, ...]:
    low, high = placed.mesh.bounds
    matrix = dedent("\n".join(" ".join(f"{value:9.4f}" for value in row) for row in placed.matrix.tolist()))
    dot = f'<svg class="swatch" viewBox="0 0 10 10"><circle cx="5" cy="5" r="5" fill="{colour}"/></svg>'
    return (
        ("name", dot + escape(placed.label)),
        placed.part.part_number,
        " × ".join(f"{size:.2f}" for size in high - low),
        ("number", f"{part_volume(placed) / 1000:.3f}"),
        ", ".join(f"{value:.2f}" for value in low),
        ("matrix", matrix),
    )


def _unplaced(record: RunRecord) -> str:
    rows = [(item.name, item.copy, item.reason) for item in record.unplaced]
    return table(("Part", "Copy|", "Reason"), rows) if rows else ""


def _supports(number: int, entry: BuildRecord) -> str:
    if not entry.columns:
        return ""
    rows = (
        (
            body.name,
            ("number", "" if body.surface else f"{abs(body.mesh.signed_volume) / 1000:.3f}"),
            columns.pieces,
            ("number", f"{columns.slenderness:.1f}"),
            ("number", f"{columns.height_mm:.1f} / {columns.width_mm:.2f}"),
            ", ".join(f"{value:.1f}" for value in columns.position_mm),
        )
        for body, columns in zip(entry.build.supports, entry.columns, strict=True)
    )
    headings = ("Supports", "Volume cm³|", "Pieces|", "Slenderness|", "Height / width mm|", "There, mm")
    most = max(columns.slenderness for columns in entry.columns)
    name = f"Build {number}: {len(entry.columns)} bodies, the most slender piece {most:.1f} times as high as wide"
    return f"<details><summary>{name}</summary>\n{table(headings, rows)}</details>\n"


def _removal(number: int, entry: BuildRecord) -> str:
    if not entry.removal:
        return ""
    rows = (
        (
            body.name,
            _figure(each.mass_g, ".2f"),
            _figure(each.scan_mm2, ",.0f"),
            _figure(each.contact_mm2, ".2f"),
            _figure(each.contacts, "d"),
            _figure(None if each.pockets is None else len(each.pockets), "d"),
            _figure(each.trapped_mm3, ".2f"),
        )
        for body, each in zip(entry.build.supports, entry.removal, strict=True)
    )
    headings = (
        "Supports",
        "Mass g|",
        "Scanned mm²|",
        "Contact mm²|",
        "Contacts|",
        "Powder pockets|",
        "Powder locked in mm³|",
    )
    return f"<details><summary>Build {number}</summary>\n{table(headings, rows)}</details>\n"


def _figure(value: float | None, form: str) -> tuple[str, str]:
    return "number", "" if value is None else f"{value:{form}}"


def _overhangs(number: int, entry: BuildRecord) -> str:
    if not entry.overhangs:
        return ""
    units = {"face": "mm²", "edge": "mm long", "tip": "mm high"}
    rows = (
        (
            each.name,
            each.kind,
            ("number", f"{each.measure:.2f} {units[each.kind]}"),
            ", ".join(f"{value:.2f}" for value in each.position_mm),
            ("number", f"{each.connected} of {each.red}"),
            each.held,
            ", ".join(each.reasons),
        )
        for each in entry.overhangs
    )
    headings = ("Overhang", "Kind", "Size|", "Centre mm", "Red squares connected|", "Held", "Reasons")
    held = sum(each.held == "whole" for each in entry.overhangs)
    name = f"Build {number}: {len(entry.overhangs)} overhangs, {held} held"
    return f"<details><summary>{name}</summary>\n{table(headings, rows)}</details>\n"


def _unsupported(record: RunRecord) -> str:
    rows: list[Sequence[Cell]] = []
    for number, entry in enumerate(record.builds, start=1):
        for region in entry.build.unsupported:
            unit = {"face": " mm²", "edge": " mm"}.get(region.kind, "")
            measure = f"{region.measure:.2f}{unit}" if unit else ""
            reason = f"{region.reason} (below the least size)" if region.minor else region.reason
            rows.append((number, region.label, region.kind, ("number", measure), reason))
    listed = table(("Build|", "Region", "Kind", "Size|", "Reason"), rows) if rows else ""
    squares = Counter(
        (number, square.region, square.reason)
        for number, entry in enumerate(record.builds, start=1)
        for square in entry.unconnected
    )
    if not squares:
        return listed
    grouped = [(number, region, count, reason) for (number, region, reason), count in squares.items()]
    name = f"{sum(squares.values())} red squares without a way to the plate"
    inner = table(("Build|", "Region", "Red squares|", "Reason"), grouped)
    return f"{listed}<details><summary>{name}</summary>\n{inner}</details>\n"


def _verification(record: RunRecord) -> str:
    rows = [
        (number, found.promise, found.subject, found.message)
        for number, entry in enumerate(record.builds, start=1)
        for found in entry.verification or ()
    ]
    if rows:
        return table(("Build|", "Promise", "What broke it", "Found"), rows)
    judged = record.builds and all(entry.verification is not None for entry in record.builds)
    words = "Every promise is kept." if judged else "The builds were not judged."
    return f'<p class="empty">{words}</p>'


def _words(record: RunRecord) -> str:
    supports = [words for entry in record.builds for words in (*entry.notes, *entry.shared)]
    if not (record.warnings or record.notes or supports):
        return ""
    items = [f'<li class="look">{escape(words)}</li>' for words in record.warnings]
    items += [f"<li>{escape(words)}</li>" for words in (*record.notes, *supports)]
    return f'<ul class="words">{"".join(items)}</ul>'


def _stages(record: RunRecord) -> str:
    total = sum(stage.seconds for stage in record.stages)
    rows = [
        (stage.name, ("number", f"{stage.seconds:.2f}"), _share(stage.seconds, total))
        for stage in record.stages
    ]
    return table(("Stage", "Seconds|", "Share"), rows) if rows else ""


def _share(seconds: float, total: float) -> tuple[str, str]:
    width = 100 * seconds / total if total > 0 else 0.0
    bars = f'<rect width="100" height="6"/><rect width="{width:.2f}" height="6"/>'
    return "bar", f'<svg class="share" viewBox="0 0 100 6" preserveAspectRatio="none">{bars}</svg>'


def _settings(record: RunRecord) -> str:
    if not record.settings:
        return ""
    text = json.dumps(plain(dict(record.settings)), indent=2, ensure_ascii=False)
    inner = f'<div class="scroll"><pre>{escape(text)}</pre></div>'
    return f"<details><summary>As the run used them</summary>{inner}</details>"
