"""Pack the 3D irregular instances of ESICUP: meshes on a fixed base, lowest height, translations only."""

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.bench.measuring import Spent, measured
from amprep.bench.packing.run import PackerRun
from amprep.checks.packing.parts_placed import check_placed
from amprep.checks.packing.volumes_placed import check_packing
from amprep.errors import InputError
from amprep.geometry.no_fit.partition import exact_pieces
from amprep.host import Host
from amprep.measures.bounding_volume import volume_of
from amprep.measures.objective import objective_reached
from amprep.model import (
    BoundingVolume,
    BuildSettings,
    BuildVolume,
    ConvexPieces,
    Item,
    Mesh,
    PackingProblem,
    Part,
    PlacedPart,
    Stop,
)
from amprep.model.bounding_volume import as_turned
from amprep.model.packing import Packing
from amprep.pipeline.reading import read_all

MAX_ITEMS = 100_000
MAX_BYTES = 10_000_000

RECORDS = {
    "stoyan 2005 example1": 17.46,
    "stoyan 2005 example2": 19.00,
    "stoyan 2005 example3": 27.53,
    "stoyan 2004 example1": 51.54,
    "stoyan 2004 example2": 29.00,
    "stoyan 2004 example3": 40.07,
    "stoyan 2004 example4": 54.21,
    "stoyan 2004 example5": 68.02,
    "egeblad 2009 merged1": 16.55,
    "egeblad 2009 merged2": 20.97,
    "egeblad 2009 merged3": 22.00,
    "egeblad 2009 merged4": 23.84,
    "egeblad 2009 merged5": 26.14,
    "liu 2015 experiment1": 30.55,
    "lamas 2022 chess": 131.36,
    "lamas 2022 engine": 149.59,
}
"""Mean heights of 15 runs of sparrow-3d (github.com/JonasTollenaere/sparrow-3d, solutions/fixed), 10 minutes with four
workers."""

_FORMAT = 'expected {"container": {"size-x", "size-y"}, "item-types": [{"path", "demand"}]}'


class EsicupInstance(NamedTuple):
    """Parts with their quantities, the sizes of the base (mm), and the record height (mm), if one is known."""

    name: str
    parts: tuple[Part, ...]
    base: tuple[float, float]
    record: float | None


@dataclass(frozen=True)
class EsicupResult:
    """The packing of one instance with one seed.

    Attributes
    ----------
    height_mm
        Height of the highest mesh.
    ratio
        The height over the record; None without one, or if parts are unplaced.
    density
        Volume of the placed meshes over that of the base times the height.
    seconds, process_seconds
        Time on the clock and of all threads, for packing alone.
    memory_mb
        Peak memory of the process while packing, MiB; None where the system does not tell.
    faults
        Violations that the checks of the bounding volumes and of the meshes found.
    """

    seed: int
    height_mm: float
    ratio: float | None
    density: float
    unplaced: int
    seconds: float
    process_seconds: float
    memory_mb: int | None
    faults: tuple[str, ...]

    @property
    def validated(self) -> bool:
        """Whether every part is placed and the checks found no violation."""
        return not self.faults and not self.unplaced

    @property
    def line(self) -> str:
        """The result in one line."""
        ratio = "" if self.ratio is None else f" ({self.ratio:.4f} of the record)"
        verdict = "valid" if self.validated else f"INVALID: {(*self.faults, f'{self.unplaced} unplaced')[0]}"
        return (
            f"seed {self.seed}: height {self.height_mm:.4f}{ratio}, density {self.density:.1%}, "
            f"{self.process_seconds:.1f} s of processor time, {self.memory_mb} MiB, {verdict}"
        )


def read_esicup(path: Path) -> EsicupInstance:
    """Return an instance; its meshes are in the folder of the file or in folders in it.

    Raises
    ------
    InputError, MeshError
        If a file cannot be read or has another format.
    """
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(f"{path}: larger than {MAX_BYTES} bytes; give the file of one instance")
        record = json.loads(path.read_text(encoding="utf-8"))
        base = float(record["container"]["size-x"]), float(record["container"]["size-y"])
        types = [(str(row["path"]), int(row["demand"])) for row in record["item-types"]]
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give a JSON file") from error
    except KeyError as error:
        raise InputError(f"{path}: {error.args[0]} is missing; {_FORMAT}") from error
    except (ValueError, TypeError, AttributeError, RecursionError, OverflowError) as error:
        raise InputError(f"{path}: not an ESICUP instance ({error}); {_FORMAT}") from error
    if not (all(np.isfinite(base)) and min(base) > 0.0):
        raise InputError(
            f"{path}: the base must have positive sizes, got {base[0]:g} x {base[1]:g}; {_FORMAT}"
        )
    if min((count for _, count in types), default=0) < 1 or sum(count for _, count in types) > MAX_ITEMS:
        raise InputError(f"{path}: each demand must be at least 1, and all at most {MAX_ITEMS}; {_FORMAT}")
    parts = _read_parts([(_mesh_file(path, name), count) for name, count in types])
    return EsicupInstance(path.stem, parts, base, RECORDS.get(_key(path)))


def _key(path: Path) -> str:
    """Return author, year and name of an instance, as in `RECORDS`."""
    folder = path.resolve().parent.name.lower()
    author, year = re.match(r"[a-z]*", folder), re.search(r"\d{4}", folder)
    return f"{author.group() if author else ''} {year.group() if year else ''} {path.stem.lower()}"


