"""All that a plugin author must read: the five hooks, the offer records and the `hookimpl` marker.

A plugin is a Python module (or package) named in the entry point group ``amprep``. It states the hook API it
was written for and yields offers; the job picks an offer by name::

    from amprep.hookspecs import Packer, PackerAccepts, hookimpl

    amprep_api = 1

    @hookimpl
    def amprep_packers():
        yield Packer("my-packer", "What it does, in a line.", run=my_run, accepts=PackerAccepts())
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import pluggy

from amprep.model.bounding_volume import BoundingVolume
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
"""Version of the hooks and offer records; a plugin states the one it was written for as ``amprep_api``."""

ENTRY_POINT_GROUP = "amprep"

hookimpl = pluggy.HookimplMarker("amprep")
_hookspec = pluggy.HookspecMarker("amprep")


@dataclass(frozen=True)
class NoParams:
    """The parameters of an offer that has none."""


def later(where: str) -> Callable[..., Any]:
    """Return the function ``"package.module:name"``, imported when it is first called.

    An offer's module is loaded by every command; what its algorithm needs (numba, a solver) takes seconds.
    """
    module, _, name = where.partition(":")

    def call(*args: Any, **kwargs: Any) -> Any:
        return getattr(import_module(module), name)(*args, **kwargs)

    return call


class ReadMeshes(Protocol):
    """Reads one file. Raises `amprep.errors.InputError` when it cannot."""

    def __call__(self, path: Path, *, params: Any) -> list[Part]: ...


class MakeVolume(Protocol):
    """Makes a bounding volume that contains the part as a solid."""

    def __call__(
        self, part: Part, *, params: Any, rng: np.random.Generator, stop: Stop
    ) -> BoundingVolume: ...


class Pack(Protocol):
    """Places items; every item ends in exactly one build or in `unplaced`."""

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
    """Routes every red square that has a way to the plate; lists the others with a reason."""

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
    """Replaces edges by geometry."""

    def __call__(self, request: CellRequest, *, params: Any, stop: Stop, progress: Progress) -> Cells: ...


@dataclass(frozen=True)
class PackerAccepts:
    """What a packer can handle; the host refuses a job that asks for more.

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
    """Offers to read files with certain suffixes (lower case, with the dot)."""

    name: str
    summary: str
    run: ReadMeshes
    suffixes: tuple[str, ...]
    params: type = NoParams


@dataclass(frozen=True)
class VolumeMaker:
    """Offers a kind of bounding volume; `makes` is one of the words of `PackerAccepts.volumes`."""

    name: str
    summary: str
    run: MakeVolume
    makes: str = "box"
    params: type = NoParams


@dataclass(frozen=True)
class Packer:
    """Offers a packing algorithm."""

    name: str
    summary: str
    run: Pack
    accepts: PackerAccepts = field(default_factory=PackerAccepts)
    params: type = NoParams


@dataclass(frozen=True)
class SupportRouter:
    """Offers a support routing algorithm."""

    name: str
    summary: str
    run: RouteSupports
    params: type = NoParams


@dataclass(frozen=True)
class CellEmitter:
    """Offers a lattice cell.

    `material` tells routers what an edge costs: given the frame's pitch and step and the checked params it
    returns the mm3 of a vertical and of an oblique edge; None counts both as one full prism. `declare`, given the
    same, returns the cell's declaration, if it has one: `amprep.cells.cell_offer` fills it in.
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
