"""Make a new plugin package from the templates of amprep."""

import keyword
import os
import re
import shutil
import sys
from pathlib import Path
from string import Template

from amprep.errors import PluginError, nearest_hint
from amprep.files import make_temporary_folder, remove_abandoned
from amprep.host.offers import KINDS

TEMPLATES = Path(__file__).parent.parent / "templates"
_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")
_CHOICE = {
    "packer": '[packing]\n    strategy = "{offer}"',
    "cell": '[cells]\n    strategy = "{offer}"',
    "router": '[supports]\n    strategy = "{offer}"',
    "volume": '[packing]\n    volumes = "{offer}"',
    "reader": '[reading.readers]\n    ".triangles" = "{offer}"',
}


def make_plugin(name: str, kind: str, output: Path) -> Path:
    """Make a plugin that works and whose tests pass in the folder `output`/`name`, and return this folder.

    The folder appears when all files are in it. Before, it is inside a hidden folder, which the next call removes if
    this one is killed.

    Raises
    ------
    PluginError
        When the name or the kind is not allowed, or the folder exists.
    """
    if kind not in _CHOICE:
        raise PluginError(f"no kind of offer is called {kind!r}{nearest_hint(kind, _CHOICE)}")
    module = _module_name(name)
    offer = name.removeprefix("amprep-")
    folder = output / name
    if folder.exists():
        raise PluginError(f"{folder} exists already; choose another name or folder")
    words = {
        "name": name,
        "module": module,
        "offer": offer,
        "kind": kind,
        "noun": next(each.noun for key, each in KINDS.items() if key == kind),
        "choice": _CHOICE[kind].format(offer=offer),
    }
    try:
        _make_at_once(folder, kind, module, words)
    except OSError as error:
        raise PluginError(f"{folder} cannot be made: {error.strerror or error}") from error
    return folder


def _make_at_once(folder: Path, kind: str, module: str, words: dict[str, str]) -> None:
    """Write all files of a plugin, and let its folder appear."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    remove_abandoned(folder.parent)
    hidden, lock = make_temporary_folder(folder.parent)
    try:
        _write(hidden / folder.name, kind, module, words)
        (hidden / folder.name).rename(folder)
    finally:
        shutil.rmtree(hidden, ignore_errors=True)
        if lock is not None:
            os.close(lock)


def _module_name(name: str) -> str:
    if not _NAME.fullmatch(name) or len(name) > 60:
        raise PluginError(
            f"the name of a plugin must be lower-case words with dashes, such as amprep-shelves, got {name!r}"
        )
    module = name.replace("-", "_")
    if keyword.iskeyword(module) or module == "amprep" or module in sys.stdlib_module_names:
        raise PluginError(f"{name!r} is taken by Python or amprep; choose another, such as amprep-{name}")
    return module


def _write(folder: Path, kind: str, module: str, words: dict[str, str]) -> None:
    files = {
        "pyproject.toml": "pyproject.toml.template",
        "README.md": "README.md.template",
        f"src/{module}/__init__.py": f"{kind}.py.template",
        f"tests/test_{module}.py": "test.py.template",
    }
    for target, template in files.items():
        text = (TEMPLATES / template).read_text(encoding="utf-8")
        _save(folder / target, Template(text).substitute(words))
    if kind == "reader":
        _save(
            folder / "tests" / "sample.triangles",
            (TEMPLATES / "sample.triangles").read_text(encoding="utf-8"),
        )


def _save(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
