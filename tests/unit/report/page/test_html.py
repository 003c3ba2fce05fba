"""The HTML report is complete, works offline, is safe for all names, and the same each time."""

import base64
import hashlib
import json
import re
import zlib
from dataclasses import replace
from html.parser import HTMLParser
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.optional import present

from amprep.checks.violation import Violation
from amprep.measures.printing.estimate import PrintingEstimate
from amprep.model import Build, BuildSettings, BuildVolume, Mesh
from amprep.report.page.geometry import GeometryPack
from amprep.report.page.html import html_text, write_html
from amprep.report.record import BuildRecord, RunRecord, StageTime, UnconnectedSquare, UnplacedRecord

EVIL = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'&<!--"


class Tags(HTMLParser):
    """Collects tags with their attributes, and the text of scripts and styles."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.raw: list[tuple[str, str]] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        if self.cdata_elem in {"script", "style"}:
            self.raw.append((self.tags[-1][1].get("id") or self.cdata_elem, data))

    def raw_text(self, name: str) -> str:
        return "".join(data for key, data in self.raw if key == name)


def run_of(build: Build, name: str = "job") -> RunRecord:
    lost = UnconnectedSquare(name, name, name, (1, 1, 1), (0.0, 0.0, 0.0))
    entry = BuildRecord(
        build,
        name,
        name,
        unconnected=(lost,),
        verification=(Violation(name, name, name),),
        shared_supports=(name,),
    )
    return RunRecord(
        name,
        "0.1.0",
        1,
        name,
        "generic",
        (entry,),
        (UnplacedRecord(name, 1, name),),
        (StageTime(name, 1.0),),
        warnings=(name,),
        notes=(name,),
        settings={name: {name: name}},
    )


def renamed(build: Build, name: str) -> Build:
    part = replace(build.parts[0].part, name=name, part_number=name)
    placed = tuple(replace(each, label=name, part=part) for each in build.parts)
    bodies = tuple(replace(body, name=name) for body in build.supports)
    regions = tuple(replace(region, label=name, reason=name) for region in build.unsupported)
    return replace(
        build,
        settings=replace(build.settings, build_id=name),
        parts=placed,
        supports=bodies,
        unsupported=regions,
    )


def decoded(data: bytes, entry: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Decode a mesh as viewer/decode.js does."""
    n, m, start = entry["vertices"], 3 * entry["triangles"], entry["offset"]
    axes = []
    for axis in range(3):
        planes = np.frombuffer(data, np.uint8, 2 * n, start + 2 * n * axis).astype(np.int64).reshape(2, n)
        steps = np.cumsum(planes[0] + 256 * planes[1]) & 0xFFFF
        axes.append(entry["low"][axis] + steps / 65535 * (entry["high"][axis] - entry["low"][axis]))
    planes = np.frombuffer(data, np.uint8, 4 * m, start + 6 * n).astype(np.int64).reshape(4, m)
    folded = (planes << np.array([[0], [8], [16], [24]])).sum(axis=0)
    differences = np.where(folded & 1, -(folded >> 1) - 1, folded >> 1)
    return np.stack(axes, axis=1), np.cumsum(differences).reshape(-1, 3)


def test_the_page_refers_to_no_other_file_and_to_no_network(make_build):
    text = html_text(run_of(make_build()))
    for _, attributes in Tags(text).tags:
        assert not {"src", "srcset", "action", "data", "style"} & attributes.keys()
        assert (attributes.get("href") or "#").startswith("#")
    assert "@import" not in text
    assert "url(" not in Tags(text).raw_text("style")


def test_the_policy_allows_only_the_bundled_script_and_style(make_build):
    page = Tags(html_text(run_of(make_build())))
    policy = present(next(a["content"] for tag, a in page.tags if tag == "meta" and "http-equiv" in a))
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    viewer, tables, style = (
        "sha256-" + base64.b64encode(hashlib.sha256(page.raw_text(name).encode()).digest()).decode()
        for name in ("script", "tables", "style")
    )
    assert f"script-src '{viewer}' '{tables}';" in policy
    assert f"style-src '{style}';" in policy


def test_names_from_files_are_escaped_everywhere(make_build):
    harmless, evil = (Tags(html_text(run_of(renamed(make_build(), name), name))) for name in ("name", EVIL))
    assert evil.tags == harmless.tags
    assert json.loads(evil.raw_text("model"))["builds"][0]["parts"][0]["name"] == EVIL


