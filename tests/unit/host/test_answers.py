"""The host refuses every malformed answer by the name of its plugin, and no well-formed one."""

from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from amprep.errors import PluginError
from amprep.hookspecs import CellEmitter, MeshReader, Packer, SupportRouter, VolumeMaker
from amprep.host import KINDS, Host, Listed
from amprep.model import (
    Beams,
    Boxes,
    BuildVolume,
    CellRequest,
    Cells,
    ConvexPieces,
    ExtraMesh,
    Item,
    Mesh,
    Orientations,
    Packing,
    PackingProblem,
    Part,
    Placement,
    Solid,
    SupportEdges,
    SupportPlan,
    SupportProblem,
    Template,
    TurnedVolume,
    Unconnected,
    Unplaced,
)
from amprep.model.packing import PackingStep
from amprep.model.part import Appearance, Region
from amprep.testing import box_mesh, support_problems

BOX = box_mesh([0, 0, 0], [1, 2, 3])
PART = Part("bracket", BOX, 6.0)
PROBLEM = PackingProblem(
    tuple(Item(0, copy, Boxes([[0, 0, 0]], [[1, 1, 1]]), 1.0) for copy in range(3)),
    BuildVolume(np.full(3, 9.0)),
)
ROUTES: SupportProblem = next(problem for _, problem in support_problems() if len(problem.red))
EDGES = replace(
    SupportEdges.from_rows([[1, 1, 1, 0, 1, 1, 0], [1, 1, 2, 0, 1, 1, 0]]), group=np.zeros(2, int)
)
REQUEST = CellRequest(ROUTES.grid, EDGES, np.zeros(2, int))

PLACEMENT = Placement(1, np.eye(3), np.zeros(3))
PACKING = Packing(
    ((PLACEMENT,),), (Unplaced(0, "no room left"),), 1.0, steps=(PackingStep("a", 1.0, 2.0, 3.0),)
)
PLAN = SupportPlan(EDGES, (Unconnected(0, "enclosed"),), notes=("a note",), bound=1.0, objective=2.0)
BEAMS = Beams(np.zeros((2, 3)), np.array([[0, 1]]), np.ones((1, 2)), np.array([0]))
CELLS = Cells(
    (Template("post", BOX),),
    [0],
    [1],
    np.eye(4)[None, :3],
    (ExtraMesh(BOX, 0),),
    Beams(np.zeros((2, 3)), np.array([[0, 1]]), np.ones((1, 2)), np.array([0])),
)
FULL_PART = replace(
    PART,
    quantity=2,
    value=3.0,
    regions=(Region("blocker", "top", np.array([1, 2])), Region("lattice", "inside", mesh=BOX)),
    appearance=Appearance("#ffffffff", "steel", np.full((12, 3), -1)),
    boxes=np.array([[0.0, 0, 0, 1, 2, 3]]),
    positions=np.zeros((2, 3)),
    fixed=np.zeros((1, 3)),
    notes=("repaired",),
)

OFFERS: dict[Any, Any] = {
    "reader": (MeshReader("x", "y", run=lambda path: None, suffixes=(".x",)), Path("a.x"), [FULL_PART]),
    "volume": (
        VolumeMaker("x", "y", run=lambda part: None),
        PART,
        TurnedVolume(Solid(BOX), np.eye(3), 1.0, 0.5),
    ),
    "packer": (Packer("x", "y", run=lambda problem: None), PROBLEM, PACKING),
    "router": (SupportRouter("x", "y", run=lambda problem: None), ROUTES, PLAN),
    "cell": (CellEmitter("x", "y", run=lambda request: None), REQUEST, CELLS),
}


def answer(kind, returned):
    """Let an offer of a kind return a value, and return what the host makes of it."""
    offer, subject, _ = OFFERS[kind]
    listed = Listed(kind, replace(offer, run=lambda subject: returned), "p", "dist", "1.2")
    return Host([listed]).call(listed, subject)


@pytest.mark.parametrize("kind", OFFERS)
def test_a_well_formed_answer_comes_back_as_it_is(kind):
    right = OFFERS[kind][2]
    assert answer(kind, right) is right


@pytest.mark.parametrize("made", [Boxes([[0, 0, 0]], [[1, 1, 1]]), ConvexPieces((BOX, BOX)), Solid(BOX)])
def test_every_kind_of_bounding_volume_is_well_formed(made):
    assert answer("volume", made) is made


