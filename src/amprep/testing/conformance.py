"""Run the offers of a plugin on sample problems and check their promises, as `amprep plugins check` does."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from amprep.checks.violation import Violation
from amprep.errors import AmprepError
from amprep.host import KINDS, Host, Kind
from amprep.model import Stop
from amprep.testing.case import Case
from amprep.testing.offers import LoadedOffer


@dataclass(frozen=True)
class OfferReport:
    """Result of the sample problems for one offer.

    Attributes
    ----------
    kind, name
        Kind and name of the offer.
    title
        Name of the offer with the plugin that provides it.
    problems
        Titles of the sample problems that the offer accepts.
    violations
        Promises that it breaks; the subject names the problem.
    notes
        Sentences about promises that could not be checked.
    """

    kind: Kind
    name: str
    title: str
    problems: tuple[str, ...]
    violations: tuple[Violation, ...]
    notes: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether every promise holds."""
        return not self.violations


def try_plugin(package: str, *, samples: Sequence[Path] = ()) -> tuple[OfferReport, ...]:
    """Load a plugin and run each of its offers on the sample problems.

    Parameters
    ----------
    package
        Entry point, distribution, module, or path of a module.
    samples
        Files for mesh readers to read.

    Raises
    ------
    PluginError
        When the plugin cannot be loaded, or one of its offers has the name of another offer.

    Examples
    --------
    >>> from amprep.testing import try_plugin
    >>> [report.violations for report in try_plugin("amprep_shelves")]
    [()]
    """
    host = Host.load_one(package)
    listed = [each for kind in KINDS for each in host.offers(kind).values() if not each.builtin]
    return tuple(try_offer(LoadedOffer.of(host, each, {}), samples=samples) for each in listed)


def try_offer(offer: LoadedOffer, *, samples: Sequence[Path] = ()) -> OfferReport:
    """Run one offer on every sample problem that it accepts; an exception of the offer is a violation.

    Parameters
    ----------
    offer
        Offer from `load_offer`.
    samples
        Files for a mesh reader to read.
    """
    from amprep.testing.cases import REFUSED, cases_for

    with TemporaryDirectory() as folder:
        cases = cases_for(offer, samples, Path(folder))
        violations = [violation for case in cases for violation in _judged(case)]
    problems = tuple(case.problem for case in cases)
    unread = offer.listed.kind == "reader" and all(problem.startswith(REFUSED) for problem in problems)
    notes = ("no valid file was read; name one with --sample FILE",) if unread else ()
    return OfferReport(offer.listed.kind, offer.name, offer.listed.title, problems, tuple(violations), notes)


def _judged(case: Case) -> list[Violation]:
    """Run a case twice, which must give equal answers, and once with no time left."""
    try:
        first = case.run(Stop())
        found = [_about(case.problem, violation) for violation in case.judge(first)]
        if fingerprint(first) != fingerprint(case.run(Stop())):
            found.append(
                Violation("reproducible", case.problem, "the same problem and seed gave different answers")
            )
        late = case.judge(case.run(Stop.after(0.0))) if case.timed else ()
    except AmprepError as error:
        return [Violation("runs", case.problem, str(error))]
    return [*found, *(_about(f"{case.problem}, out of time", violation) for violation in late)]


def _about(problem: str, violation: Violation) -> Violation:
    return Violation(violation.promise, f"{problem}: {violation.subject}", violation.message)


def fingerprint(value: Any) -> Any:
    """Convert an answer to nested tuples, which are equal exactly when the answers are equal.

    Fields that are not compared, such as durations, do not count.
    """
    if isinstance(value, np.ndarray):
        return value.shape, value.tobytes()
    if is_dataclass(value):
        compared = (field.name for field in fields(value) if field.compare)
        return type(value).__name__, tuple(fingerprint(getattr(value, name)) for name in compared)
    if isinstance(value, list | tuple):
        return tuple(map(fingerprint, value))
    return repr(value)
