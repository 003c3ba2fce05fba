"""The built-in packers."""

from collections.abc import Iterable
from dataclasses import replace

from amprep.hookspecs import Packer, PackerAccepts, hookimpl, later
from amprep.plugins.packers.annealing.params import AnnealingParams
from amprep.plugins.packers.params import (
    AutoParams,
    BlockBuildingParams,
    ColumnGenerationParams,
    ExtremePointsParams,
    IpLocalSearchParams,
    IpParams,
    PlatesParams,
    SeparationParams,
    SweepParams,
    TabuParams,
)
from amprep.plugins.packers.starts import with_starts

amprep_api = 1


_BOXES = PackerAccepts(volumes=frozenset({"box", "boxes"}), orientations=frozenset({"fixed", "axis"}))
_BUILDS, _FILL, _HEIGHT = frozenset({"builds"}), frozenset({"fill"}), frozenset({"height"})
_ANY_VOLUME = frozenset({"box", "boxes", "convex", "solid"})
_ANY_LIST = frozenset({"fixed", "axis", "list"})
_ALL = replace(
    _BOXES,
    objectives=_BUILDS | _FILL | _HEIGHT,
    orientations=_ANY_LIST,
    cylinder=True,
    zones=True,
    fixed=True,
)


_SHAPES = replace(_ALL, volumes=_ANY_VOLUME)


@hookimpl
def amprep_packers() -> Iterable[Packer]:
    """Yield the built-in packers."""
    yield from _heuristics_for_boxes()
    yield from _integer_programs()
    yield from _packers_of_shapes()


def _heuristics_for_boxes() -> Iterable[Packer]:
    yield Packer(
        name="extreme-points",
        summary="The best of many orderings, each item at its best extreme point (Crainic, Perboli, Tadei).",
        run=with_starts(later("amprep.plugins.packers.extreme_points:pack_extreme_points")),
        accepts=_ALL,
        params=ExtremePointsParams,
        efforts={"fast": {"work": 20.0}, "thorough": {"restarts": 2000, "work": 2000.0}},
    )
    yield Packer(
        name="auto",
        summary="Enclosing boxes at once, then the true shapes; of boxes alone, few builds with a proven bound.",
        run=with_starts(later("amprep.plugins.packers.auto:pack_auto")),
        accepts=replace(_SHAPES, orientations=_ANY_LIST | {"about-z"}),
        params=AutoParams,
        efforts={
            "fast": {"work": 20.0, "proof": 40.0, "separation": 600.0, "plates": 1500.0},
            "thorough": {"work": 1000.0, "proof": 4000.0, "separation": 60_000.0, "plates": 120_000.0},
        },
        volumes="mesh",
    )
    yield Packer(
        name="block-building",
        summary="Beam search over blocks of boxes in maximal empty spaces (Araya, Riff; Fanslau, Bortfeldt).",
        run=later("amprep.plugins.packers.block_building:pack_block_building"),
        accepts=replace(
            _BOXES, volumes=frozenset({"box"}), objectives=_FILL | _HEIGHT, zones=True, fixed=True
        ),
        params=BlockBuildingParams,
        efforts={"fast": {"work": 100.0}, "thorough": {"work": 5000.0}},
    )
    yield Packer(
        name="sweep",
        summary="Builds sliced into layers and rows, rows packed along one axis (Sweep 2003).",
        run=later("amprep.plugins.packers.sweep:pack_sweep"),
        accepts=replace(_BOXES, objectives=_BUILDS | _FILL, orientations=_ANY_LIST),
        params=SweepParams,
    )
    yield Packer(
        name="tabu",
        summary="Tabu search that empties one build after another (Lodi, Martello, Vigo; thesis 2.4).",
        run=later("amprep.plugins.packers.tabu:pack_tabu"),
        accepts=replace(_BOXES, orientations=_ANY_LIST, zones=True),
        params=TabuParams,
        efforts={"fast": {"work": 20.0}, "thorough": {"work": 1000.0, "patience": 30}},
    )


def _integer_programs() -> Iterable[Packer]:
    yield Packer(
        name="ip",
        summary="The thesis's integer program after extreme points, by HiGHS or any solver of pulp.",
        run=later("amprep.plugins.packers.integer_program:pack_ip"),
        accepts=replace(_BOXES, objectives=_BUILDS | _FILL, zones=True, fixed=True),
        params=IpParams,
    )
    yield Packer(
        name="ip-local-search",
        summary="Steps to the best build near the last one, by the integer program (thesis 2.2).",
        run=later("amprep.plugins.packers.integer_program.local_search:pack_ip_local_search"),
        accepts=replace(_BOXES, objectives=_FILL, zones=True, fixed=True),
        params=IpLocalSearchParams,
    )
    yield Packer(
        name="column-generation",
        summary="Set covering over builds, priced by the fill problem; proves bounds (thesis 2.1).",
        run=later("amprep.plugins.packers.column_generation:pack_column_generation"),
        accepts=replace(_BOXES, zones=True),
        params=ColumnGenerationParams,
    )


def _packers_of_shapes() -> Iterable[Packer]:
    yield Packer(
        name="separation",
        summary="True shapes: overlapping layouts are separated by guided local search on no-fit solids.",
        run=with_starts(later("amprep.plugins.packers.separation:pack_separation")),
        accepts=replace(_SHAPES, stacking=frozenset({True})),
        params=SeparationParams,
        efforts={"fast": {"work": 600.0}, "thorough": {"work": 60_000.0}},
        volumes="mesh",
    )
    yield Packer(
        name="plates",
        summary="True shadows of parts side by side, without stacking, by guided local search.",
        run=with_starts(later("amprep.plugins.packers.plates:pack_plates")),
        accepts=replace(_SHAPES, orientations=_ANY_LIST | {"about-z"}, stacking=frozenset({False})),
        params=PlatesParams,
        efforts={"fast": {"work": 3000.0}, "thorough": {"work": 300_000.0}},
        volumes="mesh",
    )
    yield Packer(
        name="annealing",
        summary="Simulated annealing of the meshes themselves, which never intersect (thesis 2.6).",
        run=with_starts(later("amprep.plugins.packers.annealing.pack:pack_annealing")),
        accepts=replace(_SHAPES, orientations=_ANY_LIST | {"about-z", "free"}),
        params=AnnealingParams,
        efforts={"fast": {"moves": 400}, "thorough": {"moves": 20_000}},
        volumes="mesh",
    )
