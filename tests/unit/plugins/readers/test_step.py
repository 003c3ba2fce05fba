"""STEP files are read with cascadio; the example is a box written by hand."""

import sys

import pytest

from amprep.errors import InputError
from amprep.pipeline.reading import repair_part
from amprep.plugins.readers.step import StepParams, read_step_file

HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('box','',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
"""


class Step:
    """Number the records of a STEP file."""

    def __init__(self):
        self.lines = []

    def add(self, text):
        self.lines.append(f"#{len(self.lines) + 1}={text};")
        return f"#{len(self.lines)}"

    def point(self, at):
        return self.add(f"CARTESIAN_POINT('',({at[0]:.6f},{at[1]:.6f},{at[2]:.6f}))")

    def direction(self, along):
        return self.add(f"DIRECTION('',({along[0]:.1f},{along[1]:.1f},{along[2]:.1f}))")


def face(step, corners, edge, axis, side):
    """Add a face of the box: across `axis`, at its near (0) or far (1) side."""
    loop = []
    for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)) if side else ((0, 0), (0, 1), (1, 1), (1, 0)):
        corner = [0, 0, 0]
        corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = side, u, v
        loop.append(tuple(corner))
    around = ",".join(edge(a, b) for a, b in zip(loop, loop[1:] + loop[:1], strict=True))
    edge_loop = step.add(f"EDGE_LOOP('',({around}))")
    bound = step.add(f"FACE_OUTER_BOUND('',{edge_loop},.T.)")
    normal = step.direction([side * 2.0 - 1.0 if i == axis else 0.0 for i in range(3)])
    across = step.direction([1.0 if i == (axis + 1) % 3 else 0.0 for i in range(3)])
    frame = step.add(f"AXIS2_PLACEMENT_3D('',{step.point(corners[loop[0]])},{normal},{across})")
    plane = step.add(f"PLANE('',{frame})")
    return step.add(f"ADVANCED_FACE('',({bound}),{plane},.T.)")


def box_step(size):
    """Return an AP214 file of one box: six plane faces, twelve edges, eight vertices, in millimetres."""
    step = Step()
    corners = {
        (x, y, z): (x * size[0], y * size[1], z * size[2]) for x in (0, 1) for y in (0, 1) for z in (0, 1)
    }
    vertices = {key: step.add(f"VERTEX_POINT('',{step.point(at)})") for key, at in corners.items()}
    edges = {}

    def edge(start, end):
        low, high = min(start, end), max(start, end)
        if (low, high) not in edges:
            along = [b - a for a, b in zip(low, high, strict=True)]
            vector = step.add(f"VECTOR('',{step.direction(along)},1.)")
            line = step.add(f"LINE('',{step.point(corners[low])},{vector})")
            edges[low, high] = step.add(f"EDGE_CURVE('',{vertices[low]},{vertices[high]},{line},.T.)")
        return step.add(f"ORIENTED_EDGE('',*,*,{edges[low, high]},{'.T.' if start == low else '.F.'})")

    faces = [face(step, corners, edge, axis, side) for axis in range(3) for side in (0, 1)]
    shell = step.add(f"CLOSED_SHELL('',({','.join(faces)}))")
    solid = step.add(f"MANIFOLD_SOLID_BREP('box',{shell})")
    millimetre = step.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
    radian = step.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
    steradian = step.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
    accuracy = step.add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{millimetre},'','')")
    context = step.add(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({accuracy}))"
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({millimetre},{radian},{steradian}))REPRESENTATION_CONTEXT('',''))"
    )
    shape = step.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',({solid}),{context})")
    application = step.add("APPLICATION_CONTEXT('automotive_design')")
    product_context = step.add(f"PRODUCT_CONTEXT('',{application},'mechanical')")
    product = step.add(f"PRODUCT('box','box','',({product_context}))")
    formation = step.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    design = step.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = step.add(f"PRODUCT_DEFINITION('design','',{formation},{design})")
    described = step.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
    step.add(f"SHAPE_DEFINITION_REPRESENTATION({described},{shape})")
    return HEAD + "\n".join(step.lines) + "\nENDSEC;\nEND-ISO-10303-21;\n"


def test_a_box_is_read_in_millimetres_as_a_solid(tmp_path, capfd):
    pytest.importorskip("cascadio")
    path = tmp_path / "box.step"
    path.write_text(box_step((10, 20, 30)))
    (part,) = (repair_part(part, allow_surface=False) for part in read_step_file(path, StepParams()))
    assert part.name == "box"
    assert part.volume_mm3 == pytest.approx(6000, rel=1e-6)
    assert len(part.mesh.triangles) == 12
    assert "triangulated" in part.notes[0]
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "empty"),
        ("nonsense", "not a STEP file"),
        (HEAD, "incomplete"),
        (HEAD + "ENDSEC;\nEND-ISO-10303-21;\n", "no shape"),
        (box_step((1, 2, 3)).replace("ADVANCED_FACE", "NO_FACE"), "no triangles"),
    ],
)
def test_other_files_are_rejected_with_a_message_of_one_line(tmp_path, content, words, capfd):
    pytest.importorskip("cascadio")
    path = tmp_path / "a.step"
    path.write_text(content)
    with pytest.raises(InputError, match=words) as caught:
        read_step_file(path, StepParams())
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_without_cascadio_the_message_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "cascadio", None)
    with pytest.raises(InputError, match=r'pip install "amprep\[step\]"'):
        read_step_file(tmp_path / "a.step", StepParams())


@pytest.mark.parametrize(
    "wrong", [{"deviation_mm": 0.0}, {"angle_deg": 90.0}, {"deviation_mm": float("nan")}]
)
def test_parameters_outside_their_bounds_are_rejected(wrong):
    with pytest.raises(ValueError, match="must be"):
        StepParams(**wrong)
