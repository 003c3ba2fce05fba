"""The HTML report in headless Chromium: pixels, clicks and keys."""

import base64
import io
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.shared.browser import CHROMIUM, browser_page

import amprep

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")

FIXTURES = Path(__file__).parents[2] / "fixtures"


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    settings = {"cells.strategy": "prism", "packing.strategy": "extreme-points"}
    amprep.run(FIXTURES / "table.stl", FIXTURES / "ball.stl", output=folder, settings=settings)
    return next(folder.glob("*.report.html"))


@pytest.fixture(scope="module")
def page(report, tmp_path_factory):
    with browser_page(tmp_path_factory.mktemp("browser")) as opened:
        opened.open(report)
        yield opened


@pytest.fixture(autouse=True)
def whole_view(page):
    page.run(
        "document.getElementById('measure').getAttribute('aria-pressed') === 'true' && "
        "document.getElementById('measure').click(); document.querySelector('#views button').click(); "
        "document.getElementById('stage').scrollIntoView()"
    )


def pixels(page):
    return np.asarray(Image.open(io.BytesIO(page.picture())).convert("RGB"), np.int64)


def frame(page):
    return page.run(
        "(({left, top, width, height}) => [left, top, width, height])"
        "(document.getElementById('canvas').getBoundingClientRect())"
    )


def text(page, name):
    return page.run(f"document.getElementById('{name}').innerText")


def place_of_part(page, index):
    """A point of the window at which a part is, found by hiding it."""
    shown = pixels(page)
    box = f"document.querySelectorAll('#lists li[data-key^=part] input')[{index}]"
    page.run(f"{box}.click()")
    changed = np.abs(pixels(page) - shown).sum(axis=2) > 60
    page.run(f"{box}.click()")
    left, top, width, height = frame(page)
    inside = np.zeros_like(changed)
    inside[int(top) + 60 : int(top + height) - 60, int(left) : int(left + width)] = True
    rows, columns = np.nonzero(changed & inside)
    assert len(rows) > 200
    middle = np.argmin(np.hypot(rows - rows.mean(), columns - columns.mean()))
    return float(columns[middle]), float(rows[middle])


def test_the_view_shows_the_parts_and_nothing_fails(page):
    left, top, width, height = frame(page)
    view = pixels(page)[int(top) : int(top + height), int(left) : int(left + width)]
    assert len(np.unique(view.reshape(-1, 3), axis=0)) > 200
    assert page.errors == []


def test_a_click_on_a_part_names_it(page):
    name = page.run("document.querySelectorAll('#lists li[data-key^=part] button span')[0].innerText")
    page.click(*place_of_part(page, 0))
    page.wait("!document.getElementById('card').hidden")
    assert name in text(page, "card") or "supports of" in text(page, "card")


def test_two_clicks_measure_a_distance_within_the_part(page):
    x, y = place_of_part(page, 0)
    page.run("document.getElementById('measure').click()")
    assert "Click two points" in text(page, "card")
    page.click(x, y)
    page.click(x + 14, y + 6)
    found = text(page, "card")
    (distance,) = map(float, re.findall(r"^([\d.]+) mm", found))
    (along,) = re.findall(r"along x ([\d.]+), y ([\d.]+), z ([\d.]+)", found)
    assert distance == pytest.approx(np.linalg.norm([float(each) for each in along]), abs=0.02)
    assert 0.0 < distance < 100.0
    page.press("Escape")
    page.run("document.getElementById('canvas').focus()")
    page.press("Escape")
    assert page.run("document.getElementById('card').hidden")


def test_keys_choose_views_and_zoom(page):
    page.run("document.getElementById('canvas').focus()")
    seen = [pixels(page)]
    for key in ("2", "+", "5", "1"):
        page.press(key)
        seen.append(pixels(page))
    assert all((one != other).mean() > 0.01 for one, other in zip(seen, seen[1:], strict=False))
    assert (seen[0] != seen[-1]).mean() < 0.001


def test_a_click_on_a_heading_sorts_and_the_search_hides_rows(page):
    heading = "[...document.querySelectorAll('table')].map(t => t.tHead?.rows[0].cells[1]).find(h => h?.tabIndex === 0)"
    page.run(f"{heading}.click()")
    assert page.run(f"{heading}.getAttribute('aria-sort')") == "ascending"
    rows = "[...document.querySelectorAll('details.findings tbody tr')].filter(row => !row.hidden).length"
    before = page.run(rows)
    assert before > 0
    search = "document.querySelector('#search input')"
    page.run(f"{search}.value = 'no part has this name'; {search}.dispatchEvent(new Event('input'))")
    page.wait(f"{rows} === 0")
    page.run(f"{search}.value = ''; {search}.dispatchEvent(new Event('input'))")
    page.wait(f"{rows} === {before}")


def test_a_phone_shows_the_page_without_scrolling_sideways(page):
    size = {"deviceScaleFactor": 1, "mobile": True}
    page.ask("Emulation.setDeviceMetricsOverride", width=390, height=780, **size)
    try:
        assert page.run("document.documentElement.scrollWidth") <= 390
        left, _, width, height = frame(page)
        assert left >= 0
        assert width > 330
        assert height > 300
    finally:
        page.ask(
            "Emulation.setDeviceMetricsOverride", width=1300, height=900, deviceScaleFactor=1, mobile=False
        )


def test_paper_gets_a_picture_of_each_build_all_tables_and_lines_to_sign(page):
    pdf = base64.b64decode(page.ask("Page.printToPDF", printBackground=True)["data"])
    assert pdf.startswith(b"%PDF")
    assert len(re.findall(rb"/Type\s*/Page\b", pdf)) > 1
    assert b"/Subtype /Image" in pdf  # the picture of the build
    assert page.run("document.querySelectorAll('main details:not([open])').length") > 0  # folded again
    assert page.run("document.getElementById('printed').children.length") == 0
