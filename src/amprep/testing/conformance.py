"""Tries a plugin's offers on tiny problems and judges the promises, as `amprep plugins check` shows them."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from amprep.checks.violation import Violation
from amprep.errors import AmprepError
from amprep.hookspecs import Offer
from amprep.host import KINDS, Host, Kind, Listed
from amprep.model import Stop
from amprep.testing.case import Case


@dataclass(frozen=True)
class Trial:
    """How one offer did.

    Attributes
    ----------
    problems
        What it was tried on.
    violations
        The promises it broke; the subject says on which problem.
    """

    kind: Kind
    name: str
    title: str
    problems: tuple[str, ...]
    violations: tuple[Violation, ...]

    @property
    def passed(self) -> bool:
        """Whether every promise holds."""
        return not self.violations


def try_plugin(package: str, *, samples: Sequence[Path] = ()) -> tuple[Trial, ...]:
    """Load a plugin and try each of its offers.

    Parameters
    ----------
    package
        Entry point, distribution, module, or path of a module.
    samples
        Files for mesh readers to read.

    Raises
    ------
    PluginError
        When the plugin cannot be loaded, or one of its names clashes with another's.
    """
    host = Host.load_one(package)
    listed = [each for kind in KINDS for each in host.offers(kind).values() if not each.builtin]
    return tuple(try_offer(host, each, samples=samples) for each in listed)


def try_offer(host: Host, listed: Listed[Offer], *, samples: Sequence[Path] = ()) -> Trial:
    """Try one offer on every problem that it accepts; nothing it does raises."""
    from amprep.testing.cases import cases_for

    with TemporaryDirectory() as folder:
        cases = cases_for(host, listed, samples, Path(folder))
        violations = [violation for case in cases for violation in _judged(case)]
    problems = tuple(case.problem for case in cases)
    return Trial(listed.kind, listed.offer.name, listed.title, problems, tuple(violations))


def _judged(case: Case) -> list[Violation]:
    """Run a case as it is, again (the answers must agree), and with no time left."""
    try:
        first = case.run(Stop())
        found = [_about(case.problem, violation) for violation in case.judge(first)]
        if fingerprint(first) != fingerprint(case.run(Stop())):
            found.append(Violation("reproducible", case.problem, "one problem and seed gave two answers"))
        late = case.judge(case.run(Stop.after(0.0))) if case.timed else ()
    except AmprepError as error:
        return [Violation("runs", case.problem, str(error))]
    return [*found, *(_about(f"{case.problem}, out of time", violation) for violation in late)]


def _about(problem: str, violation: Violation) -> Violation:
    return Violation(violation.promise, f"{problem}: {violation.subject}", violation.message)


def fingerprint(value: Any) -> Any:
    """Return nested tuples that are equal exactly when two answers are."""
    if isinstance(value, np.ndarray):
        return value.shape, value.tobytes()
    if is_dataclass(value):
        return type(value).__name__, tuple(fingerprint(getattr(value, field.name)) for field in fields(value))
    if isinstance(value, list | tuple):
        return tuple(map(fingerprint, value))
    return repr(value)
