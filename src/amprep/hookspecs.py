"""Hooks for plugins: the five hooks, the records of offers, and the marker `hookimpl`.

A plugin is a Python module or package in the entry point group ``amprep``. It states the version of the hooks and
yields offers; a job chooses an offer by name::

    from amprep.hookspecs import Packer, PackerAccepts, hookimpl

    amprep_api = 1

    @hookimpl
    def amprep_packers():
        yield Packer("my-packer", "Does something.", run=my_run, accepts=PackerAccepts())
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import pluggy

from amprep.model.bounding_volume import BoundingVolume, TurnedVolume
from amprep.model.cell_shapes import DeclaredCell
from amprep.model.cells import CellRequest, Cells
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.model.part import Part
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.validation import require_bounds

__all__ = [
    "API_VERSION",
    "ENTRY_POINT_GROUP",
    "CellEmitter",
    "EmitCells",
    "MakeVolume",
    "MeshReader",
    "NoParams",
    "Offer",
    "Pack",
    "Packer",
    "PackerAccepts",
    "ReadMeshes",
    "RouteSupports",
    "SupportRouter",
    "VolumeMaker",
    "amprep_cell_emitters",
    "amprep_mesh_readers",
    "amprep_packers",
    "amprep_support_routers",
    "amprep_volume_makers",
    "hookimpl",
    "later",
    "require_bounds",
]

API_VERSION = 1
"""Version of the hooks and the records of offers; a plugin states it as ``amprep_api``."""

ENTRY_POINT_GROUP = "amprep"

hookimpl = pluggy.HookimplMarker("amprep")
_hookspec = pluggy.HookspecMarker("amprep")


@dataclass(frozen=True)
class NoParams:
    """Parameters of an offer without parameters."""


def later(where: str) -> Callable[..., Any]:
    """Return a function that imports ``"package.module:name"`` when it is first called, and calls it.

    Every command imports the module of an offer. Slow imports (numba, a solver) should wait for the first call.
    """
    module, _, name = where.partition(":")

    def call(*args: Any, **kwargs: Any) -> Any:
        return getattr(import_module(module), name)(*args, **kwargs)

    return call


class ReadMeshes(Protocol):
    """Read one file; raise `amprep.errors.InputError` if this is impossible."""

    def __call__(self, path: Path, *, params: Any) -> list[Part]: ...


class MakeVolume(Protocol):
    """Return a bounding volume that contains the part as a solid.

    A maker that may choose an orientation among `Part.orientations` returns a `TurnedVolume`.
    """

    def __call__(
        self, part: Part, *, params: Any, rng: np.random.Generator, stop: Stop
    ) -> BoundingVolume | TurnedVolume: ...


class Pack(Protocol):
    """Place the items; every item is in exactly one build or in `unplaced`."""

    def __call__(
        self,
        problem: PackingProblem,
        *,
        params: Any,
        rng: np.random.Generator,
        stop: Stop,
        progress: Progress,
    ) -> Packing: ...


class RouteSupports(Protocol):
    """Route every reachable red square to the plate; list the others with a reason."""

    def __call__(
        self,
        problem: SupportProblem,
        *,
        params: Any,
        rng: np.random.Generator,
        stop: Stop,
        progress: Progress,
    ) -> SupportPlan: ...


class EmitCells(Protocol):
    """Replace edges by geometry."""

    def __call__(self, request: CellRequest, *, params: Any, stop: Stop, progress: Progress) -> Cells: ...


@dataclass(frozen=True)
class PackerAccepts:
    """Problems that a packer can handle; the host refuses a job that needs more.

    Attributes
    ----------
    volumes
        Among ``box`` (one box an item), ``boxes`` (several), ``convex``, ``solid``.
    orientations
        Among ``fixed`` (one rotation), ``axis`` (lists that map axes to axes), ``list`` (any list),
        ``about-z``, ``free``.
    """

    volumes: frozenset[str] = frozenset({"box"})
    objectives: frozenset[str] = frozenset({"builds"})
    orientations: frozenset[str] = frozenset({"fixed"})
    cylinder: bool = False
    zones: bool = False
    fixed: bool = False
    stacking: frozenset[bool] = frozenset({True, False})


@dataclass(frozen=True)
class MeshReader:
    """Offer of a reader for files with certain suffixes (lower case, with the dot)."""

    name: str
    summary: str
    run: ReadMeshes
    suffixes: tuple[str, ...]
    params: type = NoParams


@dataclass(frozen=True)
class VolumeMaker:
    """Offer of a maker of bounding volumes; `makes` is one of the words in `PackerAccepts.volumes`."""

    name: str
    summary: str
    run: MakeVolume
    makes: str = "box"
    params: type = NoParams


@dataclass(frozen=True)
class Packer:
    """Offer of a packing algorithm.

    Attributes
    ----------
    volumes
        Name of the volume maker of jobs that choose none.
    efforts
        Parameters by the levels ``fast`` and ``thorough`` of ``packing.effort``; ``normal`` means the defaults.
    """

    name: str
    summary: str
    run: Pack
    accepts: PackerAccepts = field(default_factory=PackerAccepts)
    params: type = NoParams
    volumes: str = "box"
    efforts: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)


@dataclass(frozen=True)
class SupportRouter:
    """Offer of a support routing algorithm."""

    name: str
    summary: str
    run: RouteSupports
    params: type = NoParams


@dataclass(frozen=True)
class CellEmitter:
    """Offer of a lattice cell.

    Attributes
    ----------
    material
        Function of pitch (mm), step (mm) and checked parameters that returns the volume (mm3) of a vertical and of an
        oblique edge, by which routers choose paths; None counts both as a full prism.
    declare
        Function of the same arguments that returns the declaration of the cell; None for a cell in code.
        `amprep.cells.cell_offer` sets it.
    """

    name: str
    summary: str
    run: EmitCells
    params: type = NoParams
    material: Callable[[float, float, Any], tuple[float, float]] | None = None
    declare: Callable[[float, float, Any], DeclaredCell] | None = None


Offer = MeshReader | VolumeMaker | Packer | SupportRouter | CellEmitter


@_hookspec
def amprep_mesh_readers() -> Iterable[MeshReader]:  # type: ignore[empty-body]
    """Yield readers that turn a file into parts, in millimetres."""


@_hookspec
def amprep_volume_makers() -> Iterable[VolumeMaker]:  # type: ignore[empty-body]
    """Yield makers of bounding volumes for the packers."""


@_hookspec
def amprep_packers() -> Iterable[Packer]:  # type: ignore[empty-body]
    """Yield packing algorithms."""


@_hookspec
def amprep_support_routers() -> Iterable[SupportRouter]:  # type: ignore[empty-body]
    """Yield support routing algorithms."""


@_hookspec
def amprep_cell_emitters() -> Iterable[CellEmitter]:  # type: ignore[empty-body]
    """Yield lattice cells."""
