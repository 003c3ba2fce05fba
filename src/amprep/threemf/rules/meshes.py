"""Rules of meshes: chapter 4.1 of the core specification."""

from collections.abc import Mapping

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.meshes.topology import count_edges
from amprep.threemf.rules.markup import Markup
from amprep.threemf.rules.resources import ResourceRules
from amprep.threemf.rules.runs import Run
from amprep.threemf.rules.schema import is_index, is_number

_SOLIDS = ("model", "solidsupport")
_LEAST = 4
"""Triangles of the smallest solid."""
_CORNERS = ("v1", "v2", "v3")
_PROPERTIES = ("p1", "p2", "p3")


class MeshRules:
    """Collects the vertices and triangles of a mesh and checks them at its end."""

    def __init__(self, markup: Markup, resources: ResourceRules) -> None:
        self.markup = markup
        self.resources = resources
        self.may_be_empty = False
        """Whether an extension that the file requires makes shapes that are no triangles."""
        self._vertices: list[Floats] = []
        self._triangles: list[Int64s] = []
        self._single: list[list[float]] = []
        self._corners: list[list[int]] = []

    def run(self, run: Run) -> None:
        """Take a run of plain vertices or triangles."""
        self._flush()
        if run.key == "vertex":
            self._vertices.append(run.vertices)
        else:
            self._triangles.append(run.triangles)

    def start(self, key: str, attributes: Mapping[str, str]) -> None:
        """Take a vertex or a triangle; the markup has reported what is wrong with its numbers."""
        if key == "vertex":
            words = [attributes.get(name, "") for name in "xyz"]
            self._single.append([float(word) if is_number(word) else 0.0 for word in words])
            return
        corners = [attributes.get(name, "") for name in _CORNERS]
        if all(map(is_index, corners)):
            self._corners.append([int(corner) for corner in corners])
        if len(attributes) > len(_CORNERS):
            self._check_properties(attributes)

    def end(self) -> None:
        """Check the mesh and forget it."""
        self._flush()
        vertices = np.concatenate(self._vertices) if self._vertices else np.zeros((0, 3))
        triangles = np.concatenate(self._triangles) if self._triangles else np.zeros((0, 3), np.int64)
        self._vertices, self._triangles = [], []
        if not len(triangles) and self.may_be_empty:
            return
        solid = self.resources.current.object_type in _SOLIDS
        if len(triangles) < (_LEAST if solid else 1):
            expected = f"a mesh must have at least {_LEAST if solid else 1} triangles"
            self.markup.add("3MF core 4.1.4", expected, touches_parts=True)
        elif triangles.max() >= len(vertices):
            place = (
                f"{self.markup.place}, triangle {int((triangles >= len(vertices)).any(axis=1).argmax()) + 1}"
            )
            expected = "triangles must refer to vertices that exist"
            self.markup.add("3MF core 4.1.4.1", expected, touches_parts=True, place=place)
        else:
            self._check_surface(vertices, triangles, solid=solid)

    def _check_surface(self, vertices: Floats, triangles: Int64s, *, solid: bool) -> None:
        """Check corners, edges and orientation; whether a part is a solid in spite of them is judged after reading."""
        a, b, c = triangles.T
        if ((a == b) | (b == c) | (c == a)).any():
            expected = "the corners of a triangle must be three different vertices"
            self.markup.add("3MF core 4.1.4.1", expected, touches_parts=False)
        if not solid:
            return
        _, uses, balance = count_edges(triangles)
        if (uses != 2).any():
            expected = f"each edge must belong to exactly two triangles, {int((uses != 2).sum())} do not"
            self.markup.add("3MF core 4.1", expected, touches_parts=False)
        elif (balance != 0).any():
            expected = "triangles that share an edge must have the same orientation"
            self.markup.add("3MF core 4.1", expected, touches_parts=False)
        elif _signed_volume(vertices, triangles) < 0.0:
            self.markup.add("3MF core 4.1", "the normals of a mesh must point outwards", touches_parts=False)

    def _check_properties(self, attributes: Mapping[str, str]) -> None:
        group = attributes.get("pid", self.resources.default_group).strip()
        given = [attributes[name] for name in _PROPERTIES if name in attributes]
        if not group and not given:
            return
        for index in given or [""]:
            self.resources.check_property(group, index, "3MF core 4.1.4.1")
        kind = self.resources.groups.get(group, ("", 0))[0]
        if kind == "basematerials" and len(set(given)) > 1:
            expected = "base materials must be the same at all corners of a triangle"
            self.markup.add("3MF core 4.1.4.1", expected, touches_parts=False)

    def _flush(self) -> None:
        """Move single vertices and triangles to the arrays."""
        if self._single:
            self._vertices.append(np.array(self._single))
            self._single = []
        if self._corners:
            self._triangles.append(np.array(self._corners, np.int64))
            self._corners = []


def _signed_volume(vertices: Floats, triangles: Int64s) -> float:
    """Return six times the volume that the triangles enclose; the sign is that of their orientation."""
    with np.errstate(all="ignore"):  # coordinates that are too large are reported with the part
        corners = (vertices - vertices[0])[triangles]
        return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])))
