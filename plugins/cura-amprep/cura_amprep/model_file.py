"""Write the models on the plate as a 3MF file, by the 3MF Core Specification, without other packages than numpy.

Copies share their mesh. A group is an object with components, so that amprep moves it as one part.
"""

from __future__ import annotations

import zipfile
from typing import Any, BinaryIO, Iterator, Sequence
from xml.sax.saxutils import quoteattr

import numpy as np

from .plate import Body, Model

_CONTENT_TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"""
_RELATIONS = """<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"""
_HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<resources>
"""
_IDENTITY = np.eye(4)


def write_models(models: Sequence[Model], stream: BinaryIO) -> None:
    """Write models to a 3MF package.

    Parameters
    ----------
    models
        At least one model.
    stream
        Open binary file that can be sought.
    """
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as package:
        package.writestr("[Content_Types].xml", _CONTENT_TYPES)
        package.writestr("_rels/.rels", _RELATIONS)
        package.writestr("3D/3dmodel.model", "".join(_document(models)))


def _document(models: Sequence[Model]) -> Iterator[str]:
    """Yield the text of the model part: one object per mesh, one per group, one item per model."""
    numbers: dict[int, int] = {}
    items = []
    yield _HEAD
    for model in models:
        for body in model.bodies:
            if id(body.mesh) not in numbers:
                numbers[id(body.mesh)] = len(numbers) + 1
                yield from _mesh_object(numbers[id(body.mesh)], model.name, body)
    for number, model in enumerate(models, len(numbers) + 1):
        if len(model.bodies) == 1:
            body = model.bodies[0]
            items.append(_placed("item", numbers[id(body.mesh)], body.transform))
        else:
            yield f'<object id="{number}" type="model" name={_quoted(model.name)}><components>\n'
            yield from (_placed("component", numbers[id(b.mesh)], b.transform) for b in model.bodies)
            yield "</components></object>\n"
            items.append(_placed("item", number, _IDENTITY))
    yield "</resources>\n<build>\n"
    yield from items
    yield "</build>\n</model>\n"


def _mesh_object(number: int, name: str, body: Body) -> Iterator[str]:
    vertices, faces = _welded(body)
    yield f'<object id="{number}" type="model" name={_quoted(name)}><mesh><vertices>\n'
    yield from (f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>\n' for x, y, z in vertices.tolist())
    yield "</vertices><triangles>\n"
    yield from (f'<triangle v1="{a}" v2="{b}" v3="{c}"/>\n' for a, b, c in faces.tolist())
    yield "</triangles></mesh></object>\n"


def _welded(body: Body) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Return vertices and faces with equal vertices merged, and without faces that this makes degenerate."""
    vertices, index = np.unique(body.vertices, axis=0, return_inverse=True)
    faces = index.reshape(-1)[body.faces]
    a, b, c = faces.T
    return vertices, faces[(a != b) & (b != c) & (c != a)]


def _placed(element: str, number: int, transform: np.ndarray[Any, Any]) -> str:
    """Return an item or component; 3MF has row vectors, so the matrix is written by its columns."""
    values = " ".join(f"{value:.9g}" for value in transform[:3].T.reshape(-1).tolist())
    return f'<{element} objectid="{number}" transform="{values}"/>\n'


def _quoted(name: str) -> str:
    """Return a name as an attribute without characters that XML forbids."""
    return quoteattr("".join(sign for sign in name if sign.isprintable()))
