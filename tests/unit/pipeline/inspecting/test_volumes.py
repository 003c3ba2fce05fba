"""Volume makers are compared by any name: each is measured, judged, and a failure is a row of its own."""

import sys
from types import ModuleType

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.errors import JobError, PluginError
from amprep.hookspecs import VolumeMaker, hookimpl
from amprep.host import Host
from amprep.job import job_from_inputs
from amprep.measures.contents import measure_contents
from amprep.model import Boxes, Part, Solid, Stop, TurnedVolume, silent
from amprep.model.mesh import join_meshes
from amprep.pipeline.inspecting.volumes import makers_named, measure_volumes
from amprep.pipeline.resolve import resolve
from amprep.report.inspection.record import InspectedPart

CUBE = box_mesh((0, 0, 0), (10, 10, 10))


def offers():
    """A maker that is right and knows a bound, one that leaves out half, one that fails, and one that crashes."""

    def bounded(part, *, params, rng, stop):
        lo, hi = part.mesh.bounds
        return TurnedVolume(Boxes(lo[None] - 1, hi[None] + 1), np.eye(3), bound=864.0, gap=0.5)

    def half(part, *, params, rng, stop):
        lo, hi = part.mesh.bounds
        return Boxes(lo[None], (lo + (hi - lo) / 2)[None])

    def refuses(part, *, params, rng, stop):
        raise JobError("this part is not for me")

    def crashes(part, *, params, rng, stop):
        raise ZeroDivisionError("oh")

    def shell(part, *, params, rng, stop):
        lo, hi = part.mesh.bounds
        return Solid(box_mesh(tuple(lo - 1), tuple(hi - lo + 2)))

    for name, run, makes in (
        ("bounded", bounded, "box"), ("half", half, "box"), ("refuses", refuses, "box"),
        ("crashes", crashes, "box"), ("shell", shell, "solid"),
    ):  # fmt: skip
        yield VolumeMaker(name, "A maker.", run=run, makes=makes)


@pytest.fixture
def resolved(monkeypatch):
    module = ModuleType("made_for_inspection")
    setattr(module, "amprep_api", 1)  # noqa: B010 a module has no such attribute
    setattr(module, "amprep_volume_makers", hookimpl(offers))  # noqa: B010
    monkeypatch.setitem(sys.modules, "made_for_inspection", module)
    host = Host.load(modules=["made_for_inspection"], plugins_enabled=True)
    return resolve(job_from_inputs(["cube.stl"]), host)


def measured(resolved, words, stop=None):
    part = Part("cube", CUBE, 1000.0)
    found = InspectedPart(part, measure_contents(part))
    chains = makers_named(resolved, words)
    (result,) = measure_volumes([found], chains, 0, stop or Stop(), silent)
    return {volume.makers: volume for volume in result.volumes}


def test_a_volume_has_its_ratio_bound_gap_and_verdict(resolved):
    volume = measured(resolved, ["bounded"])["bounded"]
    assert (volume.kind, volume.pieces, volume.triangles) == ("box", 1, 12)
    assert volume.ratio == pytest.approx(1.728)
    assert volume.bound_mm3 == 864.0
    assert volume.gap == pytest.approx(0.5)
    assert (volume.violations, volume.verdict, volume.failure) == ((), "contains the part", "")


def test_a_volume_that_leaves_something_out_is_judged(resolved):
    volume = measured(resolved, ["half"])["half"]
    assert volume.violations[0].promise == "volume contains part"
    assert volume.verdict == "does not contain the part"


def test_makers_that_fail_are_listed_with_the_reason_and_hinder_no_other(resolved):
    found = measured(resolved, ["refuses", "crashes", "bounded"])
    assert found["refuses"].failure == "this part is not for me"
    assert "ZeroDivisionError" in found["crashes"].failure or "oh" in found["crashes"].failure
    assert found["bounded"].made is not None


def test_all_stands_for_every_offer_each_once_but_boxes_that_the_job_does_not_give(resolved):
    found = measured(resolved, ["all", "shell,bounded", "box"])
    assert {"box", "mesh", "bounded", "half", "shell,bounded"} <= set(found)
    assert "boxes" not in found
    assert found["shell,bounded"].ratio == pytest.approx(14**3 / 1000)


def test_boxes_of_the_job_fail_with_the_reason_if_the_user_asks_for_them(resolved):
    found = measured(resolved, ["all", "boxes"])
    assert "needs boxes" in found["boxes"].failure


def test_unknown_makers_and_wrong_chains_are_refused_at_once(resolved):
    with pytest.raises(PluginError, match="bonded"):
        makers_named(resolved, ["bonded"])
    with pytest.raises(JobError, match="must be the last"):
        makers_named(resolved, ["bounded,shell"])


def test_after_the_time_limit_no_maker_begins(resolved):
    found = measured(resolved, ["bounded", "shell"], Stop.after(0.0))
    assert [volume.failure for volume in found.values()] == ["time limit", "time limit"]


def test_overlapping_shells_count_once_in_the_ratio(resolved):
    both = join_meshes([CUBE, box_mesh((5, 0, 0), (10, 10, 10))])
    part = Part("two", both, 1500.0)
    (result,) = measure_volumes(
        [InspectedPart(part, measure_contents(part))], makers_named(resolved, ["mesh"]), 0, Stop(), silent
    )
    assert result.volumes[0].ratio == pytest.approx(1.0)
