"""Find the material profiles by name."""

from difflib import get_close_matches
from pathlib import Path

from amprep.errors import JobError
from amprep.materials.profile import MaterialProfile
from amprep.typed import make
from amprep.validation import read_table

SHIPPED = Path(__file__).parent / "profiles"

DEFAULT_MATERIALS = {
    "metal-powder-bed": "metal",
    "polymer-powder-bed": "polymer-powder",
    "filament": "plastic-fdm",
}
"""The material of a job that names none, by the technology of its printer."""


def find_material(name: str, folder: Path | None = None) -> MaterialProfile:
    """Return the material profile called `name`.

    Parameters
    ----------
    name
        Name of a profile, or path of a profile (.toml).
    folder
        The base of relative paths.

    Raises
    ------
    JobError
        If there is no such profile (with the most similar name), or it is invalid.
    """
    path = (folder or Path()) / name if name.lower().endswith(".toml") else SHIPPED / f"{name}.toml"
    known = sorted(each.stem for each in SHIPPED.glob("*.toml"))
    if name in known or name.lower().endswith(".toml"):
        return make(MaterialProfile, {"name": path.stem, **read_table(path, "material")}, str(path))
    close = get_close_matches(name, known, n=1)
    hint = f"did you mean {close[0]!r}?" if close else f"known are {', '.join(known)}"
    raise JobError(f"no material is called {name!r} ({hint})")
