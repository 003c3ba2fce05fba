"""Write a build as 3MF with the slices of its objects (3MF Slice extension 1.0.2).

Each object keeps its mesh and refers to a stack of slices. Objects are stored in the coordinates of the build, so that
no item is transformed: the extension allows slices no other rotations than those about z.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from amprep.geometry.slicing.layers import RESOLUTION, LayerContours
from amprep.geometry.slicing.text import groups_text, rows_text
from amprep.threemf.build.values import xml_text
from amprep.threemf.names import CORE_NAMESPACE, MODEL_NAME, ROOT_RELATIONSHIPS
from amprep.threemf.package.write import write_package
from amprep.threemf.write.document import MeshObject
from amprep.threemf.write.geometry import check_geometry, mesh_text

SLICE_NAMESPACE = "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07"

_DECIMALS = 4
_VERTEX = (b'<s:vertex x="', b'" y="', b'"/>\n')
_SEGMENT = (b'<s:segment v2="', b'"/>')
_POLYGON = (b'<s:polygon startv="', b'">\n', b"</s:polygon>\n")
_ESCAPED = str.maketrans(dict.fromkeys("&<>\"'", "_"))
"""lib3mf 2.5.0 fails on an escaped character at the end of its buffer, so that names have none."""

_LARGEST = 2**33
"""Bytes; an upper bound of the text of the model, which makes the package one for large entries."""

_TYPES = (
    b'<?xml version="1.0" encoding="UTF-8"?>\n'
    b'<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    b'<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    b'<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>\n'
)
_RELATIONSHIPS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    f'<Relationship Id="rel0" Target="/{MODEL_NAME}" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>\n'
).encode()


class ObjectWithSlices(NamedTuple):
    """An object of the file, and the blocks of its layers from z = 0 upwards."""

    object: MeshObject
    blocks: Iterable[LayerContours]


def write_sliced(objects: Iterable[ObjectWithSlices], thickness: float, path: Path) -> None:
    """Write a package; the blocks of each object are taken when it is written.

    Parameters
    ----------
    objects
        The objects in build coordinates.
    thickness
        Of a layer, mm.
    path
        The file; it must be a temporary one.

    Raises
    ------
    AmprepError
        If 3MF cannot store an object.
    """
    entries: list[tuple[str, int, Iterable[bytes]]] = [
        ("[Content_Types].xml", len(_TYPES), [_TYPES]),
        (ROOT_RELATIONSHIPS, len(_RELATIONSHIPS), [_RELATIONSHIPS]),
        (MODEL_NAME, _LARGEST, _model_text(objects, thickness)),
    ]
    write_package(path, entries)


def _model_text(objects: Iterable[ObjectWithSlices], thickness: float) -> Iterator[bytes]:
    yield (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<model unit="millimeter" xml:lang="en-US" xmlns="{CORE_NAMESPACE}" xmlns:s="{SLICE_NAMESPACE}" '
        'requiredextensions="s"><resources>\n'
    ).encode()
    count = 0
    for each in objects:
        check_geometry(each.object)
        stack, count = 2 * count + 1, count + 1
        yield f'<s:slicestack id="{stack}" zbottom="0">\n'.encode()
        for block in each.blocks:
            for layer in range(block.first_layer, block.first_layer + block.layers):
                yield from _slice_text(block, layer, thickness)
        yield b"</s:slicestack>\n"
        name = xml_text(each.object.name).translate(_ESCAPED)
        yield (
            f'<object id="{stack + 1}" type="{each.object.type}" name="{name}" '
            f's:slicestackid="{stack}" s:meshresolution="fullres">'
        ).encode()
        yield from mesh_text(each.object, None)
        yield b"</object>\n"
    items = "".join(f'<item objectid="{2 * i + 2}"/>' for i in range(count))
    yield f"</resources><build>{items}</build></model>\n".encode()


def _slice_text(block: LayerContours, layer: int, thickness: float) -> Iterator[bytes]:
    """Yield one slice; where its layer is empty, it has no polygons."""
    own = block.of_layer(layer)
    head = f'<s:slice ztop="{(layer + 1) * thickness:.6f}"'.encode()
    if not own:
        yield head + b"/>\n"
        return
    first = block.first[own.start : own.stop + 1] - block.first[own.start]
    points = block.points[block.first[own.start] : block.first[own.stop]]
    yield head + b"><s:vertices>\n"
    yield rows_text(np.rint(points / RESOLUTION).astype(np.int64), _DECIMALS, _VERTEX)
    yield b"</s:vertices>"
    following = np.arange(1, len(points) + 1)
    following[first[1:] - 1] = first[:-1]
    if block.is_open:
        following = np.delete(following, first[1:] - 1)
        ends = first - np.arange(len(first))
    else:
        ends = first
    yield groups_text(first[:-1, None], _POLYGON, following[:, None], ends, _SEGMENT, 0)
    yield b"</s:slice>\n"
