"""The host: list the offers of all plugins, choose one by name, and guard every call."""

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, overload

from amprep import interruption, supervision, typed
from amprep.errors import AmprepError, InputError, Interrupted, PluginError, nearest_hint
from amprep.hookspecs import CellEmitter, MeshReader, Offer, Packer, SupportRouter, VolumeMaker
from amprep.host.answers import fault_of_answer
from amprep.host.loading import CHOSEN_BY_ENVIRONMENT, Source, built_in, given, installed, offers_of, one_line
from amprep.host.mismatch import mismatches
from amprep.host.offers import KINDS, Kind, Listed
from amprep.model.bounding_volume import BoundingVolume, TurnedVolume
from amprep.model.cell_shapes import DeclaredCell
from amprep.model.cells import Cells
from amprep.model.control import Stop
from amprep.model.packing import Packing, PackingProblem, require_values
from amprep.model.part import Part
from amprep.model.supports import SupportPlan


class Host:
    """The offers of all loaded plugins; every offer is run through its host.

    Attributes
    ----------
    warnings
        One line for each plugin that was refused and for each name that several plugins use.
    clashes
        The warnings about names that several plugins use.
    """

    def __init__(self, listed: Sequence[Listed[Offer]], warnings: Sequence[str] = ()) -> None:
        self.warnings: list[str] = list(warnings)
        self.clashes: list[str] = []
        self._listed: dict[Kind, dict[str, Listed[Offer]]] = {kind: {} for kind in KINDS}
        self._clashes: dict[tuple[Kind, str], list[Listed[Offer]]] = {}
        for each in listed:
            self._enter(each)
        self.warnings += self.clashes

    @classmethod
    def load(
        cls,
        *,
        modules: Sequence[str] = (),
        plugins_enabled: bool = True,
        env: Mapping[str, str] = os.environ,
    ) -> "Host":
        """Load the built-in plugins, the installed plugins, and further modules.

        Parameters
        ----------
        modules
            Names or paths of modules; ``no:NAME`` blocks a plugin by its name or its distribution.
        plugins_enabled
            Whether plugins other than the built-in ones are loaded.
        env
            Environment; ``AMPREP_LOAD_PLUGINS`` is a comma-separated list of the installed plugins to load.

        Raises
        ------
        PluginError
            When one of `modules` cannot be loaded. An installed plugin that cannot be loaded gives a warning.
        """
        blocked = [name.removeprefix("no:") for name in modules if name.startswith("no:")]
        asked = [name for name in modules if not name.startswith("no:")]
        if asked and not plugins_enabled:
            raise PluginError(f"'-p {asked[0]}' and '--no-plugins' contradict each other; leave one out")
        found, warnings = installed(env) if plugins_enabled else ([], [])
        sources = [*built_in(), *found]
        warnings += _not_blocked(blocked, sources)
        kept = [source for source in sources if not any(map(source.answers_to, blocked))]
        listed, refused = _load_all([*kept, *given(asked)])
        return cls(listed, [*warnings, *refused])

    @classmethod
    def load_one(cls, package: str) -> "Host":
        """Load the built-in plugins and one more: the installed plugin of that name, or else a module.

        Raises
        ------
        PluginError
            When it cannot be loaded, or one of its offers has the name of another offer.
        """
        found, _ = installed({CHOSEN_BY_ENVIRONMENT: package})
        asked = [replace(source, asked_for=True) for source in found] or given([package])
        host = cls(*_load_all([*built_in(), *asked]))
        if host.clashes:
            raise PluginError("; ".join(host.clashes))
        return host

    def offers(self, kind: Kind) -> Mapping[str, Listed[Offer]]:
        """Return the offers of a kind by name: built-in offers first, then in order of distribution."""
        return dict(self._listed[kind])

    @overload
    def choose(self, kind: Literal["reader"], name: str) -> Listed[MeshReader]: ...
    @overload
    def choose(self, kind: Literal["volume"], name: str) -> Listed[VolumeMaker]: ...
    @overload
    def choose(self, kind: Literal["packer"], name: str) -> Listed[Packer]: ...
    @overload
    def choose(self, kind: Literal["router"], name: str) -> Listed[SupportRouter]: ...
    @overload
    def choose(self, kind: Literal["cell"], name: str) -> Listed[CellEmitter]: ...
    @overload
    def choose(self, kind: Kind, name: str) -> Listed[Any]: ...

    def choose(self, kind: Kind, name: str) -> Listed[Any]:
        """Return the offer called `name`.

        Raises
        ------
        PluginError
            When no offer or several offers have this name.
        """
        table, noun = self._listed[kind], KINDS[kind].noun
        if (kind, name) in self._clashes:
            rivals = " and ".join(each.origin for each in self._clashes[kind, name])
            raise PluginError(f"{noun} {name!r} is offered by {rivals}; block one of them with '-p no:NAME'")
        if name not in table:
            raise PluginError(f"no {noun} is called {name!r}{nearest_hint(name, table)}")
        return table[name]

    def params(self, listed: Listed[Offer], table: Mapping[str, Any]) -> Any:
        """Return the parameters of an offer, made from a table of plain values.

        Raises
        ------
        JobError
            For an unknown key, a value of the wrong type, or a value out of bounds.
        """
        return self._guarded(
            listed,
            typed.make,
            listed.offer.params,
            table,
            f"parameters of {KINDS[listed.kind].noun} {listed.offer.name!r}",
        )

    @overload
    def call(self, listed: Listed[MeshReader], *args: Any, **kwargs: Any) -> list[Part]: ...
    @overload
    def call(
        self, listed: Listed[VolumeMaker], *args: Any, **kwargs: Any
    ) -> BoundingVolume | TurnedVolume: ...
    @overload
    def call(self, listed: Listed[Packer], *args: Any, **kwargs: Any) -> Packing: ...
    @overload
    def call(self, listed: Listed[SupportRouter], *args: Any, **kwargs: Any) -> SupportPlan: ...
    @overload
    def call(self, listed: Listed[CellEmitter], *args: Any, **kwargs: Any) -> Cells: ...

    def call(self, listed: Listed[Offer], *args: Any, **kwargs: Any) -> Any:
        """Run an offer and return its result.

        Raises
        ------
        PluginError
            When the plugin raises an exception other than an `AmprepError`, which is then the cause, or returns a
            value of the wrong type. A malformed value of a plugin that is not built in is refused, too.
        Interrupted
            When a signal ends the run while a plugin runs that is not built in.
        """
        result = self._guarded(listed, listed.offer.run, *args, **kwargs)
        wanted = KINDS[listed.kind].result
        if not isinstance(result, wanted):
            expected = " or ".join(each.__name__ for each in wanted)
            raise PluginError(f"{listed.title} returned {type(result).__name__}, expected {expected}")
        if wanted == (list,) and not all(isinstance(each, Part) for each in result):
            raise PluginError(f"{listed.title} returned a list with items that are not Part")
        fault = "" if listed.builtin or not args else fault_of_answer(listed.kind, args[0], result)
        if fault:
            raise PluginError(f"{listed.title} returned {fault}")
        return result

    def material(
        self, listed: Listed[CellEmitter], pitch: float, step: float, params: Any
    ) -> tuple[float, float]:
        """Return the volume (mm3) of a vertical and of an oblique edge; a full prism if the cell has no estimate.

        Raises
        ------
        PluginError
            When the estimate of the cell fails or is not two numbers.
        """
        if listed.offer.material is None:
            return pitch * pitch * step, pitch * pitch * step
        vertical, oblique = self._guarded(listed, _two_floats, listed.offer.material, pitch, step, params)
        return vertical, oblique

    def declared(self, listed: Listed[CellEmitter], pitch: float, step: float, params: Any) -> DeclaredCell:
        """Return the declaration of a cell for a grid; the cell must have one.

        Raises
        ------
        PluginError
            When the declaration fails or has the wrong type.
        """
        cell = self._guarded(listed, listed.offer.declare, pitch, step, params)
        if not isinstance(cell, DeclaredCell):
            raise PluginError(f"{listed.title} declares {type(cell).__name__}, expected DeclaredCell")
        return cell

    def refuse_mismatch(self, listed: Listed[Packer], problem: PackingProblem) -> None:
        """Refuse values that no packer handles, and a packer that cannot handle the problem; name packers that can.

        Raises
        ------
        JobError
            When the value of an item is negative, too large or not a number.
        PluginError
            When the packer cannot handle a part of the problem, which the message names.
        """
        require_values(problem)
        lacking = mismatches(listed.offer.accepts, problem)
        if not lacking:
            return
        packers = [each.offer for each in self._listed["packer"].values() if isinstance(each.offer, Packer)]
        able = [packer.name for packer in packers if not mismatches(packer.accepts, problem)]
        advice = f"choose {' or '.join(able)}" if able else "no installed packer can"
        raise PluginError(f"{listed.title} does not handle {', '.join(lacking)}; {advice}")

    def reader_for(self, path: Path, chosen: Mapping[str, str] | None = None) -> Listed[MeshReader]:
        """Return the reader for the suffix of a file: the chosen reader, or else the first one listed.

        Parameters
        ----------
        chosen
            Names of readers by suffix, from the job.

        Raises
        ------
        InputError
            When no reader knows the suffix.
        PluginError
            When the chosen reader does not exist.
        """
        suffix = path.suffix.lower()
        if chosen and suffix in chosen:
            return self.choose("reader", chosen[suffix])
        for each in self._listed["reader"].values():
            if isinstance(each.offer, MeshReader) and suffix in each.offer.suffixes:
                return self.choose("reader", each.offer.name)
        known = ", ".join(self.suffixes)
        raise InputError(
            f"{path}: no reader for {suffix or 'files without a suffix'!r}; known suffixes: {known}"
        )

    def read(
        self,
        path: Path,
        readers: Mapping[str, str],
        params: Mapping[str, Mapping[str, Any]],
        shared: Mapping[str, Any] = MappingProxyType({}),
    ) -> list[Part]:
        """Read one file with the reader of its suffix.

        Parameters
        ----------
        path
            File to read.
        readers
            Suffix to name of the reader; other suffixes have their default reader.
        params
            Name of a reader to its parameters.
        shared
            Parameters of every reader that has parameters of these names; `params` take precedence.

        Raises
        ------
        InputError
            When no reader knows the suffix, or the file cannot be read.
        PluginError, JobError
            When the reader does not exist or fails, or its parameters are wrong.
        """
        reader = self.reader_for(path, readers)
        names = {each.name for each in fields(reader.offer.params)} if reader.offer.params else set()
        own = {name: value for name, value in shared.items() if name in names}
        own |= params.get(reader.offer.name, {})
        return self.call(reader, path, params=self.params(reader, own))

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of all readers, sorted."""
        readers = [each.offer for each in self._listed["reader"].values()]
        return tuple(
            sorted({s for reader in readers if isinstance(reader, MeshReader) for s in reader.suffixes})
        )

    def _enter(self, listed: Listed[Offer]) -> None:
        name, table = listed.offer.name, self._listed[listed.kind]
        first = table.setdefault(name, listed)
        if first is listed:
            return
        both = f"{KINDS[listed.kind].noun} {name!r} is offered by {first.origin} and by {listed.origin}"
        if first.builtin:
            self.clashes.append(f"{both}; the built-in one is kept")
            return
        self.clashes.append(f"{both}; neither can be chosen until one is blocked with '-p no:NAME'")
        self._clashes.setdefault((listed.kind, name), [first]).append(listed)

    @staticmethod
    def _guarded(listed: Listed[Offer], run: Any, *args: Any, **kwargs: Any) -> Any:
        part = f" on part {args[0].name!r}" if args and isinstance(args[0], Part) else ""
        if listed.builtin:
            return _run(listed.title, part, run, *args, **kwargs)
        stop = kwargs.get("stop")
        with supervision.calling(listed.title, stop.deadline if isinstance(stop, Stop) else None):
            return _run(listed.title, part, run, *args, interruptible=True, **kwargs)


def _run(title: str, part: str, run: Any, *args: Any, interruptible: bool = False, **kwargs: Any) -> Any:
    """Call a function of a plugin; turn all that it raises into an error of one line that names the plugin."""
    try:
        return run(*args, **kwargs)
    except AmprepError:
        raise
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt) and not interruption.is_raised_by_code():
            if interruptible and interruption.received() is not None:
                raise Interrupted(f"interrupted while {title} ran; nothing was written") from error
            raise
        raise PluginError(f"{title} failed{part}: {one_line(error)}") from error


def _two_floats(material: Any, pitch: float, step: float, params: Any) -> tuple[float, float]:
    vertical, oblique = map(float, material(pitch, step, params))
    if not (0.0 <= vertical < math.inf and 0.0 <= oblique < math.inf):
        raise ValueError(f"volumes of edges must be finite and not negative, got {vertical:g}, {oblique:g}")
    return vertical, oblique


def _load_all(sources: Sequence[Source]) -> tuple[list[Listed[Offer]], list[str]]:
    """Load each source; return the offers, and a warning for each source that was refused."""
    listed: list[Listed[Offer]] = []
    warnings: list[str] = []
    seen: list[object] = []
    for source in sources:
        try:
            plugin, offers = _loaded(source, seen)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt) and not interruption.is_raised_by_code():
                loading = "" if source.builtin else f" while {source.title} was loaded"
                raise Interrupted(f"interrupted{loading}; nothing was written") from error
            reason = str(error) if isinstance(error, PluginError) else one_line(error)
            if source.asked_for:
                raise PluginError(f"{source.title} cannot be loaded: {reason}") from error
            warnings.append(f"{source.title} was not loaded: {reason}")
            continue
        seen.append(plugin)
        listed += [
            Listed(kind, offer, source.name, source.distribution, source.version, source.builtin)
            for kind, offer in offers
        ]
    return listed, warnings


def _loaded(source: Source, seen: Sequence[object]) -> tuple[object, list[tuple[Kind, Offer]]]:
    """Load a plugin; return it with its offers, none if it was seen before."""

    def load() -> tuple[object, list[tuple[Kind, Offer]]]:
        plugin = source.load()
        return plugin, [] if any(plugin is each for each in seen) else list(offers_of(plugin))

    if source.builtin:
        return load()
    with supervision.calling(source.title):
        return load()


def _not_blocked(blocked: Sequence[str], sources: Sequence[Source]) -> list[str]:
    known = [name for source in sources if not source.builtin for name in (source.name, source.distribution)]
    return [
        f"'-p no:{name}' blocks nothing: no such plugin is installed{nearest_hint(name, known)}"
        for name in blocked
        if not any(source.answers_to(name) for source in sources)
    ]
