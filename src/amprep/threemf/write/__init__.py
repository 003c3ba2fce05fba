"""Write a build file: lib3mf makes the structure, amprep adds exact meshes and placements."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from amprep.arrays import Floats
from amprep.errors import AmprepError
from amprep.files import replacing
from amprep.model.build import Build
from amprep.threemf.names import (
    CURA_NAMESPACE,
    MODEL_NAME,
    NAMESPACE,
    PRUSASLICER_CONFIG,
    PRUSASLICER_NAMESPACE,
)
from amprep.threemf.package.write import write_package
from amprep.threemf.write.document import Document
from amprep.threemf.write.generic_and_cura import components_document
from amprep.threemf.write.geometry import check_geometry, mesh_text, text_size
from amprep.threemf.write.metadata import with_digest
from amprep.threemf.write.prusaslicer import merged_document, prusaslicer_config
from amprep.threemf.write.skeleton import Skeleton, is_readable, make_skeleton

PREFIXES = {NAMESPACE: "amprep", CURA_NAMESPACE: "cura", PRUSASLICER_NAMESPACE: "slic3rpe"}
"""Namespace -> prefix; other programs recognise a namespace only by its usual prefix."""

_MESH = re.compile(rb"<mesh>.*?</mesh>", re.DOTALL)
_METADATA_TEXT = re.compile(rb"(?<=>)[^<]*(?=</metadata>)")
_PADDINGS = range(0, 8000, 1000)
"""Numbers of blanks to try in `_write_readable`."""


def write_build(build: Build, path: Path) -> None:
    """Write a build as 3MF in the dialect of its target; equal builds give equal bytes.

    Parameters
    ----------
    path
        The file appears complete; after an error or an interruption it does not appear.

    Raises
    ------
    AmprepError
        If the file cannot be written, if 3MF cannot store a mesh, or if the target is a slicer and a support
        has no thickness: slicers fill or drop open meshes.
    """
    _refuse_surfaces(build)
    merged = build.settings.target == "prusaslicer"
    document = merged_document(build) if merged else components_document(build)
    write_document(with_digest(document), path, with_volumes=merged)


def write_document(document: Document, path: Path, *, with_volumes: bool) -> None:
    """Write a 3MF package.

    Parameters
    ----------
    with_volumes
        Add PrusaSlicer's list of objects and volumes.

    Raises
    ------
    AmprepError
        If the file cannot be written, or 3MF cannot store an object.
    """
    for each in document.objects:
        check_geometry(each)
    skeleton = make_skeleton(document, ["config"] if with_volumes else [])
    others = dict(skeleton.others)
    if with_volumes:
        others[PRUSASLICER_CONFIG] = prusaslicer_config(document.objects, skeleton.object_ids)
    with replacing(path) as temporary:
        _write_readable(temporary, document, replace(skeleton, model=_finished(skeleton), others=others))


def _write_readable(path: Path, document: Document, skeleton: Skeleton) -> None:
    """Write the package so that lib3mf can read it.

    lib3mf 2.5.0 fails on a tag or text with an escaped character if the end of its buffer of 64 KiB falls within it.
    Blanks before the resources move that boundary.
    """
    size = 2 * len(skeleton.model) + sum(map(text_size, document.objects))
    others = [(name, len(data), [data]) for name, data in skeleton.others.items()]
    for padding in _PADDINGS:
        model = (MODEL_NAME, size, _model_text(document, skeleton, padding))
        write_package(path, [*others, model])
        if b"&" not in skeleton.model or is_readable(path):
            return
    raise AmprepError(
        f"cannot write {document.name!r} so that lib3mf reads it; use part names without & < > or quotes"
    )


def _refuse_surfaces(build: Build) -> None:
    surfaces = [support.name for support in build.supports if support.surface]
    if surfaces and build.settings.target != "generic":
        raise AmprepError(
            f"cannot write support {surfaces[0]!r} for {build.settings.target}: it has no thickness, "
            "and a slicer needs solids; set wall_mm of the cells above 0, or use the target generic"
        )


def _finished(skeleton: Skeleton) -> bytes:
    """Return the final model without its meshes; quotes are escaped only where XML requires it."""
    text = _with_placements(_with_prefixes(skeleton.model), skeleton.placements).replace(b"&apos;", b"'")
    return _METADATA_TEXT.sub(lambda found: found.group().replace(b"&quot;", b'"'), text)


def _model_text(document: Document, skeleton: Skeleton, padding: int) -> Iterator[bytes]:
    """Yield the model with the objects' meshes in place of the skeleton's triangles."""
    text = skeleton.model.replace(b"<resources>", b" " * padding + b"<resources>", 1)
    start = 0
    gaps = _MESH.finditer(text)
    for each, palette, gap in zip(document.objects, skeleton.palettes, gaps, strict=True):
        yield text[start : gap.start()]
        yield from mesh_text(each, palette, skeleton.object_ids)
        start = gap.end()
    yield text[start:]


def _with_prefixes(text: bytes) -> bytes:
    """Return the model with the prefixes of `PREFIXES` instead of those that lib3mf numbers."""
    for namespace, prefix in PREFIXES.items():
        declared = re.search(rb'xmlns:(\w+)="' + re.escape(namespace.encode()) + rb'"', text)
        if declared:
            old, new = declared.group(1), prefix.encode()
            text = text.replace(b"xmlns:" + old + b"=", b"xmlns:" + new + b"=")
            text = text.replace(b'<metadata name="' + old + b":", b'<metadata name="' + new + b":")
    return text


def _with_placements(text: bytes, placements: Mapping[str, Floats]) -> bytes:
    """Return the model with placements of nine digits; lib3mf itself writes six, 0.5 um at 300 mm."""

    def with_placement(found: re.Match[bytes]) -> bytes:
        matrix = placements.get(found.group(1).decode())
        if matrix is None:
            return found.group()
        numbers = " ".join(f"{value:.9g}" for value in (matrix[:3].T + 0.0).ravel().tolist())
        return f'transform="{numbers}" '.encode() + found.group()

    return re.sub(rb'p:UUID="([^"]*)"', with_placement, text)
