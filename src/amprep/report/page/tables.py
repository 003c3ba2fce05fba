"""Make the header and the tables of the HTML report; every string from a file is escaped."""

import json
from collections import Counter
from html import escape
from textwrap import dedent
from typing import Any

from amprep.checks.packing.pairs import PairCounts
from amprep.measures.density import part_volume
from amprep.measures.legs import MeasuredLeg
from amprep.model import PlacedPart
from amprep.model.counting import counted
from amprep.report.json_values import plain
from amprep.report.objective import status_words
from amprep.report.page.cells import Cell, table
from amprep.report.page.findings import MOST_ROWS, chips, finding_sections
from amprep.report.page.packing import objective_figures, packing_section, values_section
from amprep.report.page.profile_chart import profile_chart
from amprep.report.picture.colours import part_colours
from amprep.report.printing import HOW_TO_GET_MASS, hours_words, mass_words, total_cost, total_mass_g
from amprep.report.record import BuildRecord, RunRecord
from amprep.report.removal_order import hindrances_of, removal_rows, removal_summary
from amprep.report.triage.findings import findings_of
from amprep.report.triage.rules import rules_of

_SIGNATURES = (
    '<section class="signatures"><h2>Release</h2>\n<table><thead><tr><th></th><th>Name</th><th>Date</th>'
    "<th>Signature</th></tr></thead><tbody>"
    + "".join(
        f"<tr><th>{words}</th><td></td><td></td><td></td></tr>" for words in ("Prepared by", "Released by")
    )
    + "</tbody></table></section>\n"
)
"""A table to sign on paper; the screen does not show it."""


def header(record: RunRecord) -> str:
    """Return the title with the number of findings of each class, the run's settings and the key figures."""
    lead = " · ".join(
        escape(text)
        for text in (
            record.printer,
            f"target {record.target}",
            status_words(record),
            f"seed {record.seed}",
        )
    )
    figures = "".join(
        f"<div{' class=bad' if bad else ''}><dt>{name}</dt><dd>{value}</dd></div>"
        for name, value, bad in _figures(record)
    )
    rules = "".join(f'<p class="lead">{escape(words)}</p>\n' for words in rules_of(record))
    title = (
        f'<header><h1>{escape(record.job)}</h1>\n<p class="chips">{chips(findings_of(record))}</p>\n'
        f'<p class="lead">{lead}</p>\n{rules}</header>\n'
    )
    return f'{title}<dl class="figures">{figures}</dl>\n'


def body_sections(record: RunRecord) -> str:
    """Return every section below the 3D view."""
    numbered = list(enumerate(record.builds, start=1))
    sections = [
        ("Builds", _builds(record)),
        ("Packing", packing_section(record)),
        ("Values", values_section(record)),
        ("Unplaced copies", _unplaced(record)),
        ("Supports", "".join(_supports(number, entry) for number, entry in numbered)),
        ("Support removal", "".join(_removal(number, entry) for number, entry in numbered)),
        ("Demand squares without a support", _unconnected(record)),
        ("Cross-section by height", "".join(profile_chart(number, entry) for number, entry in numbered)),
        ("Removal of parts", "".join(_part_removal(number, entry) for number, entry in numbered)),
        ("Verification", _verification(record)),
        ("Parts", "".join(_parts(number, entry) for number, entry in numbered)),
        ("Warnings and notes", _remarks(record)),
        ("Durations", _stages(record)),
        ("Settings", _settings(record)),
    ]
    body = finding_sections(record) + "".join(
        f"<section><h2>{title}</h2>\n{content}</section>\n" for title, content in sections if content
    )
    footer = (
        f"Made by amprep {escape(record.version)}. Lengths are in mm; the build plate is at z = 0. Density is the "
        "volume of the parts / (area of the plate × height of the build). The printing time is an estimate for "
        "recoating and scanning by the speeds of the material profile, without warming up and cooling down. A demand "
        "square is a square of the support grid below an overhang."
    )
    return f"{body}{_SIGNATURES}<footer>{footer}</footer>\n"


