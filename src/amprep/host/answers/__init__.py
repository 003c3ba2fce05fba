"""Say what is wrong with the form of a plugin's answer, before the host or a judge uses it.

A record may hold anything, since Python checks no types. The functions here know how each answer must be formed;
whether it keeps its promise is the matter of `amprep.checks`.
"""

from typing import Any

from amprep.cells.answers import fault_of_cells
from amprep.host.answers.packings import fault_of_packing
from amprep.host.answers.parts import fault_of_parts
from amprep.host.answers.plans import fault_of_plan
from amprep.host.answers.volumes import fault_of_volume
from amprep.host.loading import one_line
from amprep.host.offers import Kind

__all__ = ["fault_of_answer"]

_FAULT_OF: dict[Kind, Any] = {
    "reader": fault_of_parts,
    "volume": fault_of_volume,
    "packer": fault_of_packing,
    "router": fault_of_plan,
    "cell": fault_of_cells,
}


def fault_of_answer(kind: Kind, subject: object, answer: object) -> str:
    """Return what an offer returned instead of a well-formed answer to `subject`, as the object of "returned".

    Parameters
    ----------
    kind
        Kind of the offer.
    subject
        First argument of its call: a path, part, problem or request.
    answer
        What it returned, of the right type.

    Returns
    -------
    A phrase such as ``a placement of item -1; items are 0 to 3``; empty for a well-formed answer.
    """
    try:
        fault: str = _FAULT_OF[kind](subject, answer)
    except Exception as error:  # noqa: BLE001 the records may hold objects of any class
        return f"an answer that cannot be read ({one_line(error)})"
    return fault
