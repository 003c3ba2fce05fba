"""The form of a packer's answer."""

from collections.abc import Iterator, Mapping
from typing import Any, get_args

import numpy as np

from amprep.host.answers.values import are_numbers, is_index, is_number, shown
from amprep.model.packing import BoundFor, Packing, PackingProblem, PackingStep, Placement, Status, Unplaced


def fault_of_packing(problem: PackingProblem, packing: Packing) -> str:
    """Return what is wrong with the form of a packing; empty if nothing is."""
    return next(_faults(problem, packing), "")


def _faults(problem: PackingProblem, packing: Any) -> Iterator[str]:
    yield from _faults_of_builds(problem, packing)
    yield from _faults_of_claims(packing)
    yield from _faults_of_steps(packing)


def _faults_of_builds(problem: PackingProblem, packing: Any) -> Iterator[str]:
    count = len(problem.items)
    if not isinstance(packing.builds, tuple) or not all(isinstance(b, tuple) for b in packing.builds):
        yield "builds that are not a tuple of tuples"
        return
    for placement in (each for build in packing.builds for each in build):
        if not isinstance(placement, Placement):
            yield f"{shown(placement)} in a build, expected a Placement"
        elif not is_index(placement.item, count):
            yield f"a placement of item {shown(placement.item)}; items are 0 to {count - 1}"
        elif not are_numbers(placement.rotation, 3, 3) or not are_numbers(placement.translation, 3):
            yield f"a placement of item {placement.item} with numbers that are not finite, or not three"
    if not isinstance(packing.unplaced, tuple):
        yield "unplaced items that are not a tuple"
        return
    for unplaced in packing.unplaced:
        if not isinstance(unplaced, Unplaced) or not isinstance(unplaced.reason, str):
            yield f"{shown(unplaced)} among the unplaced items, expected an Unplaced with a reason"
        elif not is_index(unplaced.item, count):
            yield f"an unplaced item {shown(unplaced.item)}; items are 0 to {count - 1}"


def _faults_of_claims(packing: Any) -> Iterator[str]:
    if packing.bound is not None and not is_number(packing.bound):
        yield f"the bound {shown(packing.bound)}, expected a finite number or None"
    if packing.status not in get_args(Status):
        yield f"the status {shown(packing.status)}, expected one of {', '.join(get_args(Status))}"
    if packing.bound_for not in get_args(BoundFor):
        yield f"a bound for {shown(packing.bound_for)}, expected one of {', '.join(get_args(BoundFor))}"
    for name in ("stop_reason", "found_by"):
        if not isinstance(getattr(packing, name), str):
            yield f"a {name} of {shown(getattr(packing, name))}, expected a text"


def _faults_of_steps(packing: Any) -> Iterator[str]:
    if not isinstance(packing.steps, tuple):
        yield "steps that are not a tuple"
        return
    for step in packing.steps:
        numbers = isinstance(step, PackingStep) and (step.reached, step.height, step.seconds)
        if not numbers or not all(map(is_number, numbers)) or not isinstance(step.method, str):
            yield f"the step {shown(step)}, expected a PackingStep with finite numbers"
    if not isinstance(packing.excess, Mapping):
        yield f"an excess of {shown(packing.excess)}, expected a mapping"
    elif not all(isinstance(i, int | np.integer) and is_number(e) for i, e in packing.excess.items()):
        yield "an excess that is not a finite number for each item"
