"""Colours and materials of a 3MF mesh: base materials and colour groups, of object or triangles."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.model.part import Appearance
from amprep.threemf.read.arrays import RawMesh

if TYPE_CHECKING:
    from lib3mf import Lib3MF

NO_COLOUR = -1

_NO_RESOURCE = 0


class Paint(NamedTuple):
    """What the triangles of a mesh look like.

    Attributes
    ----------
    colours
        ``(m, 3)`` int64, 0xRRGGBBAA at each corner, `NO_COLOUR` where there is none.
    materials
        Names of the base materials used.
    lost
        Whether the file says more than is kept: textures, composite materials, several properties at once.
    """

    colours: NDArray[np.int64]
    materials: frozenset[str]
    lost: bool


def paint_of(model: "Lib3MF.Model", mesh: "Lib3MF.MeshObject", raw: RawMesh) -> Paint:
    """Return the paint of a mesh object; triangles without a property of their own have the object's."""
    count = len(raw.triangles)
    resource, chosen = _with_default(mesh, raw)
    colours = np.full((count, 3), NO_COLOUR, np.int64)
    materials: set[str] = set()
    lost = False
    for group in np.unique(resource[resource != _NO_RESOURCE]).tolist():
        rows = resource == group
        known = _properties(model, group)
        lost = lost or known is None
        if known:
            ids, palette = np.array(list(known)), np.array([colour for colour, _ in known.values()])
            order = np.argsort(ids)
            place = order[np.searchsorted(ids, chosen[rows], sorter=order).clip(max=len(ids) - 1)]
            colours[rows] = np.where(ids[place] == chosen[rows], palette[place], NO_COLOUR)
            materials |= {known[int(ids[one])][1] for one in np.unique(place)} - {""}
    return Paint(colours, frozenset(materials), lost)


def appearance_of(paints: list[Paint]) -> Appearance:
    """Return the appearance of a part made of meshes with these paints, one after the other."""
    colours = np.concatenate([paint.colours for paint in paints])
    materials = frozenset[str]().union(*(paint.materials for paint in paints))
    material = next(iter(materials)) if len(materials) == 1 else None
    first = int(colours[0, 0]) if len(colours) else NO_COLOUR
    if (colours == first).all():
        return Appearance(None if first == NO_COLOUR else f"#{first:08X}", material)
    return Appearance(None, material, colours)


def _with_default(mesh: "Lib3MF.MeshObject", raw: RawMesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return resource ``(m,)`` and properties ``(m, 3)`` of the triangles, the object's filled in."""
    if len(raw.properties) != len(raw.triangles):
        raw = raw._replace(properties=np.zeros((len(raw.triangles), 4), np.int64))
    group, value, given = mesh.GetObjectLevelProperty()
    bare = raw.properties[:, :1] == _NO_RESOURCE
    filled = np.where(bare & given, [group, value, value, value], raw.properties)
    return filled[:, 0], filled[:, 1:]


def _properties(model: "Lib3MF.Model", group: int) -> dict[int, tuple[int, str]] | None:
    """Return property id -> (0xRRGGBBAA, material name) of a resource; None for a kind that is not kept."""
    from lib3mf import Lib3MF

    kind = model.GetPropertyTypeByID(group)
    if kind == Lib3MF.PropertyType.BaseMaterial:
        materials = model.GetBaseMaterialGroupByID(group)
        return {
            one: (_packed(materials.GetDisplayColor(one)), materials.GetName(one))
            for one in materials.GetAllPropertyIDs()
        }
    if kind == Lib3MF.PropertyType.Colors:
        palette = model.GetColorGroupByID(group)
        return {one: (_packed(palette.GetColor(one)), "") for one in palette.GetAllPropertyIDs()}
    return None


def _packed(colour: "Lib3MF.Color") -> int:
    return int(colour.Red) << 24 | int(colour.Green) << 16 | int(colour.Blue) << 8 | int(colour.Alpha)