def broken(mesh=BOX, at=(0, 0), value=np.nan, of="vertices"):
    """Return a mesh with one entry replaced."""
    arrays = {"vertices": mesh.vertices.copy(), "triangles": mesh.triangles.copy()}
    arrays[of][at] = value
    return Mesh(**arrays)


PLACED_WRONGLY = [
    (replace(PLACEMENT, item=-1), "a placement of item -1; items are 0 to 2"),
    (replace(PLACEMENT, item=3), "a placement of item 3"),
    (replace(PLACEMENT, item=1.0), r"a placement of item 1\.0"),
    (replace(PLACEMENT, item=True), "a placement of item True"),
    (replace(PLACEMENT, translation=[0, np.nan, 0]), "item 1 with numbers that are not finite"),
    (replace(PLACEMENT, translation=[np.inf, 0, 0]), "item 1 with numbers that are not finite"),
    (replace(PLACEMENT, translation=[0, 0]), "item 1 with numbers that are not finite, or not three"),
    (replace(PLACEMENT, rotation=np.full((3, 3), np.nan)), "item 1 with numbers that are not finite"),
    ("here", "'here' in a build, expected a Placement"),
]


@pytest.mark.parametrize(("placement", "message"), PLACED_WRONGLY)
def test_a_placement_that_is_none_is_refused(placement, message):
    with pytest.raises(PluginError, match=f"^packer 'x' of dist 1.2 returned .*{message}"):
        answer("packer", replace(PACKING, builds=((placement,),)))


WRONG = [
    ("packer", {"builds": [[PLACEMENT]]}, "builds that are not a tuple of tuples"),
    ("packer", {"unplaced": (Unplaced(-1, "too large"),)}, "an unplaced item -1"),
    ("packer", {"unplaced": (Unplaced(0, None),)}, "expected an Unplaced with a reason"),
    ("packer", {"bound": np.nan}, "the bound nan, expected a finite number or None"),
    ("packer", {"bound": "1"}, "the bound '1'"),
    ("packer", {"status": "best"}, "the status 'best', expected one of optimal"),
    ("packer", {"bound_for": None}, "a bound for None"),
    ("packer", {"stop_reason": None}, "a stop_reason of None"),
    ("packer", {"steps": (1,)}, "the step 1"),
    ("packer", {"excess": {0: np.inf}}, "an excess that is not a finite number"),
    ("router", {"edges": None}, "edges of type NoneType"),
    ("router", {"unconnected": (Unconnected(-1, "enclosed"),)}, "as unconnected"),
    ("router", {"unconnected": (Unconnected(0, "tired"),)}, "the reason 'tired'"),
    ("router", {"raised": -1}, "capacities raised by -1"),
    ("router", {"bound": np.inf}, "the bound inf"),
    ("router", {"notes": [1]}, "notes that are not a tuple of texts"),
    ("volume", {"rotation": np.full((3, 3), np.nan)}, "whose matrix is not a rotation"),
    ("volume", {"rotation": 2 * np.eye(3)}, "whose matrix is not a rotation"),
    ("volume", {"volume": None}, "a turned volume of None"),
    ("volume", {"volume": Solid(broken())}, "coordinates that are not finite"),
    ("volume", {"volume": Solid(broken(of="triangles", value=-1))}, "a vertex index outside 0 to 7"),
    ("volume", {"volume": Solid(Mesh(BOX.vertices, []))}, "a mesh without triangles"),
    ("volume", {"volume": ConvexPieces(())}, "at least one mesh"),
    ("volume", {"volume": Boxes([], [])}, "boxes without two finite corners each"),
    ("volume", {"volume": Boxes([[2, 0, 0]], [[1, 1, 1]])}, "least corner is above its greatest"),
    ("volume", {"volume": Boxes([[0, 0, 0]], [[1, 1, 1], [2, 2, 2]])}, "two finite corners each"),
    ("volume", {"gap": np.nan}, "with the gap nan"),
    ("cell", {"template": [-1]}, "a template index outside 0 to 0"),
    ("cell", {"edge": [2]}, "a edge index outside 0 to 1"),
    ("cell", {"edge": [0, 1]}, "different lengths"),
    ("cell", {"matrix": np.full((1, 3, 4), np.nan)}, "coordinates that are not finite"),
    ("cell", {"templates": (BOX,)}, "something else than a tuple of Template records"),
    (
        "cell",
        {"templates": (Template("a", broken(of="triangles", value=99)),)},
        "a vertex index outside 0 to 7",
    ),
    ("cell", {"extra": (ExtraMesh(BOX, 0.5),)}, "a group index that is not a whole number"),
    ("cell", {"extra": (ExtraMesh(None, 0),)}, "NoneType as a mesh"),
    ("cell", {"hole": np.nan}, "a hole that is not a finite number"),
    ("cell", {"beams": 3}, "beams of type int"),
    ("cell", {"beams": replace(BEAMS, radii=np.full((1, 2), -1.0))}, "radii not above 0"),
    ("cell", {"beams": replace(BEAMS, struts=np.array([[0, 2]]))}, "a strut index outside 0 to 1"),
    ("cell", {"beams": replace(BEAMS, struts=np.array([[0.5, 1]]))}, "not a whole number"),
    ("reader", {"name": 3}, "a part with the name 3"),
    ("reader", {"name": "a\nb"}, "expected a text of one line"),
    ("reader", {"mesh": broken()}, "coordinates that are not finite"),
    ("reader", {"quantity": -2}, "the quantity -2, expected 1 to 100000"),
    ("reader", {"quantity": 10**9}, "the quantity 1000000000"),
    ("reader", {"value": np.nan}, "volume or value is not a finite number"),
    ("reader", {"positions": np.full((1, 3), np.nan)}, "positions are not finite numbers"),
    ("reader", {"fixed": np.zeros((1, 2))}, "fixed are not finite numbers of shape"),
    ("reader", {"boxes": "none"}, "boxes are not finite numbers"),
    ("reader", {"orientations": Orientations("list", 2 * np.eye(3))}, "is not a rotation"),
    (
        "reader",
        {"regions": (Region("blocker", "a", np.array([12])),)},
        "a triangle that the part does not have",
    ),
    ("reader", {"regions": (Region("hole", "a", mesh=BOX),)}, "the region"),
    ("reader", {"appearance": Appearance(triangle_colours=np.zeros((1, 3)))}, "triangle_colours"),
    ("reader", {"notes": "repaired"}, "notes are not a tuple of texts"),
]


