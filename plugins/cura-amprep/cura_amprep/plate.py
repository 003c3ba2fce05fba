"""The models on Cura's plate, and the nodes of the scene that they come from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Iterator

import numpy as np


@dataclass(frozen=True, eq=False)
class Body:
    """A mesh at its place.

    Attributes
    ----------
    vertices
        ``(n, 3)`` mm, in coordinates of the mesh.
    faces
        ``(m, 3)`` indices of vertices.
    transform
        4 x 4 matrix for column vectors, from coordinates of the mesh to those of the build.
    mesh
        The object that copies of a model share; bodies with the same one have the same mesh.
    """

    vertices: np.ndarray[Any, Any]
    faces: np.ndarray[Any, Any]
    transform: np.ndarray[Any, Any]
    mesh: object


@dataclass(frozen=True, eq=False)
class Model:
    """A model or a group of models, whose bodies amprep moves together.

    Attributes
    ----------
    node
        The node of Cura's scene.
    """

    name: str
    bodies: tuple[Body, ...]
    node: Any


def models_on(root: Any, build_plate: int, from_scene: np.ndarray[Any, Any]) -> list[Model]:
    """Return the models of a scene that are printed on a build plate.

    Meshes that change others (infill, cutting and support meshes, support blockers) are left out.

    Parameters
    ----------
    root
        Root node of Cura's scene.
    build_plate
        Number of the active build plate.
    from_scene
        4 x 4 matrix from the scene to build coordinates.
    """
    models = []
    for node in root.getChildren():
        if node.callDecoration("getBuildPlateNumber") == build_plate:
            bodies = tuple(_body(each, from_scene) for each in _meshes(node) if _is_printed(each))
            if bodies:
                models.append(Model(node.getName() or "model", bodies, node))
    return models


def _meshes(node: Any) -> Iterator[Any]:
    """Yield a node and those below it that have a mesh."""
    if node.getMeshData() is not None:
        yield node
    for child in node.getChildren():
        yield from _meshes(child)


def _is_printed(node: Any) -> bool:
    changes_others = node.callDecoration("isNonPrintingMesh") or node.callDecoration("isSupportMesh")
    return bool(node.callDecoration("isSliceable")) and not changes_others


def _body(node: Any, from_scene: np.ndarray[Any, Any]) -> Body:
    mesh = node.getMeshData()
    vertices = np.asarray(mesh.getVertices(), np.float64)
    faces = mesh.getIndices()  # None where every three vertices are a triangle
    faces = np.arange(len(vertices)).reshape(-1, 3) if faces is None else np.asarray(faces)
    world = np.asarray(node.getWorldTransformation().getData(), np.float64)
    return Body(vertices, faces, from_scene @ world, mesh)
