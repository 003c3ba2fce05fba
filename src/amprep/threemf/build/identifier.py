"""A short identifier of a build, which names of objects carry through slicers into G-code."""

import hashlib
import json
import lzma
import re
import zipfile
import zlib
from pathlib import Path

import numpy as np

from amprep.model.build import Build
from amprep.threemf.build import record
from amprep.threemf.build.values import plain
from amprep.threemf.names import MODEL_NAME

_HEAD_BYTES = 4 << 20
"""The metadata of a model is searched up to this length; it comes before the resources."""
_WRITTEN = re.compile(rb':identifier"[^>]*>([0-9a-f]{8})</metadata>')
_DAMAGED = (zipfile.BadZipFile, zlib.error, lzma.LZMAError, EOFError, RuntimeError, NotImplementedError)
"""What reading of a damaged or encrypted archive raises."""
_NAMED = re.compile(r"(?:build[^0-9A-Za-z]\d+|supported)[^0-9A-Za-z]{1,3}([0-9a-f]{8})(?![0-9A-Za-z])")
"""An identifier follows the name of a build; other numbers of eight digits, such as dates, belong to names of parts."""


def identifier_of(build: Build) -> str:
    """Return eight hexadecimal digits that follow from the settings, shapes and placements of a build.

    They consist of characters that slicers keep in names of objects, whatever else they replace.
    """
    parts = [
        [each.label, each.part.mesh.digest, plain(each.matrix.astype(np.float32).astype(np.float64))]
        for each in build.parts
    ]
    supports = [[each.name, each.digest] for each in build.supports]
    values = [
        record.settings_record(build.settings),
        record.volume_record(build.settings.space),
        parts,
        supports,
    ]
    return hashlib.sha256(json.dumps(values).encode()).hexdigest()[:8]


def object_name(labels: str, title: str) -> str:
    """Return the name of the object that holds parts with these labels; `title` is that of their build."""
    return f"{labels} ({title})"


def title_of(build: Build) -> str:
    """Return the name of a build with its identifier."""
    return f"{build.settings.build_id} {identifier_of(build)}"


def identifiers_in(text: str) -> list[str]:
    """Return what may be identifiers of builds in names of objects, in their order."""
    return list(dict.fromkeys(_NAMED.findall(text)))


def read_identifier(path: Path) -> str | None:
    """Return the identifier in the metadata of a build file, without reading its geometry; None if there is none."""
    try:
        with zipfile.ZipFile(path) as archive, archive.open(MODEL_NAME) as stream:
            head = stream.read(_HEAD_BYTES).partition(b"<resources")[0]
    except (OSError, KeyError, ValueError, *_DAMAGED):
        return None
    found = _WRITTEN.search(head)
    return None if found is None else found[1].decode()
