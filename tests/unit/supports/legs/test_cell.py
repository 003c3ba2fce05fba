"""How wide a lone column of the built-in cells is, and what old keys of the job file say."""

import numpy as np
import pytest

from amprep.errors import JobError
from amprep.host import Host
from amprep.job import job_from_inputs, override
from amprep.pipeline.resolve import resolve
from amprep.supports.legs.cell import CellProperties, measure_cell, square_cell


@pytest.fixture
def job(tmp_path):
    return job_from_inputs([tmp_path])


@pytest.mark.parametrize(("cell", "width"), [("prism", 2.0), ("x-wall", 1.7), ("strut", 0.6), ("bcc", 2.0)])
def test_the_least_width_of_a_column_at_the_planes_of_the_grid(cell, width, job):
    resolved = resolve(override(job, {"cells.strategy": cell}), Host.load(plugins_enabled=False))
    assert measure_cell(resolved.cell.emit, 2.0, 2.0, resolved.job.supports).min() == pytest.approx(
        width, rel=0.03
    )


def test_a_square_is_as_wide_as_its_shadow_in_every_direction():
    extents = square_cell(2.0)
    assert extents.min() == pytest.approx(2.0)
    assert extents.max() == pytest.approx(2.0 * np.sqrt(2.0))


def test_a_cell_fills_its_square_unless_it_states_extents_of_its_own():
    assert np.array_equal(CellProperties().extents_in(2.0), square_cell(2.0))
    measured = square_cell(0.5)
    stated = CellProperties(extents=measured)
    measured[:] = 9.0
    assert np.array_equal(stated.extents_in(2.0), square_cell(0.5))


@pytest.mark.parametrize("key", ["cross_bracing", "slenderness_ratio"])
def test_keys_that_leg_ratio_has_replaced_are_refused_with_its_name(key, job):
    with pytest.raises(JobError, match="is now 'leg_ratio'"):
        override(job, {f"supports.{key}": 1})
