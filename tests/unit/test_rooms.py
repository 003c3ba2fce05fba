"""The layout of the source: folders, file names, imports, class names, and citations of the thesis."""

import ast
import re
from collections import Counter, defaultdict
from functools import cache
from pathlib import Path

import networkx as nx
import pytest

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src" / "amprep"
FILES = sorted(SOURCE.rglob("*.py"))
FOLDERS = sorted({path.parent for path in FILES})

MOST_FILES = 15
MOST_LINES = 400

SECTIONS = {
    "2.1": "Introduction of the Packing Problem",
    "2.2": "Solutions for the packing problem",
    "2.3": "Coverings with boxes",
    "2.4": "A heuristic algorithm for boxpacking",
    "2.5": "Mesh simplification, and collision based on nearly convex decomposition",
    "2.6": "Collision detection for packing meshes",
    "3.1": "Introduction of support planning",
    "3.2": "Problem formulation",
    "3.3": "Flow algorithms",
    "3.4": "Shortest paths algorithm",
    "3.5": "Support structures",
    "4": "Computational Experiments",
}
"""Table of contents of the thesis."""

SECTIONS_OF = {
    "plugins/packers/integer_program": {"2.2", "2.3"},
    "plugins/packers/sweep.py": {"2.2"},
    "plugins/packers/tabu.py": {"2.4"},
    "plugins/routers/shortest_paths.py": {"3.4"},
    "plugins/routers/min_cost_flow.py": {"3.3"},
    "plugins/routers/push_relabel.py": {"3.3"},
}
"""Sections that a file or folder may cite, because it implements just these."""


def name_of(path):
    return path.relative_to(SOURCE).as_posix()


@cache
def tree(path):
    return ast.parse(path.read_text(encoding="utf-8"))


def imported(path):
    """Names of the modules that a file imports, wherever in the file."""
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def modules(folder):
    return [path.stem for path in FILES if path.parent == folder and path.stem != "__init__"]


def test_no_folder_has_more_than_fifteen_files():
    counts = {name_of(folder): len(list(folder.glob("*.py"))) for folder in FOLDERS}
    assert {name: count for name, count in counts.items() if count > MOST_FILES} == {}


def test_no_file_name_begins_with_the_name_of_its_folder():
    assert [name_of(path) for path in FILES if path.stem.startswith(path.parent.name)] == []


def test_a_prefix_that_three_files_share_is_a_folder():
    shared: dict[str, int] = {}
    for folder in FOLDERS:
        counts = Counter(stem.split("_")[0] for stem in modules(folder) if "_" in stem)
        shared |= {f"{name_of(folder)}/{prefix}_": count for prefix, count in counts.items() if count >= 3}
    assert shared == {}


def test_no_file_is_longer_than_four_hundred_lines():
    lengths = {name_of(path): path.read_text(encoding="utf-8").count("\n") for path in FILES}
    assert {name: length for name, length in lengths.items() if length > MOST_LINES} == {}


@pytest.mark.parametrize(("package", "room"), [("numba", "kernels"), ("lib3mf", "threemf")])
def test_a_package_stays_in_its_room(package, room):
    users = {name_of(path) for path in FILES if package in {name.split(".")[0] for name in imported(path)}}
    assert users, f"nothing imports {package}: the test looks in the wrong place"
    strangers = sorted(name for name in users if not name.startswith(f"{room}/"))
    assert strangers == [], f"wrap what you need of {package} in amprep.{room}"


def test_no_private_name_is_imported_from_another_module():
    found = [
        f"{name_of(path)}: {node.module}.{alias.name}"
        for path in FILES
        for node in ast.walk(tree(path))
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("amprep")
        for alias in node.names
        if alias.name.startswith("_") and not alias.name.startswith("__")
    ]
    assert found == []


def test_a_class_name_means_one_thing():
    places = defaultdict(list)
    for path in FILES:
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.ClassDef):
                places[node.name.lstrip("_")].append(name_of(path))
    twice = {name: where for name, where in places.items() if len(where) > 1}
    assert twice == {}


def cited(text):
    """Sections in citations such as "thesis 3.2", "thesis 2.1 and 2.4"."""
    for match in re.finditer(r"[Tt]hesis(?:'s)? (\d(?:\.\d)?(?:(?:, | and )\d\.\d)*)", text):
        yield from re.findall(r"\d(?:\.\d)?", match.group(1))


