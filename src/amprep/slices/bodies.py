"""The bodies of a build that are cut into layers."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from amprep.geometry.slicing.layers import LayerContours, LayeredBody
from amprep.measures.density import part_volume
from amprep.model.build import Build
from amprep.model.mesh import Mesh

_ROWS = 1_000_000
"""Pairs of a triangle and a plane that are in memory, for all bodies; each needs about 100 bytes."""

_LEAST_ROWS = 10_000


@dataclass(frozen=True, eq=False)
class SliceBody:
    """A part or a support that is cut into layers.

    Attributes
    ----------
    name
        Label of the part, or name of the support.
    is_support
        Whether it is a support.
    mesh
        In build coordinates, mm.
    volume_mm3
        Its volume, 0 for a surface without thickness.
    is_surface
        Whether it has no thickness.
    has_beams
        Whether it is a lattice of beams, which the mesh stands for.
    """

    name: str
    is_support: bool
    mesh: Mesh
    volume_mm3: float
    is_surface: bool
    has_beams: bool = False


@dataclass(frozen=True, eq=False)
class Layer:
    """One layer of a build.

    Attributes
    ----------
    number
        0 for the lowest.
    top_mm
        Height of its upper side.
    contours
        Those of each body that it cuts: index of the body, its contours, and which of them are of this layer.
    """

    number: int
    top_mm: float
    contours: tuple[tuple[int, LayerContours, range], ...]


def bodies_of(build: Build) -> tuple[SliceBody, ...]:
    """Return the parts of a build, then its supports."""
    parts = [
        SliceBody(
            placed.label,
            is_support=False,
            mesh=placed.mesh,
            volume_mm3=part_volume(placed) if placed.part.is_solid else 0.0,
            is_surface=not placed.part.is_solid,
        )
        for placed in build.parts
    ]
    supports = [
        SliceBody(
            body.name,
            is_support=True,
            mesh=body.mesh,
            volume_mm3=0.0 if body.surface else abs(body.mesh.signed_volume),
            is_surface=body.surface,
            has_beams=body.lattice is not None,
        )
        for body in build.supports
    ]
    return tuple(each for each in parts + supports if len(each.mesh.triangles))


def cut_layers(bodies: Sequence[SliceBody], thickness: float, layers: int) -> Iterator[Layer]:
    """Yield the layers of bodies from the plate upwards, each cut in its middle.

    Parameters
    ----------
    bodies
        The bodies.
    thickness
        Of a layer, mm.
    layers
        Number of layers.
    """
    rows = max(_ROWS // max(len(bodies), 1), _LEAST_ROWS)
    blocks = [layered(each).blocks(thickness, layers, rows) for each in bodies]
    current: list[LayerContours | None] = [None] * len(bodies)
    for number in range(layers):
        cut = []
        for i, each in enumerate(blocks):
            block = current[i]
            if block is None or number >= block.first_layer + block.layers:
                block = current[i] = next(each)
            own = block.of_layer(number)
            if own:
                cut.append((i, block, own))
        yield Layer(number, (number + 1) * thickness, tuple(cut))


def layered(body: SliceBody) -> LayeredBody:
    """Return a body prepared for cutting."""
    return LayeredBody(*body.mesh.arrays, is_surface=body.is_surface, is_united=body.is_support)
