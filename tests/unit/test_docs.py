"""Every hook has a test and a page; every key of a job file is documented with its default."""

import ast
import re
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

import pytest
from tests.shared.optional import present

from amprep.host import KINDS
from amprep.job.loading import KEYS
from amprep.job.settings.cells import CellSettings
from amprep.job.settings.job import ReadingSettings
from amprep.job.settings.packing import PackingSettings
from amprep.job.settings.parts import PartSettings
from amprep.job.settings.rules import RuleSettings
from amprep.job.settings.supports import SupportSettings
from amprep.model.supports import REASONS
from amprep.model.supports.rules import OverhangRules, SectionRules
from amprep.printers.catalogue import PrinterProfile

ROOT = Path(__file__).parents[2]
PAGES = sorted(
    [
        *ROOT.glob("*.md"),
        *ROOT.glob("docs/**/*.md"),
        *ROOT.glob("plugins/*/*.md"),
        *ROOT.glob("fixtures/**/*.md"),
    ]
)
BASES = (ROOT, ROOT / "src" / "amprep")
FILES = {path.name for base in ("src", "tests", "fixtures", "plugins") for path in (ROOT / base).rglob("*")}
PATH = re.compile(r"`([\w.*-]+(?:/[\w.*-]+)*/?)`")
OF_THE_READER = re.compile(
    r"(NAME|job|bracket|plate)\.|.*\bNAME\b|(out|dist)/$|\.\w+$|(post|settings)\.toml$|(amprep-)?batch(-job)?\.json$"
)
"""Paths of files that the reader makes, and suffixes."""
SECTIONS = {
    "`[packing]`": PackingSettings,
    "`[supports]`": SupportSettings,
    "`[cells]`": CellSettings,
    "`[reading]`": ReadingSettings,
    "`[[part]]`": PartSettings,
    "`[[rule]]`": RuleSettings,
    "Printers": PrinterProfile,
}
BY_OTHER_KEYS = {
    *("stacking", "enabled", "strut_angle_deg", "volume_params", "territory", "territory_margin_mm"),
    *("clearance_mm", "lift_mm", "blade_angle_deg", "drift_ratio", "drift_mm"),
    *(field.name for each in (OverhangRules, SectionRules) for field in fields(each)),
}


def python_blocks(page):
    """The Python examples of a page."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    return re.findall(r"```python\n(.*?)```", text, re.DOTALL)


def section(name):
    """The text of one section of the page about job files."""
    text = (ROOT / "docs" / "job-file.md").read_text(encoding="utf-8")
    return text.partition(f"## {name}\n")[2].partition("\n## ")[0]


def documented(text):
    """Key -> default, from a table."""
    return dict(re.findall(r"^\| `(\w+)` \| (.*?) \|", text, re.MULTILINE))


def named_paths(page):
    """The names in code style that are paths or names of files, outside of blocks of code."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    for name in PATH.findall(text):
        if ("/" in name or re.search(r"\.(py|toml|stl|md|json|html|3mf)$", name)) and not OF_THE_READER.match(
            name
        ):
            yield name


def is_there(name, page):
    """Whether a path exists from the root, from the package or from the page; a bare name may be in any folder."""
    found = any(any(base.glob(name.rstrip("/"))) for base in (*BASES, page.parent))
    return found or ("/" not in name and name in FILES)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_path_that_a_page_names_exists(page):
    assert [name for name in named_paths(page) if not is_there(name, page)] == []


