"""Make the bounding volumes of parts by several makers, and measure and judge each of them."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from amprep.checks.volumes import check_volume
from amprep.errors import AmprepError
from amprep.hookspecs import VolumeMaker
from amprep.host import Chosen
from amprep.measures.bounding_volume import volume_of
from amprep.model import Part, Progress, Stop
from amprep.model.volume_meshes import box_mesh, meshes_of
from amprep.pipeline.packing.bounding import bound_part
from amprep.pipeline.resolve import ResolvedJob, choose_volumes
from amprep.report.inspection.record import InspectedPart, InspectedVolume

ALL = "all"
"""Word that stands for every volume maker."""


@dataclass(frozen=True, eq=False)
class MakerChain:
    """Volume makers, each of which bounds the solid of the one before; `asked` if the user named them."""

    makers: tuple[Chosen[VolumeMaker], ...]
    asked: bool

    @property
    def name(self) -> str:
        """Names of the makers, joined by commas."""
        return ",".join(maker.name for maker in self.makers)


def makers_named(resolved: ResolvedJob, words: Sequence[str]) -> tuple[MakerChain, ...]:
    """Return the chains of volume makers that words name: ``all``, a name, or ``A,B``; each chain once.

    Raises
    ------
    PluginError, JobError
        When a maker does not exist, or cannot be in its place.
    """
    named = {tuple(_names(word)) for word in words if word != ALL}
    chains = [
        (name,) if word == ALL else tuple(_names(word))
        for word in words
        for name in (resolved.host.offers("volume") if word == ALL else [word])
    ]
    return tuple(
        MakerChain(choose_volumes(resolved.host, resolved.job, chain), chain in named)
        for chain in dict.fromkeys(chains)
    )


def _names(word: str) -> list[str]:
    return [part.strip() for part in word.split(",")]


def warm_up(chains: Sequence[MakerChain], seed: int) -> None:
    """Bound a small part by each chain, so that compiling is not measured; failures do not matter here."""
    shape = box_mesh(np.zeros(3), np.array([3.0, 2.0, 1.0]))
    for chain in chains:
        try:
            bound_part(Part("warm-up", shape, shape.signed_volume), chain.makers, seed, Stop.after(10.0))
        except AmprepError:
            continue


def measure_volumes(
    parts: Sequence[InspectedPart], chains: Sequence[MakerChain], seed: int, stop: Stop, progress: Progress
) -> list[InspectedPart]:
    """Return the parts with their bounding volumes; a part that cannot be used stays without.

    Parameters
    ----------
    parts
        Parts, described.
    chains
        The makers to try.
    seed
        Seed of the random numbers of each maker.
    stop
        Asks makers to end early; when it is set, no further maker begins.
    progress
        Called before each volume.
    """
    total, found = len(parts) * len(chains), []
    for number, each in enumerate(parts):
        volumes = []
        for step, chain in enumerate(chains if each.contents is not None else ()):
            progress((number * len(chains) + step) / total, f"{each.name}: {chain.name}")
            if not _is_needless(chain, each.part):
                volumes.append(_measured(each.part, chain, seed, stop))
        found.append(replace(each, volumes=tuple(volumes)))
    return found


def _is_needless(chain: MakerChain, part: Part) -> bool:
    """Tell whether a chain takes boxes from the job, the job gives none, and the user did not ask for it."""
    return chain.name == "boxes" and part.boxes is None and not chain.asked


def _measured(part: Part, chain: MakerChain, seed: int, stop: Stop) -> InspectedVolume:
    if stop():
        return InspectedVolume(chain.name, failure="time limit")
    began = time.process_time()
    try:
        made = bound_part(part, chain.makers, seed, stop, refuse=False)
        seconds = time.process_time() - began
        volume = volume_of(made.volume)
    except AmprepError as error:
        return InspectedVolume(chain.name, failure=" ".join(str(error).split()))
    return InspectedVolume(
        chain.name,
        made,
        volume_mm3=volume,
        ratio=volume / part.volume_mm3 if part.is_solid and part.volume_mm3 > 0.0 else None,
        triangles=sum(len(mesh.triangles) for mesh in meshes_of(made.volume)),
        seconds=seconds,
        violations=tuple(check_volume(part, made)),
    )
