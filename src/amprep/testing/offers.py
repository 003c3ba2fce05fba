"""Run one offer by itself, as the host runs it in a job."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from amprep.hookspecs import CellEmitter
from amprep.host import Chosen, Host, Kind
from amprep.model import Progress, Stop, silent
from amprep.pipeline.resolve import cell_named

SEED = 20
"""Default seed of the random numbers."""

_ARGUMENTS: Mapping[Kind, tuple[str, ...]] = {
    "reader": (),
    "volume": ("rng", "stop"),
    "packer": ("rng", "stop", "progress"),
    "router": ("rng", "stop", "progress"),
    "cell": ("stop", "progress"),
}
"""Arguments that an offer of each kind takes besides its subject and its parameters."""


class LoadedOffer(Chosen[Any]):
    """An offer with its checked parameters, run as the host runs it in a job."""

    def run(
        self, subject: Any, *, seed: int = SEED, stop: Stop | None = None, progress: Progress = silent
    ) -> Any:
        """Run the offer and return its result.

        Parameters
        ----------
        subject
            Input of the offer: a `PackingProblem` (packer), a `SupportProblem` (router), a `CellRequest`
            (cell), a `Part` (volume maker) or a `Path` (reader).
        seed
            Seed of the random numbers.
        stop
            Tells the offer to end early; None never does.
        progress
            Called with the fraction that is done and a message.

        Raises
        ------
        PluginError
            When the offer fails, returns something of the wrong type, or is a packer that does not accept the
            problem.
        """
        if self.listed.kind == "packer":
            self.host.refuse_mismatch(self.listed, subject)
        given = {"rng": np.random.default_rng(seed), "stop": stop or Stop(), "progress": progress}
        return self.call(subject, **{name: given[name] for name in _ARGUMENTS[self.listed.kind]})

    def material(self, pitch: float, step: float) -> tuple[float, float]:
        """Return the volume (mm3) of a vertical and an oblique edge that a lattice cell estimates.

        Parameters
        ----------
        pitch, step
            Width and height of a voxel of the support grid, mm.
        """
        return self.host.material(self.listed, pitch, step, self.params)

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of shape in the declaration of a lattice cell, such as ``graph``; empty without a declaration."""
        offer = self.listed.offer
        if not isinstance(offer, CellEmitter) or offer.declare is None:
            return ()
        return self.host.declared(self.listed, 2.0, 2.0, self.params).kinds


def load_offer(
    kind: Kind, name: str | Path, *, plugin: str | None = None, params: Mapping[str, Any] | None = None
) -> LoadedOffer:
    """Load a plugin and return one of its offers.

    Parameters
    ----------
    kind
        ``packer``, ``router``, ``cell``, ``volume`` or ``reader``.
    name
        Name of the offer; a lattice cell may also be the path of a file that declares it.
    plugin
        Installed plugin, importable module or path of a module; None for the built-in plugins.
    params
        Parameters of the offer; those left out have their defaults.

    Raises
    ------
    PluginError
        When the plugin cannot be loaded, or has no such offer.
    JobError
        When a parameter is unknown or has a wrong value.
    InputError
        When the file declares no cell.

    Examples
    --------
    >>> from amprep.testing import load_offer, packing_problems
    >>> rows = load_offer("packer", "extreme-points", params={"restarts": 2})
    >>> title, problem = next(packing_problems())
    >>> len(rows.run(problem).builds)
    1
    """
    host = Host.load(plugins_enabled=False) if plugin is None else Host.load_one(plugin)
    listed = cell_named(host, str(name)).listed if kind == "cell" else host.choose(kind, str(name))
    return LoadedOffer.of(host, listed, params or {})
