"""Built-in cells: promises, estimates of material, dimensions, and parameters that do not fit."""

import numpy as np
import pytest
from tests.shared.cells import request

from amprep.cells.samples import block, single_column
from amprep.checks.cells.ports import check_ports
from amprep.checks.cells.templates import check_cells
from amprep.errors import JobError
from amprep.host import Host
from amprep.model import (
    Role,
    Stop,
    silent,
)

BUILT_IN = Host.load(plugins_enabled=False)


@pytest.mark.parametrize("name", ["strut", "bcc", "hatch"])
@pytest.mark.parametrize("direction", range(5))
def test_built_in_lattices_keep_the_promises_of_templates_and_match_their_neighbours(name, direction):
    asked = block(2.0, 2.0, direction=direction, layers=4)
    listed = BUILT_IN.choose("cell", name)
    cells = BUILT_IN.call(listed, asked, params=listed.offer.params(), stop=Stop(), progress=silent)
    assert check_cells(asked, cells) == []
    assert check_ports(asked, cells) == []


@pytest.mark.parametrize("name", ["strut", "bcc", "hatch"])
def test_the_estimate_is_what_a_column_takes(name):
    listed = BUILT_IN.choose("cell", name)
    params = BUILT_IN.params(listed, {"tooth_pitch_mm": 0, "fragment_every": 0} if name == "hatch" else {})
    expected = BUILT_IN.material(listed, 2.0, 2.0, params)
    for direction, volume in enumerate(expected):
        asked = single_column(2.0, 2.0, direction)
        cells = BUILT_IN.call(listed, asked, params=params, stop=Stop(), progress=silent)
        volumes = np.array([template.mesh.signed_volume for template in cells.templates])
        assert volumes[cells.template].mean() * 8 == pytest.approx(volume)


def test_hatch_has_walls_windows_teeth_and_gaps():
    def volume(**table):
        listed = BUILT_IN.choose("cell", "hatch")
        params = BUILT_IN.params(
            listed, {"perforation_mm": 0, "tooth_pitch_mm": 0, "fragment_every": 0, **table}
        )
        asked = request([1], role=Role.FOOT)
        cells = BUILT_IN.call(listed, asked, params=params, stop=Stop(), progress=silent)
        return cells.templates[0].mesh.signed_volume * 8

    # two walls of 0.25 mm in each direction, 2 mm high and long, less their four crossings
    plain = 2 * (4 * 2 * 0.25 - 4 * 0.25**2)
    assert volume() == pytest.approx(plain)
    # diamonds of 0.5 x 0.714 mm in the spans: one whole and two halves in each of four walls
    assert plain - volume(perforation_mm=0.5) == pytest.approx(
        4 * 2 * 0.25 * 0.5 * 0.5 * np.tan(np.radians(55)) / 2, rel=1e-4
    )
    # wedges 0.8 mm deep between teeth of 0.5 mm a millimetre: less where the other walls' teeth fill them
    assert plain - volume(tooth_pitch_mm=1.0) == pytest.approx(8 * 0.25 * 0.5 * 0.5 * 0.8 / 1, rel=0.15)
    # the request's edge is at x = 0, y = 1: two walls lose 0.2 mm, where no other wall is
    assert plain - volume(fragment_every=6) == pytest.approx(2 * 0.2 * 0.25 * 2)


@pytest.mark.parametrize(
    ("name", "table", "reason"),
    [
        ("strut", {"diameter_mm": 1.5}, "strut: struts of 1.5 mm need a pitch of at least 3 mm"),
        ("bcc", {"diameter_mm": 0}, "diameter_mm must be above 0"),
        ("strut", {"tie_every": -1}, "tie_every must be at least 0"),
        ("hatch", {"wall_mm": 1.2, "hatch_mm": 1}, "hatch: walls of 1.2 mm every 1 mm leave no room"),
        ("hatch", {"fragment_gap_mm": 0.9}, "fragment_gap_mm = 0.9 does not fit"),
        ("hatch", {"tooth_pitch_mm": 0.3}, "tooth_width_mm must be at most tooth_pitch_mm"),
        ("hatch", {"perforation_mm": -1}, "perforation_mm must be at least 0"),
    ],
)
def test_what_does_not_fit_the_grid_is_said_in_numbers(name, table, reason):
    listed = BUILT_IN.choose("cell", name)
    with pytest.raises(JobError, match=reason):
        BUILT_IN.call(
            listed, request([1, 2]), params=BUILT_IN.params(listed, table), stop=Stop(), progress=silent
        )
