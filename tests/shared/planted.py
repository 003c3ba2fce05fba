"""Small builds written in every dialect, and ways to change the entries of their packages."""

import re
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from manifold3d import Manifold
from tests.shared.solids import mesh_of
from tests.shared.supported import box

from amprep.model import Build, BuildSettings, BuildVolume, Lattice, Mesh, Part, PlacedPart, SupportBody
from amprep.model.supports.rules import SupportRules
from amprep.model.supports.sizes import SupportSizes
from amprep.threemf import write_build

DIALECTS = ("generic", "beams", "cura", "prusaslicer")
BEAMS, CURA, PRUSASLICER = ("beams",), ("cura",), ("prusaslicer",)
COMPONENTS = ("generic", "beams", "cura")
MODEL = "3D/3dmodel.model"
CONFIG = "Metadata/Slic3r_PE_model.config"

RULES = SupportRules(
    rules="limits",
    ledge_mm=1.0,
    bridge_mm=2.0,
    bore_mm=8.0,
    least_wall_mm=0.3,
    least_contact_mm2=0.09,
    leg_ratio=10.0,
    territory="own",
    territory_margin_mm=2.5,
    drift_ratio=0.3,
    drift_mm=15.0,
)

Entries = dict[str, str]
Fault = Callable[[Entries], Entries]


@dataclass(frozen=True)
class Planted:
    """A fault in some dialects, and the promise that it breaks; None if such a file is refused."""

    name: str
    fault: Fault
    dialects: tuple[str, ...] = DIALECTS
    promise: str | None = "printed as planned"


def bracket_build(dialect: str, *, apart: float = 30.0) -> Build:
    """Return two brackets, each with a shelf over a support of its own: a box, or beams below a plate."""
    mesh = mesh_of(box((4, 8, 12), (0, 0, 0)) + box((13, 8, 3), (0, 0, 9)))
    part = Part("bracket", mesh, 600.0)
    places = [(10.0, 10.0), (10.0 + apart, 10.0)]
    parts = tuple(
        PlacedPart("bracket" if not number else "bracket-2", part, _moved(*place))
        for number, place in enumerate(places)
    )
    body = _beam_body if dialect == "beams" else _box_body
    supports = tuple(
        body(f"supports of {each.label}", number, *places[number]) for number, each in enumerate(parts)
    )
    settings = BuildSettings(
        "job.build-1",
        BuildVolume([100, 60, 60]),
        "generic" if dialect == "beams" else dialect,
        clearance=5.0,
        overlap=0.1,
        reach=1.6,
        rules=RULES,
        sizes=SupportSizes(square_mm=1.0),
    )
    return Build(settings, parts, supports)


def _moved(x: float, y: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:2, 3] = x, y
    return matrix


def _box_body(name: str, part: int, x: float, y: float) -> SupportBody:
    return SupportBody(name, mesh_of(box((8, 7, 9.1), (x + 4.5, y + 0.5, 0))), (part,))


def _beam_body(name: str, part: int, x: float, y: float) -> SupportBody:
    """Four upright beams and a diagonal one, below a plate that enters the shelf."""
    corners = np.array([[5.5, 1.5], [11.5, 1.5], [11.5, 6.5], [5.5, 6.5]]) + (x, y)
    nodes = np.vstack([np.column_stack([corners, np.full(4, z)]) for z in (0.0, 8.2)])
    struts = np.array([[0, 4], [1, 5], [2, 6], [3, 7], [0, 5]], np.int32)
    radii = np.array([[0.75, 0.75]] * 4 + [[0.8, 0.8]])
    plate = box((8, 7, 1.1), (x + 4.5, y + 0.5, 8.0))
    columns = [
        Manifold.cylinder(8.2, 0.75, 0.75, 12).translate((*corner, 0.0)) for corner in corners.tolist()
    ]
    whole = plate
    for column in columns:
        whole += column
    room = np.array([[0.0, 0, 0], [100, 60, 60]])
    return SupportBody(
        name,
        mesh_of(whole),
        (part,),
        lattice=Lattice(nodes, struts, radii, mesh_of(plate), mesh_of(whole), room),
    )


def write_entries(build: Build, path: Path) -> Entries:
    """Write a build and return the entries of its package as text."""
    write_build(build, path)
    with zipfile.ZipFile(path) as package:
        return {name: package.read(name).decode() for name in package.namelist()}


def write_package(entries: Entries, path: Path) -> Path:
    with zipfile.ZipFile(path, "w") as package:
        for name, text in entries.items():
            package.writestr(name, text)
    return path


def sub(pattern: str, replacement: str, *, entry: str = MODEL, count: int = 1) -> Fault:
    """Return a fault that replaces the first matches of a pattern, of which there must be one."""

    def fault(entries: Entries) -> Entries:
        text, number = re.subn(pattern, replacement, entries[entry], count=count, flags=re.DOTALL)
        assert number, f"{pattern} is not in {entry}"
        return entries | {entry: text}

    return fault


def drop(entry: str) -> Fault:
    """Return a fault that removes an entry of the package."""
    return lambda entries: {name: text for name, text in entries.items() if name != entry}


def add(entry: str, text: str) -> Fault:
    """Return a fault that adds an entry to the package."""
    return lambda entries: entries | {entry: text}


def scale_radii(factor: float) -> Fault:
    """Return a fault that multiplies every radius of beams."""

    def scaled(found: re.Match[str]) -> str:
        return f'{found[1]}="{float(found[2]) * factor:.9g}"'

    return lambda entries: entries | {MODEL: re.sub(r'\b(radius|r1|r2)="([^"]*)"', scaled, entries[MODEL])}


def with_body(build: Build, number: int, solid: Manifold) -> Build:
    """Return a build of which one support has another solid."""
    bodies = list(build.supports)
    bodies[number] = replace(bodies[number], mesh=mesh_of(solid))
    return replace(build, supports=tuple(bodies))


def solid_of(mesh: Mesh) -> Manifold:
    from amprep.geometry.meshes.manifold import as_manifold

    return as_manifold(mesh.vertices, mesh.triangles)


def as_before(entries: Entries) -> Entries:
    """Return the entries as the version before digests of supports wrote them."""
    text = re.sub(r', "surface": false, "sha256": "\w+"', "", entries[MODEL])
    text = re.sub(r', "at": \[[^]]*\]', "", text)
    text = re.sub(r'\s*<metadata name="amprep:(contents|digest)".*?</metadata>', "", text)
    assert text.count("sha256") == 2, "only those of the parts are left"
    return entries | {MODEL: text}
