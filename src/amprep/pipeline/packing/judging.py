"""Judge the answers of plugins that are not built in, before anything relies on them.

The tests run every built-in offer before the judges; nobody ran the offer of a stranger.
"""

from collections.abc import Sequence

from amprep.checks.packing.volumes_placed import check_packing
from amprep.checks.violation import Violation
from amprep.checks.volumes import check_volume
from amprep.errors import PluginError
from amprep.hookspecs import Packer, VolumeMaker
from amprep.host import Chosen
from amprep.model import BoundingVolume, Packing, PackingProblem, Part, TurnedVolume
from amprep.model.counting import counted


def refuse_wrong_packing(packer: Chosen[Packer], problem: PackingProblem, packing: Packing) -> None:
    """Refuse a packing that breaks a promise of packers.

    Raises
    ------
    PluginError
        With the name of the packer and the first broken promise.
    """
    if not packer.listed.builtin:
        _refuse(packer.listed.title, check_packing(problem, packing))


def refuse_wrong_volume(maker: Chosen[VolumeMaker], part: Part, made: BoundingVolume | TurnedVolume) -> None:
    """Refuse a bounding volume that does not contain its part.

    Raises
    ------
    PluginError
        With the name of the volume maker and the first broken promise.
    """
    if not maker.listed.builtin:
        _refuse(maker.listed.title, check_volume(part, made))


def _refuse(title: str, found: Sequence[Violation]) -> None:
    if found:
        first, more = found[0], len(found) - 1
        others = f" (and {counted(more, 'other violation')})" if more else ""
        raise PluginError(
            f"{title} broke its promise: {first.subject} {first.message}{others}; choose another"
        )
