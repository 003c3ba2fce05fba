"""Pack parts on as few plates as possible, and check every plate as polygons and on the meshes."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from amprep.bench.measuring import Spent, measured
from amprep.bench.packing.run import PackerRun
from amprep.checks.packing.pairs import PairCounts
from amprep.checks.packing.parts_placed import judge_placed
from amprep.checks.packing.shadows import check_shadows, shadow_of, shadows_of
from amprep.checks.packing.volumes_placed import check_packing
from amprep.errors import InputError
from amprep.host import Host
from amprep.host.chosen import Chosen
from amprep.job import PackingSettings
from amprep.model import BuildSettings, BuildVolume, PackingProblem, Part, PlacedPart, Stop
from amprep.model.packing import Packing
from amprep.model.rotations import parse_rotations
from amprep.pipeline.packing import packing_problem, placed_builds
from amprep.pipeline.packing.bounding import bound_part
from amprep.pipeline.reading import expand_inputs, read_all


@dataclass(frozen=True, eq=False)
class PlatesScene:
    """Parts to pack on plates.

    Attributes
    ----------
    parts
        The parts with their quantities and orientations.
    space
        The build volume above a plate, as high as the highest part can stand.
    clearance
        Least distance between parts and to the walls, mm.
    """

    parts: tuple[Part, ...]
    space: BuildVolume
    clearance: float

    @property
    def copies(self) -> int:
        """Number of parts, copies included."""
        return sum(part.quantity for part in self.parts)

    @property
    def shadow_area(self) -> float:
        """Area of the shadows of all copies as the parts are, mm2."""
        return float(sum(part.quantity * shadow_of(part, np.eye(3)).area() for part in self.parts))


@dataclass(frozen=True)
class PlatesResult:
    """The plates that a packer or another package found.

    Attributes
    ----------
    bound, bound_for
        Proven least number of plates, and what it applies to; None if there is none.
    filled
        Area of the placed shadows over that of all plates.
    seconds, process_seconds
        Time on the clock and of all threads, for packing alone.
    memory_mb
        Peak memory while packing, MiB; None where the system does not tell.
    check_seconds
        Processor time of the checks.
    pairs
        How the pairs of parts were judged on the meshes.
    faults
        Violations that the checks of bounding volumes, polygons and meshes found.
    """

    packer: str
    seed: int
    plates: int
    bound: float | None
    bound_for: str
    filled: float
    unplaced: int
    seconds: float
    process_seconds: float
    memory_mb: int | None
    check_seconds: float
    pairs: PairCounts
    faults: tuple[str, ...]

    @property
    def validated(self) -> bool:
        """Whether every part is placed and the checks found no violation."""
        return not self.faults and not self.unplaced

    @property
    def record(self) -> dict[str, Any]:
        """The result for JSON."""
        return asdict(self) | {"validated": self.validated}


def read_scene(
    paths: Sequence[Path], size: tuple[float, float], clearance: float, rotations: str
) -> PlatesScene:
    """Read files and folders of parts; surfaces are accepted.

    Raises
    ------
    InputError, MeshError, JobError
        If a file cannot be read, or the rotations are unknown.
    """
    host = Host.load()
    files = expand_inputs([(path, None) for path in paths], host.suffixes)
    read = read_all(files, lambda path: host.read(path, {}, {}), allow_surface=True)
    if not read:
        raise InputError("bench plates needs at least one part; the files contain none")
    allowed = parse_rotations(rotations)
    parts = tuple(replace(part, orientations=allowed) for part in read)
    reach = max(float(np.linalg.norm(np.ptp(part.mesh.vertices, axis=0))) for part in parts)
    return PlatesScene(parts, BuildVolume(np.array([*size, reach + 2.0 * clearance])), clearance)


class PlatesBench:
    """A scene prepared for a packer: bounding volumes are made once, as for a job with this packer."""

    def __init__(self, scene: PlatesScene, packer: str) -> None:
        self.scene = scene
        self.host = Host.load()
        self.packer = self.host.choose("packer", packer)
        offer = self.packer.offer
        makers = [
            Chosen.of(self.host, self.host.choose("volume", name), {})
            for name in ([offer.volumes] if isinstance(offer.volumes, str) else offer.volumes)
        ]
        volumes = [bound_part(part, makers, 0, Stop()) for part in scene.parts]
        settings = PackingSettings(strategy=packer, clearance_mm=scene.clearance, stacking=False)
        self.problem: PackingProblem = packing_problem(
            scene.parts, volumes, scene.space, settings, offer.accepts
        )
        self.host.refuse_mismatch(self.packer, self.problem)

    def warm_up(self) -> None:
        """Pack once for a short time, so that importing and compiling are not measured."""
        PackerRun(self.host, self.packer, {}, 2.0, 0).warm_up(self.problem)

    def run(self, seed: int, seconds: float) -> PlatesResult:
        """Pack with a seed and a time limit, and check every plate."""
        run = PackerRun(self.host, self.packer, {}, seconds, seed)
        packing, spent = measured(lambda: run.pack(self.problem))
        return self._result(seed, packing, spent)

    def _result(self, seed: int, packing: Packing, spent: Spent) -> PlatesResult:
        (faults, judged), checked = measured(lambda: self._judged(packing))
        return PlatesResult(
            packer=self.packer.offer.name,
            seed=seed,
            plates=len(packing.builds),
            bound=packing.bound,
            bound_for=packing.bound_for,
            filled=judged.filled,
            unplaced=len(packing.unplaced),
            check_seconds=checked.process_seconds,
            pairs=judged.pairs,
            faults=(*faults, *judged.faults),
            **spent._asdict(),
        )

    def _judged(self, packing: Packing) -> tuple[list[str], "JudgedPlates"]:
        """Return the violations of the bounding volumes, and those of the plates."""
        plates = placed_builds(self.scene.parts, self.problem, packing) if any(packing.builds) else []
        return list(map(str, check_packing(self.problem, packing))), judge_plates(self.scene, plates)


def ratios_to(name: str, results: Sequence[PlatesResult]) -> dict[str, float]:
    """Return for each packer its mean number of plates over that of the packer or package of a given name.

    Without valid results of that one there is no ratio.
    """
    plates: dict[str, list[int]] = {}
    for result in results:
        if result.validated:
            plates.setdefault(result.packer, []).append(result.plates)
    mean = {packer: float(np.mean(numbers)) for packer, numbers in plates.items()}
    return {packer: mean[packer] / mean[name] for packer in mean if name in mean and packer != name}


class JudgedPlates(NamedTuple):
    """The violations on all plates, how the pairs were judged, and the area of shadows over that of the plates."""

    faults: tuple[str, ...]
    pairs: PairCounts
    filled: float


def judge_plates(scene: PlatesScene, plates: Sequence[Sequence[PlacedPart]]) -> JudgedPlates:
    """Check plates as polygons and on the meshes."""
    settings = BuildSettings("plates", scene.space, clearance=scene.clearance)
    found, pairs, covered = [], PairCounts(), 0.0
    for number, plate in enumerate(plates, start=1):
        shadows = shadows_of(plate)
        covered += sum(shadow.polygons.area() for shadow in shadows)
        violations, counts = judge_placed(plate, settings, Stop())
        pairs += counts
        for each in [*check_shadows(shadows, scene.space, scene.clearance), *violations]:
            found.append(f"plate {number}: {each}")
    area = float(np.prod(scene.space.size[:2])) * max(len(plates), 1)
    return JudgedPlates(tuple(found), pairs, covered / area)
