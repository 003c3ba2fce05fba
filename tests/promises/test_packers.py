"""Every packer on offer keeps the promise of a packing, on generated problems that it says it accepts."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.packers import PACKERS, accepted_by, packed_by

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import Boxes, BuildVolume, Item, Orientations, PackingProblem, Placement, Stop

TURN = {axis: np.roll(np.roll([[1, 0, 0], [0, 0, -1], [0, 1, 0]], axis, 0), axis, 1) for axis in range(3)}
AXIS_TURNS = np.array([np.eye(3), TURN[2], TURN[0], TURN[1], TURN[2] @ TURN[0], TURN[0] @ TURN[2]], float)
TILT = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])

lengths = st.one_of(st.integers(1, 12).map(float), st.floats(0.5, 12.0, width=32))


@st.composite
def volumes(draw, several):
    """One box, or up to three around a common corner."""
    lo, hi = [], []
    for _ in range(draw(st.integers(1, 3)) if several else 1):
        corner = [draw(st.integers(-3, 3)) for _ in range(3)]
        lo.append(corner)
        hi.append([c + draw(lengths) for c in corner])
    return Boxes(np.array(lo, float), np.array(hi, float))


@st.composite
def orientations(draw, accepts):
    kinds = ["fixed", *(kind for kind in ("axis", "list") if kind in accepts.orientations)]
    kind = draw(st.sampled_from(kinds))
    if kind == "fixed":
        return Orientations()
    turns = AXIS_TURNS[: draw(st.integers(1, 6))]
    return Orientations(matrices=turns if kind == "axis" else np.array([TILT, *turns]))


@st.composite
def build_volumes(draw, accepts):
    size = [draw(st.sampled_from([12.0, 20.0, 25.5])) for _ in range(3)]
    zones = [(5, 5, 0, 8, 30, 30), (0, 10, 3, 30, 12, 9)]
    zones = zones[: draw(st.integers(0, 2))] if accepts.zones else []
    corners = np.array(zones, float).reshape(-1, 6)
    if accepts.cylinder and draw(st.booleans()):
        return BuildVolume(np.array([size[0], size[0], size[2]]), "cylinder", corners[:, :3], corners[:, 3:])
    return BuildVolume(np.array(size), "box", corners[:, :3], corners[:, 3:])


@st.composite
def problems(draw, accepts):
    """Problems within what a packer accepts."""
    space, items = draw(build_volumes(accepts)), []
    for part in range(draw(st.integers(1, 5))):
        volume = draw(volumes("boxes" in accepts.volumes and draw(st.booleans())))
        allowed = draw(orientations(accepts))
        value = float(draw(st.integers(0, 20)))
        copies = draw(st.integers(1, 4))
        items += [Item(part, copy, volume, value, allowed) for copy in range(copies)]
    return PackingProblem(
        tuple(items),
        space,
        draw(st.sampled_from(sorted(accepts.objectives))),
        clearance=draw(st.sampled_from([0.0, 0.5, 2.0])),
        lift=draw(st.sampled_from([0.0, 3.0])),
        stacking=draw(st.sampled_from(sorted(accepts.stacking))),
    )


@pytest.mark.parametrize("packer", PACKERS)
@examples(40)
@given(data=st.data())
def test_a_packing_keeps_its_promise(packer, data):
    problem = data.draw(problems(accepted_by(packer)))
    assert check_packing(problem, packed_by(packer, problem)) == []


@pytest.mark.parametrize("packer", PACKERS)
@examples(15)
@given(data=st.data())
def test_what_stands_already_stays_and_is_avoided(packer, data):
    accepts = accepted_by(packer)
    if not accepts.fixed:
        pytest.skip("accepts no fixed placements")
    problem = data.draw(problems(accepts))
    first = packed_by(packer, problem)
    assume(first.builds and len(first.builds[0]) > 1)
    kept = first.builds[0][:: data.draw(st.integers(1, 3))]
    fixed = tuple(Placement(p.item, p.rotation, p.translation) for p in kept)
    with_fixed = PackingProblem(
        problem.items,
        problem.space,
        problem.objective,
        fixed,
        problem.clearance,
        problem.lift,
        problem.stacking,
    )
    assert check_packing(with_fixed, packed_by(packer, with_fixed)) == []


@pytest.mark.parametrize("packer", PACKERS)
def test_the_same_seed_gives_the_same_packing(packer):
    rng = np.random.default_rng(3)
    items = tuple(
        Item(i, 0, Boxes(np.zeros((1, 3)), s[None]), 1.0) for i, s in enumerate(rng.uniform(2, 9, (30, 3)))
    )
    accepts = accepted_by(packer)
    objective = "builds" if "builds" in accepts.objectives else sorted(accepts.objectives)[0]
    problem = PackingProblem(
        items, BuildVolume(np.full(3, 20.0)), objective, stacking=True in accepts.stacking
    )
    one, other = packed_by(packer, problem), packed_by(packer, problem)
    assert [[p.matrix.tolist() for p in b] for b in one.builds] == [
        [p.matrix.tolist() for p in b] for b in other.builds
    ]


@pytest.mark.parametrize("packer", PACKERS)
def test_a_packer_that_is_stopped_at_once_still_keeps_its_promise(packer):
    rng = np.random.default_rng(4)
    items = tuple(
        Item(i, 0, Boxes(np.zeros((1, 3)), s[None]), 1.0) for i, s in enumerate(rng.uniform(2, 9, (60, 3)))
    )
    accepts = accepted_by(packer)
    objective = "builds" if "builds" in accepts.objectives else sorted(accepts.objectives)[0]
    problem = PackingProblem(
        items, BuildVolume(np.full(3, 20.0)), objective, stacking=True in accepts.stacking
    )
    assert check_packing(problem, packed_by(packer, problem, Stop.after(0.0))) == []
