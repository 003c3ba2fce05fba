"""Offers of declared cells: default parameters, functions of parameters, and refused declarations."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from tests.shared.cells import PIN, emitted, request
from tests.shared.optional import present

from amprep.cells import cell_offer
from amprep.cells.samples import block
from amprep.checks.cells.ports import check_ports
from amprep.checks.cells.templates import check_cells
from amprep.errors import JobError, PluginError
from amprep.model import (
    ImplicitCell,
)


def test_a_graph_without_params_of_its_own_can_be_made_thicker():
    offer = cell_offer("pin", "A pin.", PIN)
    thin, thick = (emitted(offer, request([1]), radius_factor=factor).templates[0] for factor in (1.0, 1.5))
    assert thick.mesh.signed_volume / thin.mesh.signed_volume == pytest.approx(2.25)
    with pytest.raises(JobError, match="radius_factor must be between"):
        emitted(offer, request([1]), radius_factor=99)


@dataclass(frozen=True)
class BallParams:
    radius: float = 0.55


def test_a_function_of_params_declares_a_cell_for_the_grid_at_hand():
    def declare(pitch, step, params):
        return ImplicitCell(
            lambda points: params.radius - np.linalg.norm(np.mod(points, 1.0) - 0.5, axis=1), 12
        )

    offer = cell_offer("ball", "Balls that touch.", declare, params=BallParams)
    asked = block(2.0, 2.0, width=2, layers=2)
    cells = emitted(offer, asked)
    assert (check_cells(asked, cells), check_ports(asked, cells)) == ([], [])
    assert present(offer.declare)(2.0, 2.0, BallParams()).kinds == ("implicit",)


def test_a_declaration_that_is_none_or_empty_is_refused():
    def name_only(pitch, step, params) -> Any:
        return "bcc"

    with pytest.raises(PluginError, match="expected a shape or a DeclaredCell, got str"):
        emitted(cell_offer("x", "Nothing.", name_only), request([1]))
    with pytest.raises(JobError, match="nowhere positive"):
        emitted(
            cell_offer("x", "Empty.", ImplicitCell(lambda points: -np.ones(len(points)), 8)), request([1])
        )