def test_every_citation_of_the_thesis_is_in_its_table_of_contents():
    texts = [*FILES, *(ROOT / "docs").rglob("*.md")]
    pages = {
        path.relative_to(ROOT).as_posix(): set(cited(path.read_text(encoding="utf-8"))) for path in texts
    }
    chapters = {"2", "3", *SECTIONS}
    assert {page: found - chapters for page, found in pages.items() if found - chapters} == {}


@pytest.mark.parametrize("place", SECTIONS_OF)
def test_an_algorithm_cites_its_own_section(place):
    files = [path for path in FILES if name_of(path).startswith(place)]
    found = {section for path in files for section in cited(path.read_text(encoding="utf-8"))}
    assert found <= SECTIONS_OF[place]
    assert found, f"{place} does not name its source"


TESTS_OF_SEVERAL = {
    "cli/test_help.py": "all commands",
    "host/test_choosing.py": "choice by the manager, with its mismatches and offers",
    "job/test_mistakes.py": "what a job file must not say, in whichever section",
    "job/test_properties.py": "any job file, whichever section it has",
    "plugins/cells/test_built_in.py": "all built-in cells",
    "plugins/packers/integer_program/test_model.py": "variables and constraints, which one program holds",
    "plugins/packers/test_rows.py": "the rows that every packer ends with when it has no time",
    "plugins/readers/test_inputs.py": "inputs that every reader refuses",
    "plugins/routers/test_exact.py": "both exact routers",
    "report/test_documented.py": "every field of the reports",
    "slices/test_files.py": "the files of slices in all formats",
    "test_docs.py": "the pages of docs/",
    "test_fixtures.py": "the meshes of fixtures/",
    "test_glossary.py": "docs/glossary.md",
    "test_map.py": "docs/map.md",
    "test_rooms.py": "the layout of the source",
    "cli/test_main.py": "the entry point in cli/__init__.py",
    "test_words.py": "words that standard terms replace",
    "threemf/package/test_hostile.py": "packages that are made to do harm",
    "threemf/read/test_parts.py": "everything that a part of a 3MF job has",
    "threemf/write/test_generic.py": "the generic target, from skeleton to record",
    "threemf/write/test_programs.py": "files as other programs read them",
}
"""Tests of no single module, and of which several."""


def test_a_test_file_is_where_its_module_is_in_the_source():
    tests = ROOT / "tests" / "unit"
    found = [path.relative_to(tests) for path in sorted(tests.rglob("test_*.py"))]
    module_of = {path: SOURCE / path.parent / path.stem.removeprefix("test_") for path in found}
    lost = {
        path.as_posix()
        for path, module in module_of.items()
        if not module.is_dir() and not module.with_suffix(".py").is_file()
    }
    assert lost == set(TESTS_OF_SEVERAL)
    assert [path.as_posix() for path in found if not (SOURCE / path.parent).is_dir()] == []


def top_level_imports(path):
    """Modules that a file imports when it is loaded, and the packages that contain them."""
    own = ("amprep." + name_of(path).removesuffix(".py").replace("/", ".")).removesuffix(".__init__")
    for node in tree(path).body:
        module = node.module or "" if isinstance(node, ast.ImportFrom) else ""
        if not isinstance(node, ast.ImportFrom) or not module.startswith("amprep"):
            continue
        for target in (module, *(f"{module}.{alias.name}" for alias in node.names)):
            parts = target.split(".")
            for end in range(2, len(parts) + 1):
                package = ".".join(parts[:end])
                if not f"{own}.".startswith(f"{package}."):
                    yield package


def test_no_two_modules_import_each_other_while_they_load():
    """A module that is imported first must find complete modules, whichever module it is."""
    names = {
        ("amprep." + name_of(p).removesuffix(".py").replace("/", ".")).removesuffix(".__init__"): p
        for p in FILES
    }
    graph = nx.DiGraph()
    for name, path in names.items():
        graph.add_edges_from((name, target) for target in top_level_imports(path) if target in names)
    assert [sorted(circle) for circle in nx.strongly_connected_components(graph) if len(circle) > 1] == []