def _figures(record: RunRecord) -> list[tuple[str, str, bool]]:
    """Return the name of each key figure, its value as HTML, and whether it is a fault."""
    builds = record.builds
    placed = sum(len(entry.build.parts) for entry in builds)
    area = sum(entry.unsupported_mm2 for entry in builds)
    broken = sum(len(entry.verification or ()) for entry in builds)
    verified = bool(builds) and all(entry.verification is not None for entry in builds)
    violations = str(broken) if broken else ("none" if verified else "not verified")
    volume = sum(entry.support_volume_mm3 for entry in builds) / 1000
    density = sum(entry.density for entry in builds) / max(len(builds), 1)
    printing = [entry.printing for entry in builds]
    use = sum(each.plate_use for each in printing) / max(len(builds), 1)
    mass, unit = mass_words(total_mass_g(printing))
    number, hours_unit = hours_words(sum(each.hours for each in printing)).split()
    return [
        *([("Builds", str(len(builds)), False)] if record.objective == "builds" else []),
        *objective_figures(record),
        ("Parts placed", str(placed), False),
        *(
            [("Unplaced copies", str(len(record.unplaced)), record.objective != "fill")]
            if record.unplaced
            else []
        ),
        ("Density" if len(builds) == 1 else "Mean density", f"{100 * density:.1f} <small>%</small>", False),
        ("Plate use" if len(builds) == 1 else "Mean plate use", f"{100 * use:.1f} <small>%</small>", False),
        ("Mass", " ".join((mass, f"<small>{unit or HOW_TO_GET_MASS}</small>")), False),
        ("Printing time", f"{number} <small>{hours_unit}</small>", False),
        *([] if (cost := total_cost(printing)) is None else [("Cost", f"{cost:,.2f}", False)]),
        ("Build height", f"{max((e.height_mm for e in builds), default=0.0):.1f} <small>mm</small>", False),
        ("Support volume", f"{volume:.2f} <small>cm³</small>", False),
        ("Unsupported area", f"{area:.1f} <small>mm²</small>", area > 0.0),
        ("Violations", violations, bool(broken)),
        ("Run time", f"{sum(stage.seconds for stage in record.stages):.1f} <small>s</small>", False),
    ]


def _builds(record: RunRecord) -> str:
    headings = (
        "Build",
        "File",
        "Parts|",
        "Density|",
        "Height mm|",
        "Plate use|",
        "Mass|",
        "Layers|",
        "Printing time|",
        "Support volume cm³|",
        "Unsupported area mm²|",
    )
    rows = (
        (
            entry.build.settings.build_id,
            ", ".join(name for name in (entry.file, entry.picture) if name) or "not written",
            len(entry.build.parts),
            ("number", f"{100 * entry.density:.1f} %"),
            ("number", f"{entry.height_mm:.2f}"),
            ("number", f"{100 * entry.printing.plate_use:.1f} %"),
            ("number", " ".join(mass_words(entry.printing.mass_g)).strip()),
            entry.printing.layers,
            ("number", hours_words(entry.printing.hours)),
            ("number", f"{entry.support_volume_mm3 / 1000:.3f}"),
            ("number", f"{entry.unsupported_mm2:.2f}"),
        )
        for entry in record.builds
    )
    return table(headings, rows) if record.builds else '<p class="empty">No build was made.</p>'


def _parts(number: int, entry: BuildRecord) -> str:
    colours = part_colours(entry.build)
    rows = (_part_row(placed, colour) for placed, colour in zip(entry.build.parts, colours, strict=True))
    headings = (
        "Part",
        "Part number",
        "Size mm",
        "Volume cm³|",
        "Lowest corner mm",
        "Transform (row-major, mm)",
    )
    name = f"Build {number}: {counted(len(entry.build.parts), 'part')}"
    return _details(name, table(headings, rows))


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
    if not entry.legs:
        return ""
    rows = (
        (
            body.name,
            ("number", "" if body.surface else f"{abs(body.mesh.signed_volume) / 1000:.3f}"),
            each.total,
            len(each.too_long),
            *_worst_leg(each.worst),
        )
        for body, each in zip(entry.build.supports, entry.legs, strict=True)
    )
    headings = (
        "Support body",
        "Volume cm³|",
        "Legs|",
        "Too long|",
        "Largest ratio|",
        "Length / width mm|",
        "At, mm",
    )
    bodies = "1 support body" if len(entry.legs) == 1 else f"{len(entry.legs)} support bodies"
    most = max((each.worst.ratio for each in entry.legs if each.worst), default=0.0)
    too_long = sum(len(each.too_long) for each in entry.legs)
    name = (
        f"Build {number}: {bodies}, largest ratio of length to width of a leg {most:.1f}, {too_long} too long"
    )
    return _details(name, table(headings, rows))


