"""Find and read material profiles: built-in ones, those of the project, and those of the user."""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from amprep.errors import JobError
from amprep.materials.profile import MaterialProfile
from amprep.profiles import Catalogue, Origin, normalised
from amprep.typed import convert, make
from amprep.validation import read_table

SHIPPED = Path(__file__).parent / "profiles"

DEFAULT_MATERIALS = {
    "metal-powder-bed": "metal",
    "polymer-powder-bed": "polymer-powder",
    "filament": "plastic-fdm",
}
"""The material of a job that names none, by the technology of its printer."""

_OWN_KEYS = ("name", "aliases", "based_on")
"""Keys that a profile does not take from the one on which it is based."""


@dataclass(frozen=True)
class Material:
    """A material profile, and where it comes from."""

    profile: MaterialProfile
    origin: Origin

    @property
    def name(self) -> str:
        """Its name in job files."""
        return self.profile.name


def find_material(
    name: str, folder: Path | None = None, env: Mapping[str, str] = os.environ
) -> MaterialProfile:
    """Return the material profile called `name`, or at this path; see `amprep.profiles.Catalogue.find`."""
    return material_called(name, folder, env).profile


def material_called(name: str, folder: Path | None = None, env: Mapping[str, str] = os.environ) -> Material:
    """Return the material called `name` with its origin; see `amprep.profiles.Catalogue.find`."""
    return _catalogue(folder, env).find(name)


def list_materials(
    folder: Path | None = None, env: Mapping[str, str] = os.environ
) -> tuple[list[Material], list[str]]:
    """Return all materials and warnings; see `amprep.profiles.Catalogue.listed`."""
    return _catalogue(folder, env).listed()


def densities_of(
    materials: Sequence[str | None], default: MaterialProfile, folder: Path | None = None
) -> tuple[float | None, ...]:
    """Return the density (g/cm3) of each part.

    Parameters
    ----------
    materials
        The material that the file of each part names; None if it names none.
    default
        The job's profile, for parts whose material has no profile with a density.
    folder
        The project's folder, whose profiles are searched first.
    """
    if not any(materials):
        return (default.density_g_cm3,) * len(materials)
    known = [each.profile for each in list_materials(folder)[0] if each.profile.density_g_cm3]
    found = (
        next((each for each in known if material and names(material, each)), default)
        for material in materials
    )
    return tuple(each.density_g_cm3 for each in found)


def names(text: str, profile: MaterialProfile) -> bool:
    """Return whether a text such as ``EOS Ti-6Al-4V`` has a name of the profile as one or several whole words."""
    words = [word for word in re.split(r"[\W_]+", text.casefold()) if word]
    runs = {"".join(words[i:j]) for i in range(len(words)) for j in range(i + 1, len(words) + 1)}
    return any(normalised(name) in runs for name in (profile.name, *profile.aliases))


def _catalogue(
    folder: Path | None, env: Mapping[str, str], hidden: frozenset[Path] = frozenset()
) -> Catalogue[Material]:
    """Return the catalogue without some files."""

    def read(path: Path, origin: Origin) -> Material:
        table = {"name": path.stem, **read_table(path, "material")}
        base = convert(table.get("based_on", ""), str, f"{path}: based_on")
        if base:
            table = {**_inherited(base, path, _catalogue(folder, env, hidden | {path})), **table}
        return Material(make(MaterialProfile, table, str(path)), origin)

    return Catalogue("material", SHIPPED, read, folder, env, hidden)


def _inherited(base: str, path: Path, others: Catalogue[Material]) -> dict[str, Any]:
    """Return the keys of the profile called `base`; profiles that lead to it are hidden, so that no circle arises."""
    try:
        values = asdict(others.find(base).profile)
    except JobError as error:
        raise JobError(f"{path}: based_on: {error}") from error
    return {key: value for key, value in values.items() if key not in _OWN_KEYS and value is not None}
