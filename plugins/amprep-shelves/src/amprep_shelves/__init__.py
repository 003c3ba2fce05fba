"""A shelf packer: it places parts in rows, and rows in layers."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from amprep.hookspecs import Packer, PackerAccepts, hookimpl
from amprep_shelves.shelves import pack_shelves

amprep_api = 1


@dataclass(frozen=True)
class ShelvesParams:
    """Parameters of the shelf packer.

    Attributes
    ----------
    order
        Measure by which parts are sorted; the largest is placed first.
    """

    order: Literal["height", "depth", "volume"] = "height"


@hookimpl
def amprep_packers() -> Iterator[Packer]:
    """Yield the shelf packer."""
    yield Packer(
        "shelves",
        "Places parts in rows and rows in layers; fast, with straight channels between the rows.",
        run=pack_shelves,
        accepts=PackerAccepts(
            volumes=frozenset({"box", "boxes", "convex", "solid"}),
            objectives=frozenset({"builds", "fill"}),
            orientations=frozenset({"fixed", "axis", "list"}),
        ),
        params=ShelvesParams,
    )
