"""Ask whether a part is in another unit than it seems, where its size is beyond what a printer can make."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from amprep.job import Job
from amprep.model.part import Part

LEAST_MM = 1e-3
"""Length below which a part is asked about, whatever the layer height."""
FACTOR = 10.0
"""A part this many times longer than the build volume is asked about."""

_STATED = (".3mf", ".step", ".stp", ".glb", ".gltf")
"""Suffixes of formats that state their unit, or have one unit only."""


def with_unit_question(part: Part, job: Job) -> Part:
    """Return the part with a warning that asks for its unit, if its size is not plausible; see `unit_question`."""
    question = unit_question(part, job.supports.layer_mm, float(job.printer.space.size.max()))
    return replace(part, warnings=(*part.warnings, question)) if question else part


def unit_question(part: Part, layer_mm: float, longest_mm: float) -> str:
    """Return a question about the unit of a part, or "" if its size is plausible.

    A part that is smaller than a layer in every direction may be in inches or metres; a part that is ten times longer
    than the build volume may be in micrometres, or was converted twice.

    Parameters
    ----------
    part
        The part.
    layer_mm, longest_mm
        Height of a layer, and the longest side of the build volume.
    """
    length = float(np.ptp(part.mesh.vertices, axis=0).max())
    if length < max(layer_mm, LEAST_MM):
        question = "is its unit the inch or the metre?"
    elif length > FACTOR * longest_mm:
        question = "is its unit the micron, or was it converted twice?"
    else:
        return ""
    stated = Path(part.source).suffix.lower() in _STATED
    return f"it is {length:.3g} mm long; {question} {'export it again' if stated else 'use --unit'}"
