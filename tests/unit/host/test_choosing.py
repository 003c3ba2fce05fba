"""Choosing, setting parameters, and the guard around every call."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from amprep import interruption
from amprep.errors import InputError, Interrupted, JobError, MeshError, PluginError
from amprep.hookspecs import (
    CellEmitter,
    MeshReader,
    NoParams,
    Packer,
    PackerAccepts,
    SupportRouter,
    VolumeMaker,
)
from amprep.host import Host, Listed, mismatches
from amprep.model import (
    Boxes,
    BuildVolume,
    Cells,
    ConvexPieces,
    Item,
    Orientations,
    Packing,
    PackingProblem,
    Placement,
    Solid,
    SupportEdges,
    SupportPlan,
)
from amprep.model.rotations import axis_rotations, quarter_turns


@dataclass(frozen=True)
class Settings:
    count: int = 3
    share: float = 0.5
    label: str = "x"
    fast: bool = False
    mode: Literal["a", "b"] = "a"
    limit: float | None = None
    weights: tuple[float, ...] = (1.0,)
    window: tuple[int, int] = (0, 1)
    extra: Any = None

    def __post_init__(self) -> None:
        if self.count < 1:
            raise ValueError(f"count is at least 1, got {self.count}")


def packer(run=lambda problem: Packing(()), **fields):
    return Listed(
        "packer", Packer(fields.pop("name", "rows"), "in rows", run=run, **fields), "p", "dist", "1.2"
    )


def host_of(*listed):
    return Host(listed)


def test_an_unknown_name_is_refused_with_the_nearest():
    host = host_of(packer(name="shelves"), packer(name="towers"))
    with pytest.raises(PluginError, match=r"no packer is called 'shelfs' \(did you mean 'shelves'\?\)"):
        host.choose("packer", "shelfs")
    with pytest.raises(PluginError, match="no lattice cell is called 'shelves'"):
        host.choose("cell", "shelves")


def test_offers_keep_the_order_in_which_they_came():
    assert list(host_of(packer(name="b"), packer(name="a")).offers("packer")) == ["b", "a"]


@pytest.mark.parametrize(
    ("table", "field", "value"),
    [
        ({"count": 5}, "count", 5),
        ({"share": 1}, "share", 1.0),
        ({"fast": True}, "fast", True),
        ({"mode": "b"}, "mode", "b"),
        ({"limit": 2}, "limit", 2.0),
        ({"weights": [1, 2.5]}, "weights", (1.0, 2.5)),
        ({"weights": []}, "weights", ()),
        ({"window": [2, 3]}, "window", (2, 3)),
        ({"extra": {"deep": [1]}}, "extra", {"deep": [1]}),
    ],
)
def test_parameters_are_converted_to_their_types(table, field, value):
    listed = packer(params=Settings)
    converted = getattr(host_of(listed).params(listed, table), field)
    assert converted == value
    assert type(converted) is type(value)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"cuont": 5}, r"parameters of packer 'rows': unknown key 'cuont' \(did you mean 'count'\?\)"),
        ({"count": 0}, r"packer 'rows': count is at least 1, got 0"),
        ({"count": 1.5}, "count: expected a whole number, got 1.5"),
        ({"count": True}, "count: expected a whole number, got the truth value true"),
        ({"share": "1"}, "share: expected a number, got the text '1'"),
        ({"share": float("nan")}, "share: expected a number, got nan"),
        ({"share": 10**400}, "share: expected a number"),
        ({"label": 3}, "label: expected a text, got 3"),
        ({"fast": 1}, "fast: expected true or false, got 1"),
        ({"mode": "c"}, "mode: expected one of 'a', 'b', got the text 'c'"),
        ({"limit": "none"}, "limit: expected a number, got the text 'none'"),
        ({"weights": ["x"]}, r"weights: expected a list, each a number, got the list \['x'\]"),
        ({"window": [1]}, r"window: expected a list of a whole number, a whole number, got the list \[1\]"),
    ],
)
def test_wrong_parameters_say_what_was_expected_and_what_came(table, message):
    listed = packer(params=Settings)
    with pytest.raises(JobError, match=message):
        host_of(listed).params(listed, table)


def test_a_bug_in_a_params_class_is_the_plugins_fault():
    @dataclass(frozen=True)
    class Buggy:
        size: int = 1

        def __post_init__(self) -> None:
            if self.size > 1:
                raise KeyError("oops")

    listed = packer(params=Buggy)
    with pytest.raises(PluginError, match=r"packer 'rows' of dist 1\.2 failed: KeyError: 'oops'"):
        host_of(listed).params(listed, {"size": 2})


@pytest.mark.parametrize(
    "error",
    [
        ValueError("bad\nnews"),
        RecursionError(),
        MemoryError(),
        SystemExit(0),
        StopIteration(),
        GeneratorExit(),
    ],
)
def test_whatever_a_plugin_raises_becomes_one_line_with_the_cause_kept(error):
    def run(problem):
        raise error

    listed = packer(run)
    with pytest.raises(PluginError, match=r"^packer 'rows' of dist 1\.2 failed: ") as caught:
        host_of(listed).call(listed, None)
    assert caught.value.__cause__ is error
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("error", [MeshError("bracket: open"), KeyboardInterrupt()])
def test_errors_on_purpose_and_interrupts_pass_through(error, monkeypatch):
    monkeypatch.setattr(interruption, "is_raised_by_code", lambda: False)

    def run(problem):
        raise error

    listed = packer(run)
    with pytest.raises(type(error)) as caught:
        host_of(listed).call(listed, None)
    assert caught.value is error


def test_an_interrupt_that_no_signal_sent_is_a_failure_of_the_plugin(monkeypatch):
    monkeypatch.setattr(interruption, "is_raised_by_code", lambda: True)

    def run(problem):
        raise KeyboardInterrupt

    listed = packer(run)
    with pytest.raises(PluginError, match=r"^packer 'rows' of dist 1\.2 failed: KeyboardInterrupt$"):
        host_of(listed).call(listed, None)


def test_an_interrupt_of_the_user_names_the_plugin_that_ran(monkeypatch):
    monkeypatch.setattr(interruption, "received", lambda: 2)

    def run(problem):
        raise KeyboardInterrupt

    listed = packer(run)
    with pytest.raises(
        Interrupted, match=r"^interrupted while packer 'rows' of dist 1\.2 ran; nothing was written$"
    ):
        host_of(listed).call(listed, None)


@pytest.mark.parametrize("volumes", [(-1.0, 1.0), (float("nan"), 1.0), (1.0, float("inf"))])
def test_an_estimate_that_is_no_volume_is_refused(volumes):
    bad = Listed("cell", CellEmitter("b", "y", run=print, material=lambda pitch, step, params: volumes), "p")
    with pytest.raises(PluginError, match="volumes of edges must be finite and not negative"):
        host_of(bad).material(bad, 2.0, 3.0, NoParams())


@pytest.mark.parametrize(
    ("kind", "record", "expected"),
    [
        ("packer", Packer("x", "y", run=lambda: 3), "Packing"),
        ("volume", VolumeMaker("x", "y", run=lambda: None), "Boxes or ConvexPieces or Solid"),
        ("router", SupportRouter("x", "y", run=lambda: ()), "SupportPlan"),
        ("cell", CellEmitter("x", "y", run=list), "Cells"),
        ("reader", MeshReader("x", "y", run=lambda: (), suffixes=(".x",)), "list"),
    ],
)
def test_a_wrong_answer_is_refused(kind, record, expected):
    listed = Listed(kind, record, "p", "dist", "1.2")
    with pytest.raises(PluginError, match=f"of dist 1.2 returned [a-zA-Z]+, expected {expected}"):
        host_of(listed).call(listed)


def test_a_reader_returns_parts_and_nothing_else():
    listed = Listed("reader", MeshReader("x", "y", run=lambda: ["part"], suffixes=(".x",)), "p", "dist", "1")
    with pytest.raises(PluginError, match="items that are not Part"):
        host_of(listed).call(listed)


def test_a_right_answer_comes_back_as_it_is():
    plan = SupportPlan(SupportEdges.from_rows([]))
    cells = Cells((), [], [], [])
    for kind, record, answer in (
        ("router", SupportRouter("x", "y", run=lambda: plan), plan),
        ("cell", CellEmitter("x", "y", run=lambda: cells), cells),
    ):
        listed = Listed(kind, record, "p")
        assert host_of(listed).call(listed) is answer


def test_a_cell_without_an_estimate_counts_as_full_prisms():
    plain = Listed("cell", CellEmitter("x", "y", run=print), "p", "dist", "1")
    own = Listed("cell", CellEmitter("z", "y", run=print, material=lambda pitch, step, params: (1, 2)), "p")

    def much(pitch, step, params) -> Any:
        return "much"

    bad = Listed("cell", CellEmitter("b", "y", run=print, material=much), "p")
    host = host_of(plain, own, bad)
    assert host.material(plain, 2.0, 3.0, NoParams()) == (12.0, 12.0)
    assert host.material(own, 2.0, 3.0, NoParams()) == (1.0, 2.0)
    with pytest.raises(PluginError, match="lattice cell 'b' of module p failed: ValueError"):
        host.material(bad, 2.0, 3.0, NoParams())


def problem(volume=None, orientations=None, **fields):
    box = Boxes([[0, 0, 0]], [[1, 1, 1]])
    item = Item(0, 0, volume or box, 1.0, orientations or Orientations())
    return PackingProblem((item,), fields.pop("space", BuildVolume(np.full(3, 10.0))), **fields)


TWO = Boxes([[0, 0, 0], [1, 0, 0]], [[1, 1, 1], [2, 1, 1]])
QUARTERS, AXES = Orientations("list", quarter_turns()), Orientations("list", axis_rotations())
TILTED = Orientations("list", [np.eye(3), [[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]]])
CYLINDER = BuildVolume(np.full(3, 10.0), "cylinder")
ZONED = BuildVolume(np.full(3, 10.0), "box", [[0, 0, 0]], [[1, 1, 1]])
FIXED = (Placement(0, np.eye(3), np.zeros(3)),)


@pytest.mark.parametrize(
    ("asked", "lacking", "field", "word"),
    [
        (problem(volume=TWO), "bounding volumes of kind 'boxes'", "volumes", "boxes"),
        (problem(volume=ConvexPieces(())), "bounding volumes of kind 'convex'", "volumes", "convex"),
        (problem(volume=Solid(None)), "bounding volumes of kind 'solid'", "volumes", "solid"),
        (problem(orientations=QUARTERS), "orientations of kind 'axis'", "orientations", "axis"),
        (problem(orientations=AXES), "orientations of kind 'axis'", "orientations", "list"),
        (problem(orientations=TILTED), "orientations of kind 'list'", "orientations", "list"),
        (
            problem(orientations=Orientations("about-z")),
            "orientations of kind 'about-z'",
            "orientations",
            "about-z",
        ),
        (problem(orientations=Orientations("free")), "orientations of kind 'free'", "orientations", "free"),
        (problem(objective="fill"), "the objective 'fill'", "objectives", "fill"),
        (problem(space=CYLINDER), "a cylindrical build volume", "cylinder", None),
        (problem(space=ZONED), "forbidden zones", "zones", None),
        (problem(fixed=FIXED), "fixed placements", "fixed", None),
        (problem(stacking=True), "stacking on", "stacking", True),
        (problem(stacking=False), "stacking off", "stacking", False),
    ],
)
def test_a_packer_is_refused_for_what_it_does_not_handle_with_the_names_of_those_that_do(
    asked, lacking, field, word
):
    poor = PackerAccepts(stacking=frozenset({not word} if field == "stacking" else {True, False}))
    able = replace(PackerAccepts(), **{field: True if word is None else frozenset({word})})
    assert mismatches(poor, asked) == [lacking]
    assert mismatches(able, asked) == []
    host = host_of(packer(accepts=poor), packer(name="able", accepts=able))
    host.refuse_mismatch(host.choose("packer", "able"), asked)
    with pytest.raises(
        PluginError, match=f"packer 'rows' of dist 1.2 does not handle {lacking}; choose able"
    ):
        host.refuse_mismatch(host.choose("packer", "rows"), asked)


def test_a_packer_that_handles_everything_asked_is_accepted_and_everything_missing_is_named():
    assert mismatches(PackerAccepts(), problem()) == []
    much = replace(problem(volume=TWO, objective="fill"), space=BuildVolume(np.full(3, 9.0), "cylinder"))
    assert len(mismatches(PackerAccepts(), much)) == 3
    host = host_of(packer())
    with pytest.raises(PluginError, match="no installed packer can"):
        host.refuse_mismatch(host.choose("packer", "rows"), much)


def test_a_reader_is_found_by_suffix_or_by_the_jobs_choice():
    first, second = (
        Listed("reader", MeshReader(name, "y", run=print, suffixes=(".stl", f".{name}")), "p", "dist", "1")
        for name in ("one", "two")
    )
    host = host_of(first, second)
    assert host.reader_for(Path("A.STL")) is first
    assert host.reader_for(Path("a.two")) is second
    assert host.reader_for(Path("a.stl"), {".stl": "two"}) is second
    assert host.suffixes == (".one", ".stl", ".two")
    with pytest.raises(PluginError, match=r"no mesh reader is called 'tow' \(did you mean 'two'\?\)"):
        host.reader_for(Path("a.stl"), {".stl": "tow"})
    with pytest.raises(
        InputError, match=r"a\.step: no reader for '\.step'; known suffixes: \.one, \.stl, \.two"
    ):
        host.reader_for(Path("a.step"))
    with pytest.raises(InputError, match="no reader for 'files without a suffix'"):
        host.reader_for(Path("readme"))


def test_a_value_that_is_no_amount_is_refused_for_every_packer():
    endless = replace(problem(), items=(replace(problem().items[0], value=np.inf),))
    host = host_of(packer())
    with pytest.raises(JobError, match="the value must be between 0 and 1e\\+15, got inf"):
        host.refuse_mismatch(host.choose("packer", "rows"), endless)