def _worst_leg(leg: MeasuredLeg | None) -> tuple[Any, ...]:
    if leg is None:
        return ("", "", "")
    return (
        ("number", f"{leg.ratio:.1f}"),
        ("number", f"{leg.length_mm:.1f} / {leg.width_mm:.2f}"),
        ", ".join(f"{value:.1f}" for value in leg.position_mm),
    )


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
        "Support body",
        "Mass g|",
        "Scanned area mm²|",
        "Contact area mm²|",
        "Contact patches|",
        "Powder pockets|",
        "Trapped powder mm³|",
    )
    return _details(f"Build {number}", table(headings, rows))


def _part_removal(number: int, entry: BuildRecord) -> str:
    if not entry.removal_order.steps and not entry.removal_order.locked:
        return ""
    hindrances = "".join(f'<p class="bad">{escape(line)}.</p>' for line in hindrances_of(entry))
    listed = table(("Parts", "Leave", "Only after"), removal_rows(entry))
    return _details(f"Build {number}: {removal_summary(entry)}", hindrances + listed)


def _figure(value: float | None, form: str) -> tuple[str, str]:
    return "number", "" if value is None else f"{value:{form}}"


def _unconnected(record: RunRecord) -> str:
    """Return the demand squares without a support, counted by region and reason."""
    squares = Counter(
        (number, square.region, square.reason)
        for number, entry in enumerate(record.builds, start=1)
        for square in entry.unconnected
    )
    if not squares:
        return ""
    rows = [
        (number, region, count, reason) for (number, region, reason), count in squares.most_common(MOST_ROWS)
    ]
    left = len(squares) - len(rows)
    name = f"{counted(squares.total(), 'demand square')} in {counted(len(squares), 'region')}"
    note = f'<p class="empty">{left} more are in the JSON report.</p>' if left else ""
    return _details(name, table(("Build|", "Region", "Demand squares|", "Reason"), rows) + note)


def _verification(record: RunRecord) -> str:
    rows = [
        (number, found.promise, found.subject, found.message)
        for number, entry in enumerate(record.builds, start=1)
        for found in entry.verification or ()
    ]
    if rows:
        return table(("Build|", "Promise", "Subject", "Finding"), rows)
    verified = record.builds and all(entry.verification is not None for entry in record.builds)
    pairs = sum((entry.pairs for entry in record.builds), PairCounts())
    how = f" Distances of parts were checked exactly: {pairs}." if pairs.total else ""
    text = f"All checks passed.{how}" if verified else "The builds were not verified."
    return f'<p class="empty">{text}</p>'


def _remarks(record: RunRecord) -> str:
    supports = [text for entry in record.builds for text in (*entry.notes, *entry.shared_supports)]
    plain = (*record.by_default, *record.notes, *supports)
    if not (record.warnings or plain):
        return ""
    items = [f'<li class="bad">{escape(text)}</li>' for text in record.warnings]
    items += [f"<li>{escape(text)}</li>" for text in plain]
    return f'<ul class="remarks">{"".join(items)}</ul>'


def _stages(record: RunRecord) -> str:
    total = sum(stage.seconds for stage in record.stages)
    rows = [
        (stage.name, ("number", f"{stage.seconds:.2f}"), _fraction_bar(stage.seconds, total))
        for stage in record.stages
    ]
    return table(("Stage", "Seconds|", "Fraction of the run"), rows) if rows else ""


def _fraction_bar(seconds: float, total: float) -> tuple[str, str]:
    width = 100 * seconds / total if total > 0 else 0.0
    bars = f'<rect width="100" height="6"/><rect width="{width:.2f}" height="6"/>'
    return "fraction", f'<svg viewBox="0 0 100 6" preserveAspectRatio="none">{bars}</svg>'


def _settings(record: RunRecord) -> str:
    if not record.settings:
        return ""
    text = json.dumps(plain(dict(record.settings)), indent=2, ensure_ascii=False)
    inner = f'<div class="scroll"><pre>{escape(text)}</pre></div>'
    return _details("All settings of the run", inner)


def _details(summary: str, content: str) -> str:
    """Return content that a click on its summary shows."""
    return f"<details><summary>{summary}</summary>\n{content}</details>\n"
