"""Tables in HTML; every string from a file is escaped."""

from collections.abc import Iterable, Sequence
from html import escape
from itertools import repeat

Cell = str | float | tuple[str, str]
"""Text that is escaped; a number, aligned to the right; or a CSS class and HTML, used as it is."""


def table(headings: Sequence[str], rows: Iterable[Sequence[Cell]], tags: Iterable[str] | None = None) -> str:
    """Return a table; a heading that ends with ``|`` is that of a column of numbers.

    Parameters
    ----------
    headings, rows
        Headings, and the cells of each row.
    tags
        Attributes of each row in HTML; None for no attributes.
    """
    head = "".join(
        f"<th{' class=number' if heading.endswith('|') else ''}>{escape(heading.rstrip('|'))}</th>"
        for heading in headings
    )
    body = "".join(
        f"<tr{f' {tag}' if tag else ''}>{''.join(map(_cell, row))}</tr>\n"
        for row, tag in zip(rows, repeat("") if tags is None else tags, strict=False)
    )
    return f'<div class="scroll"><table><thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table></div>\n'


def _cell(value: Cell) -> str:
    if isinstance(value, tuple):
        return f'<td class="{value[0]}">{value[1]}</td>'
    if isinstance(value, str):
        return f"<td>{escape(value)}</td>"
    return f'<td class="number">{value:,}</td>'
