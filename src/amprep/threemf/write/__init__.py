"""Writing a build job: the dialect's document in lib3mf's structure, with exact meshes and placements."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from amprep.arrays import Floats
from amprep.errors import AmprepError
from amprep.files import replacing
from amprep.model.build import Build
from amprep.threemf.build.record import NAMESPACE
from amprep.threemf.package.write import write_package
from amprep.threemf.write.document import Document
from amprep.threemf.write.generic_and_cura import CURA_NAMESPACE, components_document
from amprep.threemf.write.geometry import check_geometry, mesh_text, text_size
from amprep.threemf.write.prusaslicer import CONFIG_NAME, SLICER_NAMESPACE, merged_document, slicer_config
from amprep.threemf.write.skeleton import MODEL_NAME, Skeleton, is_readable, make_skeleton

PREFIXES = {NAMESPACE: "amprep", CURA_NAMESPACE: "cura", SLICER_NAMESPACE: "slic3rpe"}
"""Prefixes by the letters of which other programs know a namespace, and our own to be read by people."""

_MESH = re.compile(rb"<mesh>.*?</mesh>", re.DOTALL)
_METADATA_TEXT = re.compile(rb"(?<=>)[^<]*(?=</metadata>)")
_PADDINGS = range(0, 8000, 1000)


def write_build(build: Build, path: Path) -> None:
    """Write the build as 3MF in the dialect of its target; equal builds give equal bytes.

    Parameters
    ----------
    path
        Appears whole or, after any error or interruption, not at all.

    Raises
    ------
    AmprepError
        If the file cannot be written, a mesh is nothing that 3MF can hold, or the target is a slicer and a
        support has no thickness: slicers fill or drop what is open.
    """
    _refuse_surfaces(build)
    merged = build.settings.target == "prusaslicer"
    write_document(merged_document(build) if merged else components_document(build), path, slicer=merged)


def write_document(document: Document, path: Path, *, slicer: bool) -> None:
    """Write a 3MF package; with `slicer`, PrusaSlicer's own list of objects and volumes beside the model."""
    for body in document.bodies:
        check_geometry(body)
    skeleton = make_skeleton(document, ["config"] if slicer else [])
    others = dict(skeleton.others)
    if slicer:
        others[CONFIG_NAME] = slicer_config(document.bodies, skeleton.object_ids)
    with replacing(path) as temporary:
        _write_readable(temporary, document, replace(skeleton, model=_finished(skeleton), others=others))


def _write_readable(path: Path, document: Document, skeleton: Skeleton) -> None:
    """Write the package so that lib3mf can read it.

    lib3mf 2.5.0 fails on a tag or text with an escaped character that its buffer of 64 KiB cuts; some blanks
    before the first tag with a mesh move the cut.
    """
    size = 2 * len(skeleton.model) + sum(map(text_size, document.bodies))
    others = [(name, len(data), [data]) for name, data in skeleton.others.items()]
    for padding in _PADDINGS:
        model = (MODEL_NAME, size, _model_text(document, skeleton, padding))
        write_package(path, [*others, model], regular=any(body.beams for body in document.bodies))
        if b"&" not in skeleton.model or is_readable(path):
            return
    raise AmprepError(
        f"cannot write {document.name!r} so that lib3mf reads it; use part names without & < > or quotes"
    )


def _refuse_surfaces(build: Build) -> None:
    surfaces = [support.name for support in build.supports if support.surface]
    if surfaces and build.settings.target != "generic":
        raise AmprepError(
            f"cannot write support {surfaces[0]!r} for {build.settings.target}: a slicer needs walls with a "
            "thickness; give the cells a wall_mm above 0 or write for generic"
        )


def _finished(skeleton: Skeleton) -> bytes:
    """Return the model as it is to be, but for its meshes: quotes are escaped only where they must be."""
    text = _with_placements(_with_prefixes(skeleton.model), skeleton.placements).replace(b"&apos;", b"'")
    return _METADATA_TEXT.sub(lambda found: found.group().replace(b"&quot;", b'"'), text)


def _model_text(document: Document, skeleton: Skeleton, padding: int) -> Iterator[bytes]:
    """Yield the model with the bodies' own meshes in the place of lib3mf's triangles."""
    text = skeleton.model.replace(b"<resources>", b" " * padding + b"<resources>", 1)
    start = 0
    places = _MESH.finditer(text)
    for body, palette, place in zip(document.bodies, skeleton.palettes, places, strict=True):
        yield text[start : place.start()]
        yield from mesh_text(body, palette, skeleton.object_ids)
        start = place.end()
    yield text[start:]


def _with_prefixes(text: bytes) -> bytes:
    """Return the model with the prefixes that lib3mf numbers changed into the known ones."""
    for namespace, prefix in PREFIXES.items():
        declared = re.search(rb'xmlns:(\w+)="' + re.escape(namespace.encode()) + rb'"', text)
        if declared:
            old, new = declared.group(1), prefix.encode()
            text = text.replace(b"xmlns:" + old + b"=", b"xmlns:" + new + b"=")
            text = text.replace(b'<metadata name="' + old + b":", b'<metadata name="' + new + b":")
    return text


def _with_placements(text: bytes, placements: Mapping[str, Floats]) -> bytes:
    """Return the model with placements of nine digits; lib3mf itself keeps six, 0.5 um at 300 mm."""

    def placed(found: re.Match[bytes]) -> bytes:
        matrix = placements.get(found.group(1).decode())
        if matrix is None:
            return found.group()
        numbers = " ".join(f"{value:.9g}" for value in (matrix[:3].T + 0.0).ravel().tolist())
        return f'transform="{numbers}" '.encode() + found.group()

    return re.sub(rb'p:UUID="([^"]*)"', placed, text)
