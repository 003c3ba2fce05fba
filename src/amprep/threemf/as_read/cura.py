"""What Cura prints: every mesh as a part, unless the settings of its object say otherwise.

Cura's reader ignores the types of objects. The judge demands that they agree, for other readers; see `generic`.
"""

from amprep.checks.printed.found import PrintedBody, PrintedFile, PrintedKind
from amprep.model.mesh import Mesh
from amprep.threemf.as_read.generic import kind_of
from amprep.threemf.as_read.meshes import ObjectMeshes, placed
from amprep.threemf.as_read.structure import FileObject, MeshInstance, Structure
from amprep.threemf.names import CORE_NAMESPACE, CURA_NAMESPACE

_CORE = f"{{{CORE_NAMESPACE}}}"
_KINDS: dict[str, PrintedKind] = {
    "support_mesh": "support",
    "anti_overhang_mesh": "blocker",
    "infill_mesh": "modifier",
    "cutting_mesh": "modifier",
}
_DROP_DOWN = "support_mesh_drop_down"
"""Whether Cura prints supports below a support too, which it does unless the file forbids it."""
_PREFIX, _PROJECT = "cura", "cura/"


def read_as_cura(structure: Structure, meshes: ObjectMeshes) -> PrintedFile:
    """Return the bodies by Cura's settings of their objects; every other setting is a remark."""
    bodies = []
    remarks = structure.remarks()
    for instance in structure.instances():
        vertices, triangles = meshes.of(instance.object_id)
        settings = _settings_of(instance)
        foreign = sorted(settings.keys() - _KINDS - {_DROP_DOWN})
        drops = settings.get(_DROP_DOWN, "true" if "support_mesh" in settings else "false")
        if drops.strip().lower() != "false":
            remarks.append(f"it would fill the space below {instance.name!r} down to the plate")
        if foreign:
            remarks.append(
                f"it would print {instance.name!r} with settings of its own: {', '.join(foreign)[:80]}"
            )
        mesh = Mesh(placed(vertices, instance.matrix), triangles)
        bodies.append(PrintedBody(instance.name, _kind_of(instance, settings), mesh))
    project = [name for name in structure.entries if name.lower().startswith(_PROJECT)]
    remarks += [f"the package has settings of a Cura project, {name[:80]}" for name in project[:1]]
    remarks += _of_no_object(structure)
    return PrintedFile("Cura", structure.unit_mm, tuple(bodies), tuple(remarks))


def _kind_of(instance: MeshInstance, settings: dict[str, str]) -> PrintedKind:
    if kind_of(instance) in ("nothing", "surface", "open support"):
        return kind_of(instance)
    for name, kind in _KINDS.items():
        if settings.get(name, "").strip().lower() == "true":
            return kind
    return "model"


def _settings_of(instance: MeshInstance) -> dict[str, str]:
    """Return Cura's settings of an instance; those of inner objects have precedence."""
    found: dict[str, str] = {}
    for each in instance.path:
        found |= _own_settings(each)
    return found


def _own_settings(thing: FileObject) -> dict[str, str]:
    """Return an object's settings; those with another prefix or namespace, which may count, keep a prefix."""
    found = {}
    for each in thing.element.iterfind(f"{_CORE}metadatagroup/{_CORE}metadata"):
        prefix, _, name = each.get("name", "").rpartition(":")
        is_named, is_declared = prefix == _PREFIX, each.nsmap.get(prefix) == CURA_NAMESPACE
        if is_named or is_declared:
            found[name if is_named and is_declared else each.get("name", "")] = each.text or ""
    return found


def _of_no_object(structure: Structure) -> list[str]:
    """Return a remark for settings of Cura that belong to the model or to build items, where amprep writes none."""
    entries = structure.root.iterfind(f"{_CORE}metadata")
    items = structure.root.iterfind(f"{_CORE}build/{_CORE}item/{_CORE}metadatagroup/{_CORE}metadata")
    named = [(each, each.get("name", "")) for each in (*entries, *items)]
    found = [
        name
        for each, name in named
        if name.startswith(f"{_PREFIX}:") or each.nsmap.get(name.rpartition(":")[0]) == CURA_NAMESPACE
    ]
    return [f"the model or a build item has settings of Cura: {', '.join(found)[:80]}"] if found else []
