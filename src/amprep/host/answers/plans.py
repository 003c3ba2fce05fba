"""The form of a support router's answer."""

from collections.abc import Iterator
from typing import Any, get_args

from amprep.host.answers.values import is_index, is_number, shown
from amprep.model.supports import SupportEdges, SupportPlan, SupportProblem, Unconnected
from amprep.model.supports.problem import ROUTER_REASONS, Status


def fault_of_plan(problem: SupportProblem, plan: SupportPlan) -> str:
    """Return what is wrong with the form of a support plan; empty if nothing is."""
    return next(_faults(problem, plan), "")


def _faults(problem: SupportProblem, plan: Any) -> Iterator[str]:
    if not isinstance(plan.edges, SupportEdges):
        yield f"edges of type {type(plan.edges).__name__}, expected SupportEdges"
    elif any(column.ndim != 1 for column in plan.edges.columns):
        yield "edges whose arrays are not flat"
    yield from _faults_of_listing(problem, plan)
    yield from _faults_of_claims(plan)


def _faults_of_listing(problem: SupportProblem, plan: Any) -> Iterator[str]:
    if not isinstance(plan.unconnected, tuple):
        yield "unconnected red squares that are not a tuple"
        return
    for each in plan.unconnected:
        if not isinstance(each, Unconnected) or not is_index(each.red, len(problem.red)):
            yield f"{shown(each)} as unconnected, expected the number of a red square under {len(problem.red)}"
        elif each.reason not in ROUTER_REASONS:
            yield f"the reason {shown(each.reason)}, expected one of {', '.join(ROUTER_REASONS)}"


def _faults_of_claims(plan: Any) -> Iterator[str]:
    if not is_index(plan.raised, 2**31):
        yield f"capacities raised by {shown(plan.raised)}, expected a whole number from 0"
    if plan.status not in get_args(Status):
        yield f"the status {shown(plan.status)}, expected one of {', '.join(get_args(Status))}"
    for name in ("objective", "bound"):
        value = getattr(plan, name)
        if value is not None and not is_number(value):
            yield f"the {name} {shown(value)}, expected a finite number or None"
    if not isinstance(plan.stop_reason, str):
        yield f"a stop_reason of {shown(plan.stop_reason)}, expected a text"
    if not isinstance(plan.notes, tuple) or not all(isinstance(note, str) for note in plan.notes):
        yield "notes that are not a tuple of texts"
