"""Verify a build file against more than itself: a job, a printer, the report of its run, and its seal."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from amprep.checks.ordered import order
from amprep.checks.ordered.weaker import most_lenient, weaker_settings
from amprep.checks.violation import Violation
from amprep.errors import InputError
from amprep.files import read_json
from amprep.host import Host
from amprep.job import Job
from amprep.model import Build, Progress, Stop, silent
from amprep.pipeline.stages import ProgressWatcher
from amprep.pipeline.verifying.build import Verification, verify_build
from amprep.pipeline.verifying.order import order_of_job, order_of_printer, usual_settings
from amprep.sealing.seal import check_seal, file_digest

SEALED, REPORTED = "sealed", "as reported"
"""Names of the promises."""

_LARGEST_REPORT = 256 * 1024 * 1024
"""Largest report, bytes."""


@dataclass(frozen=True, eq=False)
class Demands:
    """What a build file is verified against, apart from itself.

    Attributes
    ----------
    job
        The job that ordered the build, with the host that reads its parts; None for none.
    printer
        Name or profile of the printer that will print it; None for that of the job or of the file.
    report
        The JSON report of the run; None for none.
    key
        The key of its seal; None checks a seal, if there is one, without a key.
    removability
        Whether powder and access to contacts are judged.
    """

    job: tuple[Job, Host] | None = None
    printer: str | None = None
    report: Path | None = None
    key: Path | None = None
    removability: bool = False


NO_DEMANDS = Demands()
"""The file alone."""


def verify_file(
    path: Path, demands: Demands = NO_DEMANDS, *, stop: Stop | None = None, progress: Progress = silent
) -> Verification:
    """Judge a build from its file, by the settings of an order where there is one.

    Parameters
    ----------
    path
        The build file.
    demands
        What it is verified against.
    stop, progress
        See `verify_build`.

    Raises
    ------
    InputError
        If the file is not a build that amprep wrote, or the report, the seal or the key cannot be read.
    JobError
        If the job or the printer is wrong.
    """
    from amprep.threemf import read_build_file

    found, extent = _seal(path, demands.key)
    if demands.report is not None:
        found += _reported(path, demands.report)
        extent[REPORTED] = f"SHA-256 of the file, by {demands.report.name}"
    file = read_build_file(path)
    build = file.build
    weaker = [each.words("usual") for each in weaker_settings(most_lenient(build), usual_settings(build))]
    for each in _orders(build, demands, progress):
        found += order.check_order(build, each)
        extent[order.PROMISE] = f"by {each.source}"
        build = order.as_ordered(build, each)
    judged = verify_build(
        build, printed=file.printed, removability=demands.removability, stop=stop, progress=progress
    )
    return replace(
        judged, violations=(*found, *judged.violations), extent=judged.extent | extent, weaker=tuple(weaker)
    )


def _orders(build: Build, demands: Demands, progress: Progress) -> list[order.Order]:
    """Return the orders of a build: that of the job, then that of the printer."""
    orders = []
    if demands.job is not None:
        job, host = demands.job
        orders.append(order_of_job(build, job, host, ProgressWatcher(progress)))
        build = order.as_ordered(build, orders[0])
    if demands.printer is not None:
        orders.append(order_of_printer(build, demands.printer))
    return orders


def _seal(path: Path, key: Path | None) -> tuple[list[Violation], dict[str, str]]:
    checked = check_seal(path, key)
    if not (checked.words or checked.fault):
        return [], {}
    found = [Violation(SEALED, path.name, checked.fault)] if checked.fault else []
    return found, {SEALED: checked.words}


def _reported(path: Path, report: Path) -> list[Violation]:
    """Return a violation unless a report states the SHA-256 of a build file of that name."""
    stated = {each.get("file"): each.get("sha256") for each in _builds(report)}
    if path.name not in stated:
        return [Violation(REPORTED, path.name, f"{report.name} has no build file of this name")]
    if stated[path.name] != file_digest(path):
        return [Violation(REPORTED, path.name, f"its SHA-256 is not the one in {report.name}")]
    return []


def _builds(report: Path) -> list[dict[str, Any]]:
    """Return the entries of builds in a JSON report.

    Raises
    ------
    InputError
        If it cannot be read or is not a report of amprep.
    """
    record = read_json(report, "NAME.report.json of amprep", _LARGEST_REPORT)
    builds = record.get("builds") if isinstance(record, dict) else None
    if not isinstance(builds, list) or not all(isinstance(each, dict) for each in builds):
        raise InputError(f"{report}: not a report of amprep: it lists no builds")
    return builds
