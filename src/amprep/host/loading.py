"""Find plugins, load each by itself, and check its offers."""

import importlib
import importlib.util
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import Distribution, EntryPoint, distributions, entry_points
from itertools import islice
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import pluggy

from amprep import __version__, hookspecs
from amprep.errors import PluginError, nearest_hint
from amprep.hookspecs import API_VERSION, ENTRY_POINT_GROUP, Offer
from amprep.host.offers import KINDS, Kind, faults_of

BUILT_IN = (
    "amprep.plugins.readers",
    "amprep.plugins.volumes",
    "amprep.plugins.packers",
    "amprep.plugins.routers",
    "amprep.plugins.cells",
)
CHOSEN_BY_ENVIRONMENT = "AMPREP_LOAD_PLUGINS"

MOST_OFFERS = 1000
"""Largest number of offers of one hook; a hook that yields for ever ends there."""


@dataclass(frozen=True)
class Source:
    """A plugin that is not loaded yet: its origin, and a function that loads it."""

    name: str
    distribution: str
    version: str
    load: Callable[[], object]
    builtin: bool = False
    asked_for: bool = False

    @property
    def title(self) -> str:
        """Title for messages: ``plugin 'shelves' of amprep-shelves 1.2``."""
        return f"plugin {self.name!r}" + (
            f" of {self.distribution} {self.version}" if self.distribution else ""
        )

    def answers_to(self, name: str) -> bool:
        """Tell whether `name` is the name of this plugin or of its distribution."""
        return name in (self.name, self.distribution)


def built_in() -> list[Source]:
    """Return the built-in plugins; they are imported by name, because the host depends on no plugin."""
    return [Source(name, "amprep", __version__, _importer(name), builtin=True) for name in BUILT_IN]


def installed(environment: Mapping[str, str]) -> tuple[list[Source], list[str]]:
    """Return the installed plugins, in order of distribution and name, and warnings.

    If ``AMPREP_LOAD_PLUGINS`` is set, only the plugins or distributions in this list are returned.
    """
    points, warnings = _entry_points()
    found = sorted(map(_from_entry_point, points), key=_by_distribution)
    if CHOSEN_BY_ENVIRONMENT not in environment:
        return found, warnings
    wanted = [name.strip() for name in environment[CHOSEN_BY_ENVIRONMENT].split(",") if name.strip()]
    known = sorted({name for source in found for name in (source.name, source.distribution)})
    missing = [name for name in wanted if name not in known]
    warnings += [
        f"{CHOSEN_BY_ENVIRONMENT} names {name!r}, but no such plugin is installed{nearest_hint(name, known)}"
        for name in missing
    ]
    return [source for source in found if any(map(source.answers_to, wanted))], warnings


def given(modules: Sequence[str]) -> list[Source]:
    """Return the plugins given with ``-p``: names of modules, or paths of files or packages."""
    return [
        Source(Path(name).stem, "", "", _importer(name), asked_for=True)
        if _is_path(name)
        else Source(name, "", "", _importer(name), asked_for=True)
        for name in modules
    ]


def offers_of(plugin: object) -> Iterator[tuple[Kind, Offer]]:
    """Check a loaded plugin and yield its offers, each with its kind.

    If one offer is faulty, the whole plugin is refused. Every plugin has its own plugin manager, so that its faults do
    not affect other plugins.

    Raises
    ------
    PluginError
        When the plugin is faulty; the message does not name the plugin.
    """
    _require_api(plugin)
    manager = pluggy.PluginManager(ENTRY_POINT_GROUP)
    manager.add_hookspecs(hookspecs)
    _require_known_hooks(plugin, manager)
    manager.register(plugin)
    for kind, description in KINDS.items():
        caller = getattr(manager.hook, description.hook)
        if caller.get_hookimpls():
            yield from ((kind, offer) for offer in _taken(kind, caller()))


def one_line(error: BaseException) -> str:
    """Return an exception as ``ValueError: message`` in one line of at most 300 characters."""
    try:
        text = " ".join(str(error).split())
    except Exception:  # noqa: BLE001 the class of a stranger
        text = ""
    line = f"{type(error).__name__}: {text}" if text else type(error).__name__
    return line if len(line) <= 300 else line[:297] + "..."


