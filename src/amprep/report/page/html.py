"""The report for people: `job.report.html`, one file that opens offline, with a 3D view of each build."""

import hashlib
import json
from base64 import b64encode
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from amprep.files import replacing
from amprep.report.json_values import plain
from amprep.report.page.tables import body_sections, header
from amprep.report.page.view_model import view_model
from amprep.report.record import RunRecord

VIEWER = """\
<section id="viewer" aria-label="3D view of the builds">
<div id="stage">
<canvas id="canvas" tabindex="0" aria-label="3D view: keys 1 to 5 choose a view, arrows move it, \
Shift and arrows turn it, + and - zoom, m measures" \
title="Drag to rotate, scroll to zoom, right-drag to pan, click to identify; \
keys: 1 to 5, arrows, + and -, m to measure"></canvas>
<div id="wait">Loading the geometry ...
<noscript>The 3D view needs scripts; the tables below are complete.</noscript></div>
<div class="bar" id="top"><div class="group" id="tabs" role="tablist"></div>
<div class="group" id="layers"></div>
<div class="group" id="volumes" role="radiogroup" aria-label="Bounding volume"></div></div>
<div id="card" hidden></div>
<div class="bar" id="bottom"><div class="group" id="views"></div>
<div class="group">
<label>Cut at height <input id="section" type="range" min="0" max="1" step="0.1" value="1"></label>
<span id="section-value">off</span></div>
<div class="group"><button type="button" id="measure" aria-pressed="false">Measure</button></div></div>
</div>
<div id="lists"></div>
</section>
<div id="printed"></div>
"""


def write_html(record: RunRecord, path: Path) -> None:
    """Write the report as one HTML file without references to other files; it appears complete, or not at all.

    Every string from a file is escaped. A content security policy allows only the bundled scripts and no network
    access.
    """
    with replacing(path) as temporary:
        temporary.write_bytes(html_text(record).encode("utf-8", "replace"))


def html_text(record: RunRecord) -> str:
    """Return the whole page."""
    body = f"{header(record)}{VIEWER}{body_sections(record)}"
    return page_text(f"{record.job} - amprep report", body, *view_model(record))


def page_text(title: str, body: str, model: dict[str, Any], geometry: str) -> str:
    """Return a page with the scripts of the 3D view and of tables, and the style of both.

    Parameters
    ----------
    title
        Title of the window; it is escaped.
    body
        HTML of the page, with `VIEWER` in it.
    model, geometry
        Data of the 3D view.
    """
    viewer, script, style = _resource("viewer.bundle.js"), _resource("page.js"), _resource("page.css")
    policy = (
        f"default-src 'none'; script-src '{_digest(viewer)}' '{_digest(script)}'; style-src '{_digest(style)}'; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{style}</style>\n"
        "</head>\n<body>\n<main>\n"
        f"{body}</main>\n"
        f'<script type="application/json" id="model">{_json(model)}</script>\n'
        f'<script type="text/plain" id="geometry">{geometry}</script>\n'
        f'<script id="tables">{script}</script>\n<script>{viewer}</script>\n</body>\n</html>\n'
    )


def static_page(title: str, body: str) -> str:
    """Return a page without scripts, whose pictures are in it; `title` is escaped, `body` is HTML."""
    style = _resource("page.css")
    policy = f"default-src 'none'; style-src '{_digest(style)}'; img-src data:; base-uri 'none'; form-action 'none'"
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{style}</style>\n"
        f"</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n"
    )


def _resource(name: str) -> str:
    return files("amprep.report").joinpath(name).read_text(encoding="utf-8")


def _digest(text: str) -> str:
    """Return the hash with which the policy allows an inline script or style."""
    return "sha256-" + b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii")


def _json(model: dict[str, Any]) -> str:
    """Return JSON in which no string can end the HTML element around it."""
    text = json.dumps(plain(model), separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
