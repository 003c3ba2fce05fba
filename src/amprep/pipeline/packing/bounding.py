"""Compute the bounding volume of each part with the volume makers that the job or the part names."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from amprep.arrays import Floats
from amprep.errors import PluginError
from amprep.hookspecs import PackerAccepts, VolumeMaker
from amprep.host import Chosen
from amprep.host.mismatch import narrowed
from amprep.model import BoundingVolume, Orientations, Part, Progress, Solid, Stop, TurnedVolume
from amprep.model.bounding_volume import as_turned
from amprep.pipeline.packing.judging import refuse_wrong_volume
from amprep.pipeline.reading import LoadedParts


def bound_parts(loaded: LoadedParts, stop: Stop, progress: Progress) -> list[TurnedVolume]:
    """Return one bounding volume per part, which its copies share.

    Raises
    ------
    PluginError, JobError
        When a volume maker fails, or does not exist.
    """
    resolved, volumes = loaded.resolved, []
    for index, part in enumerate(loaded.parts):
        progress(index / len(loaded.parts), part.name)
        volumes.append(bound_part(part, resolved.makers_for(part), resolved.job.seed, stop))
    return volumes


def bound_part(
    part: Part, makers: Sequence[Chosen[VolumeMaker]], seed: int, stop: Stop, *, refuse: bool = True
) -> TurnedVolume:
    """Return the bounding volume of one part.

    Parameters
    ----------
    part
        Part to bound.
    makers
        Volume makers; each bounds the solid of the one before.
    seed
        Seed of the random numbers of each maker.
    stop
        Asks the makers to end early.
    refuse
        Whether volumes of foreign makers that do not contain the part are refused; else the caller judges them.

    Raises
    ------
    PluginError
        When a maker fails, its volume is refused, or one before the last does not make a solid.
    """
    for number, maker in enumerate(makers, start=1):
        made: BoundingVolume | TurnedVolume = maker.call(part, rng=np.random.default_rng(seed), stop=stop)
        if refuse:
            refuse_wrong_volume(maker, part, made)
        if number < len(makers):
            part = _bounded_by(part, maker, made)
    return as_turned(made)


def offered_orientations(allowed: Orientations, turn: Floats, accepts: PackerAccepts) -> Orientations:
    """Return the rotations that a packer may give a volume, so that the part is in an allowed orientation.

    Parameters
    ----------
    allowed
        Orientations that the part allows.
    turn
        ``(3, 3)`` the rotation of the part in its volume, one of the allowed ones.
    accepts
        Orientations that the packer can handle.
    """
    if allowed.freedom == "list":
        return replace(allowed, matrices=allowed.matrices @ turn.T)
    return narrowed(allowed, accepts)


def _bounded_by(part: Part, maker: Chosen[VolumeMaker], made: Any) -> Part:
    """Return the part with a solid that contains it in place of its mesh."""
    if not isinstance(made, Solid):
        raise PluginError(
            f"{maker.listed.title} returned {type(made).__name__}, expected Solid, since another volume maker follows"
        )
    return replace(part, mesh=made.mesh, volume_mm3=made.mesh.signed_volume, is_solid=True)
