"""The check of answers refuses beams that were not requested, and beams that are not valid."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.cells import PIN, emitted, request

from amprep.cells import cell_offer
from amprep.cells.answers import checked
from amprep.errors import PluginError


def test_beams_are_refused_where_none_are_wanted():
    made = emitted(cell_offer("pin", "A pin.", PIN), request([1]), solid=False)
    assert checked(request([1]), made) is made
    with pytest.raises(PluginError, match=r"beams where request\.beams is False"):
        checked(replace(request([1]), beams=False), made)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"struts": np.array([[0, 9]])}, "strut index"),
        ({"radii": np.array([[0.4, 0.0]])}, "not above 0"),
        ({"radii": np.array([[0.4]])}, "do not match"),
        ({"group": np.array([3])}, "group index"),
        ({"nodes": np.full((2, 3), np.nan)}, "not finite"),
    ],
)
def test_unsound_beams_of_a_plugin_are_refused(change, why):
    made = emitted(cell_offer("pin", "A pin.", PIN), request([1]), solid=False)
    with pytest.raises(PluginError, match=why):
        checked(request([1]), replace(made, beams=replace(made.beams, **change)))