def _taken(kind: Kind, results: list[Any]) -> list[Offer]:
    hook = KINDS[kind].hook
    if not results:
        raise PluginError(f"{hook} returned nothing; yield the offers, or return a list of them")
    offers = list(islice((offer for result in results for offer in result), MOST_OFFERS + 1))
    if len(offers) > MOST_OFFERS:
        raise PluginError(f"{hook} yields more than {MOST_OFFERS} offers")
    faults = [fault for offer in offers for fault in faults_of(kind, offer)]
    if faults:
        raise PluginError("; ".join(faults))
    names = [offer.name for offer in offers]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise PluginError(f"{hook} yields more than one offer named {', '.join(map(repr, twice))}")
    return offers


def _require_api(plugin: object) -> None:
    stated = getattr(plugin, "amprep_api", None)
    if stated is None:
        raise PluginError(
            f"it states no hook API version; expected 'amprep_api = {API_VERSION}' in the module"
        )
    if type(stated) is not int or stated != API_VERSION:
        raise PluginError(f"it was written for hook API {stated!r}, this amprep has {API_VERSION}")


def _require_known_hooks(plugin: object, manager: pluggy.PluginManager) -> None:
    known = [description.hook for description in KINDS.values()]
    hooks = [name for name in dir(plugin) if _is_hook(plugin, name, manager)]
    for name in hooks:
        if name not in known:
            raise PluginError(f"unknown hook {name!r}{nearest_hint(name, known)}")
        if manager.parse_hookimpl_opts(plugin, name) is None:
            raise PluginError(f"{name} lacks the decorator @hookimpl of amprep.hookspecs")
    if not hooks:
        raise PluginError(f"it has none of the hooks {', '.join(known)}")


def _is_hook(plugin: object, name: str, manager: pluggy.PluginManager) -> bool:
    if manager.parse_hookimpl_opts(plugin, name) is not None:
        return True
    value = getattr(plugin, name)
    imported = value is getattr(hookspecs, name, None)  # by "from amprep.hookspecs import *"
    return name.startswith("amprep_") and isinstance(value, FunctionType) and not imported


def _entry_points() -> tuple[list[EntryPoint], list[str]]:
    """Return the entry points of all installed packages, and a warning for each damaged list."""
    try:
        return list(entry_points(group=ENTRY_POINT_GROUP)), []
    except Exception:  # noqa: BLE001 the list of one package is damaged: read them one by one
        found: list[EntryPoint] = []
        warnings = []
        for distribution in distributions():
            try:
                found += distribution.entry_points.select(group=ENTRY_POINT_GROUP)
            except Exception as error:  # noqa: BLE001
                name, version = _identity(distribution)
                warnings.append(f"the entry points of {name} {version} cannot be read: {one_line(error)}")
        return found, warnings


def _from_entry_point(entry_point: EntryPoint) -> Source:
    name, version = _identity(entry_point.dist)
    return Source(entry_point.name, name, version, entry_point.load)


def _identity(distribution: Distribution | None) -> tuple[str, str]:
    """Return name and version of a package, or placeholders if its metadata is damaged."""
    try:
        name, version = (distribution.name, distribution.version) if distribution else (None, None)
    except Exception:  # noqa: BLE001 metadata may be damaged in any way
        name = version = None
    return name or "unknown distribution", version or "?"


def _by_distribution(source: Source) -> tuple[str, str]:
    return source.distribution.lower(), source.name


def _is_path(name: str) -> bool:
    return name.endswith(".py") or "/" in name or "\\" in name


def _importer(name: str) -> Callable[[], ModuleType]:
    return (lambda: _import_file(Path(name))) if _is_path(name) else (lambda: importlib.import_module(name))


def _import_file(path: Path) -> ModuleType:
    file = path / "__init__.py" if path.is_dir() else path
    if not file.is_file():
        raise FileNotFoundError(f"no Python module at {path}")
    file = file.resolve()
    name = file.parent.name if file.name == "__init__.py" else file.stem
    if name in sys.modules:
        return _loaded_before(name, file)
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise ImportError(f"{file} is not a Python module")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def _loaded_before(name: str, file: Path) -> ModuleType:
    module = sys.modules[name]
    if Path(getattr(module, "__file__", None) or "").resolve() != file:
        raise ImportError(f"another module called {name!r} is loaded already; rename the file")
    return module