def _mesh_file(path: Path, name: str) -> Path:
    """Return the file of a mesh: as named from the folder above, from that of the instance, or from a part of it."""
    folder, parts = path.parent, [part for part in re.split(r"[\\/]", name) if part not in ("", ".", "..")]
    wanted = Path(*parts)
    ends = [Path(*parts[k:]) for k in range(len(parts))]
    folders = folder.parent, folder, folder / path.stem.rstrip("0123456789")
    found = [place / end for end in ends for place in folders if (place / end).is_file()]
    found += sorted(file for file in folder.glob(f"*/**/{wanted.name}") if file.is_file())
    if not found:
        raise InputError(f"{path}: the mesh {wanted.name} is not in {folder} or a folder in it; put it there")
    return found[0]


def _read_parts(files: Sequence[tuple[Path, int]]) -> tuple[Part, ...]:
    host = Host.load()
    return tuple(read_all(files, lambda path: host.read(path, {}, {}), allow_surface=True))


class EsicupBench:
    """An instance prepared for a packer: bounding volumes are made once, as for a job with this packer."""

    def __init__(self, instance: EsicupInstance, packer: str) -> None:
        self.instance = instance
        self.host = Host.load()
        self.packer = self.host.choose("packer", packer)
        self.volumes = [self._volume(part) for part in instance.parts]
        tallest = [float(np.ptp(part.mesh.vertices[:, 2])) for part in instance.parts]
        height = sum(t * part.quantity for t, part in zip(tallest, instance.parts, strict=True)) + 1.0
        items = tuple(
            Item(number, copy, volume, part.fill_value)
            for number, (part, volume) in enumerate(zip(instance.parts, self.volumes, strict=True))
            for copy in range(part.quantity)
        )
        space = BuildVolume(np.array([*instance.base, height]))
        self.problem = PackingProblem(items, space, "height")
        self.host.refuse_mismatch(self.packer, self.problem)

    def run(
        self, seed: int, seconds: float, params: Mapping[str, Any] = MappingProxyType({})
    ) -> EsicupResult:
        """Pack with a seed, a time limit and parameters of the packer, and check the packing on the meshes."""
        run = PackerRun(self.host, self.packer, dict(params), seconds, seed)
        packing, spent = measured(lambda: run.pack(self.problem))
        return self._result(seed, packing, spent)

    def _volume(self, part: Part) -> BoundingVolume:
        """Return the bounding volume that the packer asks for; the exact pieces of a mesh that is not a solid."""
        if not part.is_solid:
            pieces = exact_pieces(part.mesh.vertices, part.mesh.triangles, Stop())
            if pieces:
                return ConvexPieces(tuple(_hull(piece) for piece in pieces))
        maker = self.host.choose("volume", self.packer.offer.volumes if part.is_solid else "box")
        params, rng = self.host.params(maker, {}), np.random.default_rng(0)
        return as_turned(self.host.call(maker, part, params=params, rng=rng, stop=Stop())).volume

    def _result(self, seed: int, packing: Packing, spent: Spent) -> EsicupResult:
        height = objective_reached(self.problem, packing)
        placed = [placement.item for build in packing.builds for placement in build]
        of_part = [
            volume_of(volume) if not part.is_solid else part.volume_mm3 for part, volume in self._pairs
        ]
        total = sum(of_part[self.problem.items[item].part] for item in placed)
        area = self.instance.base[0] * self.instance.base[1]
        record = self.instance.record
        return EsicupResult(
            seed=seed,
            height_mm=height,
            ratio=None if record is None or packing.unplaced else height / record,
            density=total / (area * height) if height > 0.0 else 0.0,
            unplaced=len(packing.unplaced),
            faults=self._faults(packing),
            **spent._asdict(),
        )

    @property
    def _pairs(self) -> list[tuple[Part, BoundingVolume]]:
        return list(zip(self.instance.parts, self.volumes, strict=True))

    def _faults(self, packing: Packing) -> tuple[str, ...]:
        """Check the bounding volumes, then the meshes."""
        found = check_packing(self.problem, packing)
        for build in packing.builds:
            placed = []
            for placement in build:
                item = self.problem.items[placement.item]
                part = self.instance.parts[item.part]
                placed.append(PlacedPart(f"{part.name}-{item.copy + 1}", part, placement.matrix))
            found += check_placed(placed, BuildSettings("esicup", self.problem.space), Stop())
        return tuple(map(str, found))


def _hull(points: Floats) -> Mesh:
    from amprep.geometry.bounding.convex.hulls import containing_hull

    return Mesh(*containing_hull(points))


def run_esicup(
    instance: EsicupInstance,
    packer: str,
    *,
    seconds: float,
    seeds: Sequence[int],
    progress: Callable[[EsicupResult], None],
) -> list[EsicupResult]:
    """Pack an instance with several seeds; limits on the amount of work are lifted.

    The first run is preceded by a short one, so that importing and compiling are not measured.

    Raises
    ------
    PluginError
        If the packer is unknown or does not accept such problems.
    """
    bench = EsicupBench(instance, packer)
    PackerRun(bench.host, bench.packer, {}, seconds, 0).warm_up(bench.problem)
    results = []
    for seed in seeds:
        results.append(bench.run(seed, seconds))
        progress(results[-1])
    return results


def summary(results: Sequence[EsicupResult]) -> dict[str, Any]:
    """Return means of the runs of an instance: height, ratio to the record (if known), density; and the extremes."""
    heights = [result.height_mm for result in results]
    ratios = [result.ratio for result in results if result.ratio is not None]
    return {
        "height_mm": float(np.mean(heights)),
        "least_height_mm": min(heights),
        "ratio": float(np.mean(ratios)) if ratios else None,
        "density": float(np.mean([result.density for result in results])),
        "process_seconds": float(np.mean([result.process_seconds for result in results])),
        "memory_mb": max(
            (result.memory_mb for result in results if result.memory_mb is not None), default=None
        ),
    }
