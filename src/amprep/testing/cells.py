"""Check that a lattice cell can be printed and emptied of powder."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from amprep.pipeline.check_cell import STEPS, CellReport
from amprep.pipeline.check_cell import check_cell as check_chosen
from amprep.pipeline.resolve import ChosenCell
from amprep.testing.offers import load_offer


def check_cell(
    name: str | Path,
    *,
    plugin: str | None = None,
    params: Mapping[str, Any] | None = None,
    pitch: float = 2.0,
    strut_angle_deg: float = 45.0,
    steps: int = STEPS,
) -> CellReport:
    """Check one lattice cell by itself, as the command ``amprep cells check`` does.

    Parameters
    ----------
    name, plugin, params
        Offer to check, as in `load_offer`.
    pitch
        Width of a voxel of the support grid, mm.
    strut_angle_deg
        Angle of oblique edges to the horizontal.
    steps
        Voxels along each side of a cell on which it is measured.

    Returns
    -------
    CellReport
        Limits, measured values and violations.

    Raises
    ------
    PluginError, JobError, InputError
        When the cell cannot be loaded, or cannot be made in this grid.
    """
    offer = load_offer("cell", name, plugin=plugin, params=params)
    cell = ChosenCell(offer.host, offer.listed, offer.params)
    return check_chosen(cell, pitch=pitch, strut_angle_deg=strut_angle_deg, steps=steps)
