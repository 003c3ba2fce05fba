"""The page groups findings, most urgent first, stays small for large builds, and is readable without its script."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.findings import overhang, run_of, run_of_overhangs

from amprep.model.supports import REASONS
from amprep.report.page.findings import MOST_GROUPS, MOST_ROWS, ROWS_EACH, chips, finding_sections
from amprep.report.page.html import html_text
from amprep.report.triage.classes import TRIAGES
from amprep.report.triage.findings import findings_of

EVIL = "</td></details><script>alert(1)</script>\"'&<!--"


class Parsed(HTMLParser):
    """The tags in order, all text, and whether every tag is closed in its order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag != "input":
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data

    def classes(self, name: str) -> list[dict[str, str | None]]:
        return [attributes for _, attributes in self.tags if name in (attributes.get("class") or "").split()]


def test_sections_are_in_the_order_of_urgency_and_what_is_in_order_is_folded():
    page = finding_sections(run_of_overhangs(list(reversed(TRIAGES))))
    titles = re.findall(r"<h2>(.*?)</h2>", page)
    assert titles == ["Must fix (1)", "Worth a check (1)", "Supported (1)", "Self-supporting (1)"]
    folded = re.findall(r'id="(\w+)"><details><summary><h2>', page)
    assert folded == ["held", "self"]


def test_every_class_is_named_in_words_beside_its_colour():
    run = run_of_overhangs(list(TRIAGES))
    labels = re.findall(r'<span class="tag \w+">(.*?)</span>', finding_sections(run))
    assert labels == list(TRIAGES)
    assert Parsed(chips(findings_of(run))).text == "".join(f"1 {triage}" for triage in TRIAGES)


def test_a_run_without_findings_that_must_be_fixed_says_so():
    assert "nothing must be fixed" in Parsed(chips(findings_of(run_of_overhangs(["supported"])))).text


def test_regions_of_one_part_and_kind_are_one_group_of_rows():
    thread = [overhang(f"overhang {k} of screw", "self-supporting", part="screw") for k in range(120)]
    page = Parsed(finding_sections(run_of([*thread, overhang("other", part="nut")])))
    assert len(page.classes("findings")) == 2
    assert sum("data-at" in attributes for _, attributes in page.tags) == 121
    assert "screw: 120 ledges" in page.text


@examples(30)
@given(st.text(st.characters(exclude_categories=("Cs",)), max_size=20))
def test_no_name_changes_the_structure_of_the_sections(name):
    tags, harmless = (
        Parsed(finding_sections(run_of([overhang(each, part=each, kind=each)]))).tags
        for each in (name, "harmless")
    )
    assert tags == harmless


def test_names_and_verdicts_are_escaped():
    page = finding_sections(run_of([overhang(EVIL, part=EVIL)]))
    assert "<script" not in page
    assert EVIL in Parsed(page).text


@pytest.mark.parametrize("groups", [1, 40, 900])
def test_a_build_of_ten_thousand_regions_has_a_page_of_limited_size_that_says_where_the_rest_is(groups):
    regions = [overhang(f"overhang {k}", "must fix", part=f"part {k % groups}") for k in range(10_000)]
    page = Parsed(finding_sections(run_of(regions)))
    rows = sum("data-at" in attributes for _, attributes in page.tags)
    each, shown = min(max(MOST_ROWS // groups, ROWS_EACH[0]), ROWS_EACH[1]), min(groups, MOST_GROUPS)
    assert rows == shown * each <= MOST_ROWS
    assert page.text.count("in the JSON report") == shown + (groups > shown)
    assert f"Must fix ({10_000:,})" in page.text


def test_the_whole_page_of_a_large_build_is_small_and_marks_are_limited():
    regions = [overhang(f"overhang {k}", "must fix", part=f"part {k % 100}") for k in range(10_000)]
    small, large = (len(html_text(run_of(some))) for some in (regions[:1], regions))
    assert large - small < 2_500_000


def test_the_reasons_of_a_section_are_explained_once_and_no_others():
    def with_reasons(name, *reasons):
        return replace(overhang(name, "must fix"), reasons=reasons)

    regions = [with_reasons("a", "enclosed", "capacity"), with_reasons("b", "enclosed")]
    text = Parsed(finding_sections(run_of(regions))).text
    assert text.count(f"enclosed: {REASONS['enclosed']}") == 1
    assert "capacity: " in text
    assert "no free voxel below" not in text


def test_columns_without_figures_are_left_out():
    assert "<th class=number>Limit mm" in finding_sections(run_of([overhang("a", size=2.0, limit=1.0)]))
    assert "Limit mm" not in finding_sections(run_of([overhang("a")]))


def test_rows_say_their_build_only_if_there_are_several():
    assert "Build</th>" not in finding_sections(run_of_overhangs(["supported"]))
    assert "Build</th>" in finding_sections(run_of_overhangs(["supported"], builds=2))


def test_a_row_knows_its_place_for_the_view():
    page = Parsed(finding_sections(run_of([overhang("a", position=(1.0, 2.5, 3.0))], builds=2)))
    rows = [attributes for _, attributes in page.tags if "data-at" in attributes]
    places = [(attributes["data-build"], attributes["data-at"]) for attributes in rows]
    assert places == [("0", "1.000 2.500 3.000"), ("1", "1.000 2.500 3.000")]


def test_search_is_hidden_until_the_script_shows_it():
    page = Parsed(finding_sections(run_of_overhangs(["supported"])))
    (attributes,) = [found for _, found in page.tags if found.get("id") == "search"]
    assert "hidden" in attributes