def heading_anchors(page):
    """The anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_link_of_a_page_leads_to_a_file_and_a_heading(page):
    for target, anchor in re.findall(r"\]\(([^)#\s]*)#?([^)\s]*)\)", page.read_text(encoding="utf-8")):
        if not target.startswith(("http:", "https:")):
            linked = page.parent / target if target else page
            assert linked.exists(), target
            assert not anchor or anchor in heading_anchors(linked), f"{target}#{anchor}"


@pytest.mark.parametrize("hook", [description.hook for description in KINDS.values()])
def test_every_hook_is_documented_and_tested(hook):
    assert f"`{hook}()`" in (ROOT / "docs" / "plugins.md").read_text(encoding="utf-8")
    tests = [path for path in (ROOT / "tests").rglob("test_*.py") if path.name != Path(__file__).name]
    assert any(hook in path.read_text(encoding="utf-8") for path in tests), (
        f"no test yields an offer by {hook}"
    )


def test_every_key_at_the_top_is_documented():
    keys = documented(section("Top level"))
    assert set(keys) | {"packing", "supports", "cells", "reading", "part", "rule"} == set(KEYS)


@pytest.mark.parametrize("name", SECTIONS)
def test_every_key_of_a_section_is_documented_and_no_other(name):
    assert set(documented(section(name))) == {field.name for field in fields(SECTIONS[name])}


@pytest.mark.parametrize("name", SECTIONS)
def test_documented_defaults_are_the_real_ones(name):
    keys = documented(section(name))
    for field in fields(SECTIONS[name]):
        plain = field.default is not MISSING and field.default not in (None, "", ())
        if plain and field.name not in BY_OTHER_KEYS:
            shown = f'"{field.default}"' if isinstance(field.default, str) else str(field.default)
            if isinstance(field.default, tuple):
                shown = f"[{', '.join(f'{value:g}' for value in field.default)}]"
            assert f"`{shown.lower() if isinstance(field.default, bool) else shown}`" in keys[field.name], (
                field.name
            )


def test_the_job_file_in_the_page_is_a_job_file(tmp_path):
    from amprep.job import load_job

    example = re.search(
        r"```toml\n(.*?)```", (ROOT / "docs" / "job-file.md").read_text(encoding="utf-8"), re.DOTALL
    )
    path = tmp_path / "example.toml"
    path.write_text(present(example).group(1), encoding="utf-8")
    job = load_job(path)
    assert (job.packing.clearance_mm, job.supports.overhang_angle_deg, job.inputs[0].quantity) == (3, 40, 4)


TETRAHEDRON = "0 0 0 0 9 0 9 0 0\n0 0 0 9 0 0 0 0 9\n0 0 0 0 0 9 0 9 0\n9 0 0 0 9 0 0 0 9\n"


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_the_plugins_in_the_page_keep_every_promise(tmp_path, kind):
    from amprep.testing import try_plugin

    hook = KINDS[kind].hook
    (source,) = [
        block for block in python_blocks("plugins.md") if f"def {hook}" in block and "return" in block
    ]
    path = tmp_path / f"page_{kind}.py"
    path.write_text(source, encoding="utf-8")
    sample = tmp_path / "sample.tri"
    sample.write_text(TETRAHEDRON, encoding="utf-8")
    (report,) = try_plugin(str(path), samples=[sample])
    assert (report.kind, report.violations) == (kind, ())


def test_the_example_of_the_page_about_python_runs(tmp_path, monkeypatch):
    import shutil

    for name in ("table.stl", "two-balls.stl"):
        shutil.copy(ROOT / "fixtures" / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for block in python_blocks("python.md"):
        exec(compile(block, "docs/python.md", "exec"), names)
    assert (tmp_path / "out" / "example.build-1.3mf").is_file()


def test_the_example_of_the_page_about_filled_regions_runs(tmp_path, monkeypatch):
    import shutil

    shutil.copy(ROOT / "fixtures" / "wheel.3mf", tmp_path)
    monkeypatch.chdir(tmp_path)
    for block in python_blocks("lattice.md"):
        exec(compile(block, "docs/lattice.md", "exec"), {})
    assert list((tmp_path / "out").glob("wheel*.3mf"))


PUBLIC = {
    "amprep",
    "amprep.testing",
    "amprep.hookspecs",
    "amprep.model",
    "amprep.cells",
    "amprep.errors",
    "amprep.workers",
}


def public_sources():
    """Name -> Python code that may use the public modules only: plugins, templates, and examples in pages."""
    for path in [*(ROOT / "plugins").rglob("*.py"), *(ROOT / "src/amprep/templates").glob("*.py.template")]:
        yield path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8").replace("${module}", "own")
    for page in sorted(path.name for path in (ROOT / "docs").glob("*.md")):
        for number, block in enumerate(python_blocks(page)):
            yield f"docs/{page}, example {number + 1}", block


@pytest.mark.parametrize("name", sorted(dict(public_sources())))
def test_plugins_templates_and_examples_import_public_modules_only(name):
    imported, source = set(), dict(public_sources())[name]
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            imported |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            imported |= (
                {f"amprep.{alias.name}" for alias in node.names if f"amprep.{alias.name}" in PUBLIC}
                if node.module == "amprep"
                else {node.module}
            )
    assert {module for module in imported if module.split(".")[0] == "amprep"} <= PUBLIC


def test_the_page_about_python_names_the_stable_modules_and_every_function():
    import amprep

    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    assert set(re.findall(r"^\| `(amprep[.\w]*)` \|", text, re.MULTILINE)) == PUBLIC
    functions = {name for name in amprep.__all__ if name[0].islower()}
    assert set(re.findall(r"^\| `(\w+)\(", text, re.MULTILINE)) == functions


def test_every_name_that_the_page_about_plugins_gives_to_a_public_module_exists():
    import importlib

    text = (ROOT / "docs" / "plugins.md").read_text(encoding="utf-8")
    for module, name in re.findall(r"`(amprep(?:\.\w+)*)\.(\w+)(?:\(\w*\))?`", text):
        assert f"{module}.{name}" in PUBLIC or hasattr(importlib.import_module(module), name)


def test_the_declared_cells_in_the_page_can_be_printed_and_emptied(tmp_path):
    from amprep.host import Host
    from amprep.pipeline.check_cell import check_cell
    from amprep.pipeline.resolve import cell_named

    text = (ROOT / "docs" / "plugins.md").read_text(encoding="utf-8")
    (source,) = [
        block for block in re.findall(r"```python\n(.*?)```", text, re.DOTALL) if "ImplicitCell" in block
    ]
    path = tmp_path / "page_declared.py"
    path.write_text(source, encoding="utf-8")
    host = Host.load_one(str(path))
    for name in ("footed-pin", "schwarz-p"):
        assert check_cell(cell_named(host, name), steps=16).violations == ()


def test_the_cell_in_the_page_about_cells_passes_its_check(tmp_path):
    from amprep.host import Host
    from amprep.pipeline.check_cell import check_cell
    from amprep.pipeline.resolve import cell_named

    text = (ROOT / "docs" / "cells.md").read_text(encoding="utf-8")
    (source,) = [
        block for block in re.findall(r"```toml\n(.*?)```", text, re.DOTALL) if "[[variant]]" in block
    ]
    path = tmp_path / "tripod.toml"
    path.write_text(source, encoding="utf-8")
    host = Host.load(plugins_enabled=False)
    assert check_cell(cell_named(host, str(path)), steps=16).violations == ()


def test_every_parameter_of_a_built_in_cell_is_on_the_page():
    from amprep.host import Host

    text = (ROOT / "docs" / "cells.md").read_text(encoding="utf-8")
    for name, listed in Host.load(plugins_enabled=False).offers("cell").items():
        assert f"| `{name}` |" in text
        for field in fields(listed.offer.params):
            assert f"`{field.name}`" in text, f"{name}: {field.name}"


def test_the_page_about_supports_explains_every_reason_in_the_words_of_the_code():
    page = (ROOT / "docs" / "supports.md").read_text(encoding="utf-8")
    rows = re.findall(
        r"^\| `([^`]+)` \| (.+) \|$", page.partition("| reason |")[2].partition("\n\n")[0], re.M
    )
    assert dict(rows) == REASONS


def test_the_example_of_the_page_about_inspection_runs(monkeypatch):
    monkeypatch.chdir(ROOT / "fixtures")
    for block in python_blocks("inspect.md"):
        exec(compile(block, "docs/inspect.md", "exec"), {})


def test_the_page_about_packing_states_the_budgets_of_every_level_of_effort():
    from amprep.plugins.packers import amprep_packers
    from amprep.plugins.packers.separation import DEFAULT_WORK

    page = (ROOT / "docs" / "packing.md").read_text(encoding="utf-8")
    row = re.compile(r"^\| `([\w-]+)` \| `(\w+)` \| (\d+) \| (\d+) \| (\d+)(.*) \|$", re.MULTILINE)
    stated = {
        packer: (budget, *map(float, levels), more) for packer, budget, *levels, more in row.findall(page)
    }
    offers = {offer.name: offer for offer in amprep_packers() if offer.efforts and offer.name != "auto"}
    assert set(stated) == set(offers)
    for name, (budget, fast, normal, thorough, more) in stated.items():
        default = getattr(offers[name].params(), budget)
        assert (DEFAULT_WORK if default is None else default) == normal
        further = {key: int(value) for key, value in re.findall(r"`(\w+)` (\d+)", more)}
        assert offers[name].efforts == {"fast": {budget: fast}, "thorough": {budget: thorough, **further}}