@examples(25)
@given(st.text(st.characters(exclude_categories=()), max_size=30))
def test_no_name_changes_the_structure_of_the_page(name):
    empty = Build(BuildSettings(name, BuildVolume((10, 10, 10)), printer=name), ())
    tags = Tags(html_text(run_of(empty, name)).encode("utf-8", "replace").decode()).tags
    assert tags == Tags(html_text(run_of(replace(empty), "name"))).tags


def test_the_model_names_every_part_support_and_unsupported_region(make_build):
    build = make_build()
    page = Tags(html_text(run_of(build)))
    model = json.loads(page.raw_text("model"))
    shown = model["builds"][0]
    assert [part["name"] for part in shown["parts"]] == [placed.label for placed in build.parts]
    assert [body["name"] for body in shown["supports"]] == [body.name for body in build.supports]
    assert [mark["facts"][0] for mark in shown["marks"]] == ["enclosed"]
    np.testing.assert_allclose(shown["parts"][1]["matrix"], build.parts[1].matrix.ravel())


def test_geometry_is_decoded_from_the_page_and_shared_by_copies(make_build):
    build = make_build()
    page = Tags(html_text(run_of(build)))
    model = json.loads(page.raw_text("model"))
    data = zlib.decompress(base64.b64decode(page.raw_text("geometry")))
    parts = model["builds"][0]["parts"]
    assert parts[0]["mesh"] == parts[2]["mesh"] != parts[1]["mesh"]
    for placed, part in zip(build.parts, parts, strict=True):
        vertices, triangles = decoded(data, model["meshes"][part["mesh"]])
        np.testing.assert_allclose(vertices, placed.part.mesh.vertices, atol=20 / 65535)
        np.testing.assert_array_equal(triangles, placed.part.mesh.triangles)


@examples(50)
@given(st.integers(1, 40), st.integers(0, 60), st.integers(0, 2**32 - 1))
def test_any_mesh_is_decoded_to_half_a_step(corners, faces, seed):
    rng = np.random.default_rng(seed)
    mesh = Mesh(rng.normal(size=(corners, 3)) * [100.0, 1.0, 0.0], rng.integers(0, corners, (faces, 3)))
    pack = GeometryPack()
    pack.add(Mesh(np.zeros((0, 3)), np.zeros((0, 3))))
    entry = pack.entries[pack.add(mesh)] if pack.add(mesh) < len(pack.entries) else {}
    vertices, triangles = decoded(zlib.decompress(base64.b64decode(pack.base64())), entry)
    low, high = mesh.bounds
    assert (np.abs(vertices - mesh.vertices) <= 0.5001 * (high - low) / 65535).all()
    np.testing.assert_array_equal(triangles, mesh.triangles)


def test_the_same_record_gives_the_same_page(make_build, tmp_path):
    for name in ("a.html", "b.html"):
        write_html(run_of(make_build()), tmp_path / name)
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.html", "b.html"]


def test_a_run_without_builds_has_a_page():
    record = RunRecord("job", "0", 1, "MK4", "generic", unplaced=(UnplacedRecord("crane", 1, "too large"),))
    text = html_text(record)
    assert "crane" in text
    assert json.loads(Tags(text).raw_text("model"))["builds"] == []


def test_a_page_with_an_unknown_mass_says_how_to_get_it(make_build):
    run = run_of(make_build())
    unknown = replace(run.builds[0], printing=PrintingEstimate(800.0, None))
    text = html_text(replace(run, builds=(unknown,)))
    assert "unknown <small>no density: choose an alloy by --material</small>" in text


@pytest.mark.parametrize("shape", ["box", "cylinder"])
def test_the_model_contains_the_build_volume(make_build, shape):
    build = make_build()
    space = BuildVolume((200, 200, 100), shape, [[0, 0, 0]], [[5, 6, 7]])
    page = Tags(html_text(run_of(replace(build, settings=replace(build.settings, space=space)))))
    shown = json.loads(page.raw_text("model"))["builds"][0]["space"]
    assert shown == {"size": [200, 200, 100], "shape": shape, "zones": [[[0, 0, 0], [5, 6, 7]]]}


def test_a_page_without_scripts_says_that_only_the_view_is_missing(make_build):
    text = html_text(run_of(make_build()))
    assert "<noscript>The 3D view needs scripts; the tables below are complete.</noscript>" in text


def test_the_bundle_contains_the_licence_of_three_js_and_cannot_end_its_element():
    bundle = files("amprep.report").joinpath("viewer.bundle.js").read_text(encoding="utf-8")
    assert "Permission is hereby granted, free of charge" in bundle
    assert "three.js authors" in bundle
    assert not re.search(r"</script|<!--", bundle, re.IGNORECASE)
