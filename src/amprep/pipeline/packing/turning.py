"""Offer packers those orientations in which no long edge of a part meets the recoater blade at once."""

from dataclasses import replace

from amprep.hookspecs import PackerAccepts
from amprep.job import Job
from amprep.measures.printer_fit import which_fit
from amprep.measures.printing.blade_edges import BladeRules
from amprep.measures.printing.blade_turns import turns_off_blade
from amprep.model import Part
from amprep.model.counting import counted
from amprep.pipeline.reading import LoadedParts


def blade_rules(job: Job) -> BladeRules | None:
    """Return which edges the recoater blade must not meet; None if the printer has no blade or the job allows all."""
    packing, recoater = job.packing, job.printer.recoater_deg
    if recoater is None or packing.blade_angle_deg == 0.0:
        return None
    return BladeRules(recoater, packing.blade_angle_deg, packing.blade_edge_mm)


def turned_off_blade(loaded: LoadedParts, accepts: PackerAccepts) -> tuple[LoadedParts, tuple[str, ...]]:
    """Return the parts with the orientations to pack them in, and a note if some are other than the job's.

    Parts with fixed positions stay as they are, and so do those that would not fit the printer then.

    Parameters
    ----------
    loaded
        Parts with their job.
    accepts
        Problems that the packer can handle.
    """
    rules = blade_rules(loaded.resolved.job)
    if rules is None:
        return loaded, ()
    parts = tuple(_turned(part, rules, accepts, loaded.resolved.job) for part in loaded.parts)
    turned = sum(new is not old for new, old in zip(parts, loaded.parts, strict=True))
    note = (
        f"{counted(turned, 'part')} may be turned about z and got only turns in which no straight edge longer than "
        f"{rules.edge_mm:g} mm is within {rules.angle_deg:g} degrees of the recoater blade (packing.blade_angle_deg)"
    )
    return replace(loaded, parts=parts), (note,) if turned else ()


def _turned(part: Part, rules: BladeRules, accepts: PackerAccepts, job: Job) -> Part:
    """Return the part with the turns that keep its edges off the blade, of those that fit the printer."""
    if part.fixed is not None:
        return part
    turns = turns_off_blade(part, rules, accepts.orientations)
    if turns is part.orientations:
        return part
    packing = job.packing
    fits = which_fit(
        part.mesh.vertices, turns.matrices, job.printer.space, packing.clearance_mm, packing.lift_mm
    )
    return replace(part, orientations=replace(turns, matrices=turns.matrices[fits])) if fits.any() else part
