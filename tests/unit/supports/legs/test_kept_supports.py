"""Bodies of groups that do not change are made once; with them, the result is the one without."""

from functools import cache

import numpy as np
import pytest
from tests.shared.layouts import box, layout, placed

from amprep import workers
from amprep.host import Host
from amprep.model import Stop, silent
from amprep.model.contacts import BaseRules
from amprep.supports.solids.build import SolidRules, Surroundings, build_supports
from amprep.supports.solids.least_section import without_columns

PARTS = placed(box((8, 8, 3), (0, 0, 12)), box((8, 8, 3), (20, 0, 12)))
"""Two slabs that need columns, one support group each."""


@cache
def planned():
    found = layout(PARTS, leg_ratio=0.0)
    assert found.group_parts == ((0,), (1,))
    return found


def reduced():
    """Without the first column of the second part."""
    lost = np.zeros(len(planned().connected), np.bool_)
    lost[np.flatnonzero(planned().red_group == 1)[0]] = True
    return without_columns(planned(), lost)


def built(given, cell, base, around):
    host = Host.load(plugins_enabled=False)
    emitter = host.choose("cell", cell)

    def emit(request):
        return host.call(emitter, request, params=host.params(emitter, {}), stop=Stop(), progress=silent)

    return build_supports(
        given, PARTS, emit, SolidRules(base=base), around=around, stop=Stop(), progress=silent
    )


def corners(body):
    """The corners of all triangles: their order may depend on what was built before."""
    return sorted(body.mesh.vertices[body.mesh.triangles].reshape(-1, 3).tolist())


@pytest.mark.parametrize("base", [BaseRules(), BaseRules("flange")])
@pytest.mark.parametrize("cell", ["prism", "x-wall"])
def test_only_the_group_that_lost_a_column_is_built_again(cell, base):
    around = Surroundings()
    first = built(planned(), cell, base, around)
    again = built(reduced(), cell, base, around)
    alone = built(reduced(), cell, base, Surroundings())
    assert [corners(body) for body in again] == [corners(body) for body in alone]
    assert (again[0] is first[0]) == (base.base == "direct")  # bases look at the supports beside them
    assert again[0].digest == first[0].digest
    assert again[1].digest != first[1].digest
    assert len(around.kept.bodies if base.base == "direct" else around.kept.solids) == 3


@pytest.mark.parametrize("cell", ["prism", "x-wall"])
def test_two_processes_make_the_same_bytes_as_one(cell, monkeypatch):
    monkeypatch.setattr(workers, "_WORTH_IT", 0.0)
    alone = built(planned(), cell, BaseRules(), Surroundings())
    with workers.allowed(2):
        together = built(planned(), cell, BaseRules(), Surroundings())
    assert len(alone) == 2
    assert [body.digest for body in together] == [body.digest for body in alone]
    for one, other in zip(alone, together, strict=True):
        np.testing.assert_array_equal(one.mesh.vertices, other.mesh.vertices)
        np.testing.assert_array_equal(one.mesh.triangles, other.mesh.triangles)
