"""Read the printers of PrusaSlicer's configurations and bundles (``.ini``).

A configuration has one printer and no sections. A bundle has sections ``[printer:NAME]``, which inherit from others by
``inherits = A; B``, of which the later has precedence. Names between asterisks are no printers of their own.
"""

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from amprep.errors import InputError
from amprep.printers.catalogue import PrinterProfile
from amprep.printers.imported.beds import profile_of_bed
from amprep.printers.imported.texts import MOST_PARENTS, number_of, outline_of

_USUAL = {"bed_shape": "0x0,200x0,200x200,0x200", "max_print_height": "200"}
"""What PrusaSlicer takes where a printer states nothing."""

_SECTION = re.compile(r"\[([^\]]*)\]\s*$")

Section = dict[str, str]


def read_ini(text: str, path: Path) -> list[PrinterProfile]:
    """Return the printers in a configuration or a bundle; variants of a model with equal beds are one.

    Raises
    ------
    InputError
        If there is no printer, or one of them is damaged.
    """
    sections = _sections(text)
    known: dict[str, Section] = {}
    printers = {
        name.removeprefix("printer:"): _with_parents(sections, name, known)
        for name in sections
        if name.startswith("printer:") and "*" not in name
    }
    if not printers and "bed_shape" in sections[""]:
        alone = sections[""]
        printers = {alone.get("printer_settings_id") or path.stem: alone}
    if not printers:
        raise InputError(f"{path}: has no printer; export the configuration or a bundle from PrusaSlicer")
    models = {
        name.removeprefix("printer_model:"): own.get("name", "")
        for name, own in sections.items()
        if name.startswith("printer_model:")
    }
    profiles = [_profile(name, own, f"PrusaSlicer, {path.name}") for name, own in printers.items()]
    families = [models.get(own.get("printer_model", ""), "") for own in printers.values()]
    return _by_model(profiles, families)


def _sections(text: str) -> dict[str, Section]:
    """Return the keys of each section; those before the first one are in a section without a name."""
    sections: dict[str, Section] = {"": {}}
    own = sections[""]
    for line in text.splitlines():
        heading = _SECTION.match(line)
        if heading:
            own = sections.setdefault(heading[1], {})
        elif not line.lstrip().startswith(("#", ";")):
            key, equals, value = line.partition("=")
            if equals:
                own[key.strip()] = value.strip()
    return sections


def _with_parents(
    sections: Mapping[str, Section], name: str, known: dict[str, Section], depth: int = 0
) -> Section:
    """Return the keys of a section and of those that it inherits from; `known` keeps those of all sections read."""
    if name in known:
        return known[name]
    own = sections[name]
    if depth > MOST_PARENTS:
        raise InputError(f"{name}: inherits from itself, or through more than {MOST_PARENTS} others")
    found: Section = {}
    for parent in filter(None, (each.strip() for each in own.get("inherits", "").split(";"))):
        if f"printer:{parent}" in sections:
            found |= _with_parents(sections, f"printer:{parent}", known, depth + 1)
        elif not _USUAL.keys() <= own.keys():
            raise InputError(
                f"{name}: inherits from {parent!r}, which is not in the file; import the bundle with it"
            )
    known[name] = found | own
    return known[name]


def _profile(name: str, own: Section, source: str) -> PrinterProfile:
    stated = {key: own.get(key) or usual for key, usual in _USUAL.items()}
    height = number_of(stated["max_print_height"], name, "height")
    if not own.get("bed_shape"):
        source += " (it states no bed: the one that PrusaSlicer takes)"
    return profile_of_bed(name, outline_of(stated["bed_shape"], name), height, source)


def _by_model(profiles: list[PrinterProfile], families: list[str]) -> list[PrinterProfile]:
    """Return one profile for the variants of a model, under its name, if they have the same build volume."""
    beds: dict[str, set[PrinterProfile]] = {}
    for profile, family in zip(profiles, families, strict=True):
        beds.setdefault(family, set()).add(replace(profile, name=""))
    found: dict[str, PrinterProfile] = {}
    for profile, family in zip(profiles, families, strict=True):
        name = family if family and len(beds[family]) == 1 else profile.name
        found.setdefault(name, replace(profile, name=name))
    return list(found.values())