@pytest.mark.parametrize(("kind", "changes", "message"), WRONG)
def test_a_malformed_answer_is_refused_with_the_name_of_the_plugin(kind, changes, message):
    right = OFFERS[kind][2]
    wrong = [replace(right[0], **changes)] if kind == "reader" else replace(right, **changes)
    with pytest.raises(PluginError, match=f"'x' of dist 1.2 returned .*{message}"):
        answer(kind, wrong)


def test_a_file_without_parts_is_no_answer():
    with pytest.raises(PluginError, match="returned no part; a file without parts must raise InputError"):
        answer("reader", [])


class Liar:
    """A value that raises whatever is asked of it."""

    def __getattr__(self, name):
        raise RuntimeError("no")

    def __repr__(self):
        raise RuntimeError("no")


HOSTILE = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(2**70), 2**70),
    st.floats(),
    st.text(max_size=5),
    st.lists(st.floats(), max_size=3),
    st.lists(st.none(), max_size=2).map(tuple),
    st.sampled_from(
        [np.zeros((0, 3)), np.array([np.nan]), np.array("a"), np.array([None, 1]), object(), {}, Liar()]
    ),
    st.sampled_from([(PLACEMENT,), BOX, Boxes([], []), PART, BEAMS, EDGES]),
)


@pytest.mark.parametrize("kind", OFFERS)
@given(data=st.data())
def test_a_field_of_any_value_is_accepted_or_refused_by_name_and_nothing_else(kind, data):
    """The record is changed in place, as a plugin may do it, so that no constructor converts the value."""
    right = OFFERS[kind][2]
    record = replace(right[0] if kind == "reader" else right)
    nested = (
        {"packer": record.builds[0][0]} if kind == "packer" else {"volume": BOX} if kind == "volume" else {}
    )
    target = data.draw(st.sampled_from([record, *map(replace, nested.values())]))
    name = data.draw(st.sampled_from([field.name for field in fields(target)]))
    object.__setattr__(target, name, data.draw(HOSTILE))
    if target is not record:
        changed = {"builds": ((target,),)} if kind == "packer" else {"volume": Solid(target)}
        record = replace(record, **changed)
    returned = [record] if kind == "reader" else record
    refused = ""
    try:
        assert answer(kind, returned) is returned
    except PluginError as error:
        refused = str(error)
    noun = KINDS[kind].noun
    assert not refused or refused.startswith(f"{noun} 'x' of dist 1.2 returned ")
    assert "\n" not in refused
