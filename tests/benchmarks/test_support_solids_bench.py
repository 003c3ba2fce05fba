"""Time to make the solids of supports of a ball on a fine grid, by kind of connector, beside whole squares."""

import time
from functools import cache

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.supported import part_of

from amprep.geometry.connectors.least_width import LeastSection
from amprep.host import Host
from amprep.model import BuildVolume, Stop, silent
from amprep.model.contacts import ConnectorRules
from amprep.supports.plan import plan_supports
from amprep.supports.rules import PlanningRules
from amprep.supports.solids.build import SolidRules, build_supports

SPACE = BuildVolume([60, 60, 60])

MOST = {"full": 1.5, "teeth": 8.0, "point": 12.0}
"""Largest ratio of the time to that of whole squares; the aim is 2."""


@cache
def host():
    return Host.load(plugins_enabled=False)


@cache
def scene():
    part = part_of(Manifold.sphere(28.0, 160).translate((30.0, 30.0, 28.0)), "ball")
    router = host().choose("router", "shortest-paths")

    def route(problem, stop, progress):
        params, rng = host().params(router, {}), np.random.default_rng(0)
        return host().call(router, problem, params=params, rng=rng, stop=stop, progress=progress)

    rules = PlanningRules(pitch_mm=1.0)
    return part, plan_supports((part,), SPACE, rules, route=route, stop=Stop(), progress=silent)


def make(connector):
    part, layout = scene()
    emitter = host().choose("cell", "prism")
    params = host().params(emitter, {})
    return build_supports(
        layout,
        (part,),
        lambda request: host().call(emitter, request, params=params, stop=Stop(), progress=silent),
        SolidRules(connector=ConnectorRules(connector=connector), least=LeastSection(0.3, 0.09)),
        stop=Stop(),
        progress=silent,
    )


def seconds(connector):
    began = time.process_time()
    assert make(connector)
    return time.process_time() - began


@pytest.mark.parametrize("connector", ["full", "teeth", "point"])
def test_solids_of_supports_of_a_ball(benchmark, connector):
    make(connector)
    whole = min(seconds("full") for _ in range(3))
    own = min(seconds(connector) for _ in range(3))
    benchmark.extra_info.update(seconds=own, ratio_to_whole_squares=own / whole)
    benchmark.pedantic(lambda: make(connector), rounds=1)
    assert own / whole <= MOST[connector]
