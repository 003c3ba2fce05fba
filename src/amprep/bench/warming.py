"""Compile the kernels before they are needed, for ``amprep warm-up``."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from amprep.api.build_file import verify
from amprep.api.inspection import inspect
from amprep.api.orientation import orient
from amprep.api.whole_job import fill_parts, support
from amprep.errors import AmprepError
from amprep.geometry.bounding.simplification.solids import united
from amprep.host import Host
from amprep.model import Mesh, Stop
from amprep.model.volume_meshes import box_mesh
from amprep.pipeline.stages import Watcher
from amprep.stl import write_stl
from amprep.testing.conformance import try_offer
from amprep.testing.offers import LoadedOffer

# Strategy. A kernel is compiled for the types of its arguments when it is first called. So all offers solve the trial
# problems that judge plugins, and all kinds of connectors, bases and searches work on a small part, as in a job. What
# fails, such as a packer that needs a solver, is left out: nothing but compiling is asked here.

_Task = tuple[str, Callable[[Path, Path], Any]]


def warm_up(*, plugins: Host | Sequence[str] = (), watcher: Watcher, stop: Stop | None = None) -> None:
    """Compile the kernels that usual jobs need; files go to a temporary folder.

    Compiled code is kept in a cache, for each version of Python and each kind of processor.

    Parameters
    ----------
    plugins
        Plugin modules to load beside the installed plugins, by name or path.
    watcher
        Shows the stages.
    stop
        Ends the work early when it is set.
    """
    host = plugins if isinstance(plugins, Host) else Host.load(modules=plugins)
    with TemporaryDirectory(prefix="amprep-") as name, watcher.stage("compile") as progress:
        part, tasks = Path(name) / "table.stl", list(_tasks(host))
        write_stl(_table(), part)
        for number, (title, task) in enumerate(tasks):
            if stop is not None and stop():
                return
            progress(number / len(tasks), title)
            try:
                task(part, Path(name))
            except AmprepError:
                continue


def _tasks(host: Host) -> Iterator[_Task]:
    """Yield what is to be done with a part and a folder, and its title."""
    for kind in ("packer", "volume", "router", "cell"):
        for name, offer in host.offers(kind).items():
            yield f"{kind} {name}", partial(_try, LoadedOffer.of(host, offer, {}))
    for name in host.offers("cell"):
        yield f"cell {name} below a part", partial(_support, host, {"cells.strategy": name})
        yield f"cell {name} in a part", partial(_fill, host, name)
    for name in host.offers("router"):
        settings = {"supports.strategy": name, "cells.strategy": "prism"}
        yield f"router {name} below a part", partial(_support, host, settings)
    for end in ("teeth", "point", "extend"):
        yield f"connector {end}", partial(_support, host, {"cells.connector": end})
    for base in ("flange", "raft"):
        yield f"base {base}", partial(_support, host, {"cells.base": base})
    yield "bounding volumes", lambda part, _: inspect(part, volumes="all", plugins=host)
    yield "orientations", lambda part, _: orient(part, effort="thorough", plugins=host)
    yield "judges", _judge


def _try(offer: LoadedOffer, _part: Path, _folder: Path) -> None:
    try_offer(offer)


def _support(host: Host, settings: dict[str, Any], part: Path, folder: Path) -> None:
    support(part, output=folder, center=True, plugins=host, settings=settings)


def _fill(host: Host, cell: str, part: Path, folder: Path) -> None:
    settings = {"cells.strategy": cell}
    fill_parts(part, output=folder, shell_mm=0.5, size_mm=2.5, settings=settings, plugins=host)


def _judge(part: Path, folder: Path) -> None:
    verify(folder / f"{part.stem}.supported.3mf", removability=True)


def _table() -> Mesh:
    """Return a top on four legs: it has level overhangs, and edges over the plate."""
    solid = box_mesh(np.array((0.0, 0.0, 8.0)), np.array((12.0, 12.0, 12.0))).arrays
    for x in (0.0, 9.0):
        for y in (0.0, 9.0):
            leg = box_mesh(np.array((x, y, 0.0)), np.array((x + 3.0, y + 3.0, 9.0)))
            solid = united(solid, leg.arrays)
    return Mesh(*solid)
