"""What Bambu Studio and OrcaSlicer print of their own projects.

Objects are in model parts of their own, so that ids repeat; the roles and names of components are in a configuration.
The readers of build files do not know this form, since amprep does not write it.
"""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.checks.printed.found import PrintedBody, PrintedKind
from amprep.model.mesh import Mesh
from amprep.threemf.as_read.meshes import placed
from amprep.threemf.package.open import Package
from amprep.threemf.package.xml import parse_xml
from amprep.threemf.read.arrays import fetch_geometry
from amprep.threemf.read.slicer_config import ComponentRole, parse_bambu_config
from amprep.threemf.transforms import row_matrix

if TYPE_CHECKING:
    from lib3mf import Lib3MF

Roles = Mapping[tuple[int, int], ComponentRole]

_MOST_BODIES = 100_000


def read_as_bambu(package: Package, model: "Lib3MF.Model") -> list[PrintedBody]:
    """Return the bodies of a project, in the unit of the file.

    Parameters
    ----------
    package
        The scanned package, with its configuration.
    model
        The same package, read by lib3mf.

    Raises
    ------
    ValueError
        If there are parts on several plates, too many bodies, or a transform that is not finite.
    InputError
        If the configuration cannot be read.
    """
    plates = _used_plates(package.bambu_config)
    if plates > 1:
        raise ValueError(f"the project has parts on {plates} plates; move all to one")
    roles = parse_bambu_config(package.bambu_config, "the project")
    bodies: list[PrintedBody] = []
    items, index = model.GetBuildItems(), 0
    while items.MoveNext():
        item = items.GetCurrent()
        printable = index not in package.unprintable
        for body in _bodies(item.GetObjectResource(), row_matrix(item.GetObjectTransform()), None, roles):
            bodies.append(body if printable else PrintedBody(body.name, "nothing", body.mesh))
            if len(bodies) > _MOST_BODIES:
                raise ValueError(f"the project has more than {_MOST_BODIES} bodies")
        index += 1
    return bodies


def _bodies(
    thing: "Lib3MF.Object", frame: Floats, role: ComponentRole | None, roles: Roles
) -> Iterator[PrintedBody]:
    """Yield the bodies of an object under a ``(4, 4)`` matrix for row vectors."""
    if not np.isfinite(frame).all():
        raise ValueError("a transform must be finite numbers")
    if thing.IsMeshObject():
        vertices, triangles = fetch_geometry(thing)
        kind: PrintedKind = "model" if role is None or role.kind == "solid" else role.kind
        name = (role.name if role else "") or thing.GetName()
        yield PrintedBody(name, kind, Mesh(placed(vertices, frame.T), triangles))
    elif thing.IsComponentsObject():
        for index in range(thing.GetComponentCount()):
            component = thing.GetComponent(index)
            inner = component.GetObjectResource()
            own = roles.get((thing.GetModelResourceID(), inner.GetModelResourceID()), role)
            yield from _bodies(inner, row_matrix(component.GetTransform()) @ frame, own, roles)


def _used_plates(config: bytes) -> int:
    """Return on how many plates of a project there are objects."""
    plates = parse_xml(config or b"<config/>").iterchildren("plate")
    return sum(plate.find("model_instance") is not None for plate in plates)
