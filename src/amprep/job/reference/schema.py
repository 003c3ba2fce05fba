"""The JSON schema of job files, by which editors complete and check keys."""

import types
from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import Any, Literal, Union, get_args, get_origin

from amprep.job.reference.page import KeyText, key_texts
from amprep.job.settings.cells import CellSettings
from amprep.job.settings.job import ReadingSettings
from amprep.job.settings.packing import PackingSettings
from amprep.job.settings.parts import PartSettings
from amprep.job.settings.rules import RuleSettings
from amprep.job.settings.supports import SupportSettings
from amprep.model.build import TARGETS
from amprep.typed import field_types

SECTIONS: Mapping[str, type] = {
    "packing": PackingSettings,
    "supports": SupportSettings,
    "cells": CellSettings,
    "reading": ReadingSettings,
}
"""Records of the tables of a job file."""

ENTRIES: Mapping[str, type] = {"part": PartSettings, "rule": RuleSettings}
"""Records of the lists of tables."""

_SCALARS = {bool: "boolean", int: "integer", float: "number", str: "string"}

_TOP: Mapping[str, Any] = {
    "name": {"type": "string"},
    "inputs": {"type": "array", "items": {"type": "string"}},
    "labels": {"type": "string"},
    "printer": {"anyOf": [{"type": "string"}, {"type": "object"}]},
    "material": {"type": "string"},
    "seed": {"type": "integer", "minimum": 0},
    "target": {"enum": list(TARGETS)},
}


def job_schema() -> dict[str, Any]:
    """Return the schema, draft 7."""
    texts = key_texts()
    properties = {key: {**own, **_described(texts[""][key])} for key, own in _TOP.items()}
    properties |= {name: _table(cls, texts[name]) for name, cls in SECTIONS.items()}
    properties |= {
        name: {"type": "array", "items": _table(cls, texts[name])} for name, cls in ENTRIES.items()
    }
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "amprep job",
        "type": "object",
        "additionalProperties": False,
        "properties": properties,
    }


def _table(cls: type, texts: Mapping[str, KeyText]) -> dict[str, Any]:
    wanted = field_types(cls)
    properties = {}
    for field in fields(cls):
        own = {**_type(wanted[field.name]), **_described(texts[field.name])}
        if field.default is not MISSING and isinstance(field.default, bool | int | float | str):
            own["default"] = field.default
        properties[field.name] = own
    return {"type": "object", "additionalProperties": False, "properties": properties}


def _described(text: KeyText) -> dict[str, str]:
    return {"description": f"{text.meaning} (default: {text.default})" if text.default else text.meaning}


def _entries(arguments: tuple[Any, ...]) -> dict[str, Any]:
    """Return the schema of the entries of a list, of any number or of one type each."""
    if arguments[-1:] == (Ellipsis,):
        return {"items": _type(arguments[0])}
    count = len(arguments)
    return {"items": [_type(each) for each in arguments], "minItems": count, "maxItems": count}


def _type(wanted: Any) -> dict[str, Any]:
    """Return the schema of a type that a key may have."""
    origin, arguments = get_origin(wanted), get_args(wanted)
    if wanted in _SCALARS:
        return {"type": _SCALARS[wanted]}
    if origin is Literal:
        return {"enum": list(arguments)}
    if origin in (Union, types.UnionType):
        kinds = [_type(each) for each in arguments if each is not type(None)]
        return kinds[0] if len(kinds) == 1 else {"anyOf": kinds}
    if origin is tuple:
        return {"type": "array", **_entries(arguments)}
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {"type": "object"}
    return {}
