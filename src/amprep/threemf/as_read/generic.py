"""What a reader of the 3MF core specification and of the Beam Lattice extension prints."""

from amprep.checks.printed.found import PrintedBody, PrintedFile, PrintedKind
from amprep.model.mesh import Mesh
from amprep.threemf.as_read.meshes import ObjectMeshes, placed
from amprep.threemf.as_read.structure import MeshInstance, Structure
from amprep.threemf.names import BEAM_NAMESPACE

_KINDS: dict[str, PrintedKind] = {
    "model": "model",
    "solidsupport": "support",
    "support": "open support",
    "surface": "surface",
}


def read_as_generic(structure: Structure, meshes: ObjectMeshes) -> PrintedFile:
    """Return the bodies by the types of their objects; a type of a components object applies to all that is in it."""
    bodies = []
    has_beams = False
    for instance in structure.instances():
        vertices, triangles = meshes.of(instance.object_id)
        beams = meshes.beams_of(instance.object_id, instance.matrix)
        has_beams |= beams is not None
        mesh = Mesh(placed(vertices, instance.matrix), triangles)
        bodies.append(PrintedBody(instance.name, kind_of(instance), mesh, beams))
    remarks = structure.remarks()
    if has_beams and BEAM_NAMESPACE not in structure.required_namespaces:
        remarks.append(
            "the file does not require the Beam Lattice extension, so readers without it leave out beams"
        )
    return PrintedFile("a reader of 3MF", structure.unit_mm, tuple(bodies), tuple(remarks))


def kind_of(instance: MeshInstance) -> PrintedKind:
    """Return how an instance is printed: by the type of the first object on its path that is no model."""
    if not instance.printable:
        return "nothing"
    types = [each.type for each in instance.path if each.type != "model"]
    return _KINDS.get(types[0], "nothing") if types else "model"
