"""Propose orientations of parts, as the command ``amprep orient`` does."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from amprep.api.job import job_and_host
from amprep.errors import JobError, nearest_hint
from amprep.host import Host
from amprep.job import Job
from amprep.job.settings.packing import Effort
from amprep.model import Progress, Stop, silent
from amprep.model.orientation import OrientationRules
from amprep.pipeline.orienting.course import OrientOptions, orient_job
from amprep.pipeline.orienting.proposals import MEASURED
from amprep.pipeline.resolve import resolve
from amprep.pipeline.stages import ProgressWatcher, Watcher
from amprep.report.orientation.record import OrientationRecord


def orient(
    *inputs: str | Path | Job,
    effort: Effort = "normal",
    no_contact: Sequence[str] = (),
    face_up: Sequence[str] = (),
    face_down: Sequence[str] = (),
    tilt_deg: float = 180.0,
    output: str | Path | None = None,
    printer: str | Path | Mapping[str, Any] | None = None,
    settings: Mapping[str, Any] | None = None,
    time_limit_s: float | None = None,
    plugins: Host | Sequence[str] = (),
    stop: Stop | None = None,
    progress: Progress = silent,
    watcher: Watcher | None = None,
) -> OrientationRecord:
    """Propose orientations in which parts cost little: support, box, height, and how firmly they stand.

    Parameters
    ----------
    inputs
        Mesh files, 3MF files and folders, or one job file (.toml).
    effort
        ``fast``, ``normal`` or ``thorough``: measures 5, 10 or 20 orientations of each part exactly; the last one plans
        supports for those that are proposed.
    no_contact
        Faces that neither the plate nor a support may touch, by colour (``#RRGGBB``), by the name of a marked region,
        or by the direction in which flat faces look as drawn (``+x``, ``-z``).
    face_up, face_down
        Faces that must look up or down, to within 45 degrees.
    tilt_deg
        Largest angle by which a part may be tilted from the position in which it was drawn.
    output
        Folder for a page, pictures and a JSON report; None to write nothing.
    printer
        Printer by name, path of a printer profile, or a table like one; default: the job's, else the EOS M290.
    settings
        Settings of the job by dotted keys, for example ``{"material": "316L"}``.
    time_limit_s
        Seconds after which the search ends with its best results so far; None for no limit.
    plugins
        Plugin modules to load beside the installed plugins, by name or path.
    stop
        Ends the work early when it is set.
    progress
        Called with the fraction of a stage that is done, and a message that begins with the name of the stage.
    watcher
        Shows the stages; takes the place of `progress`.

    Returns
    -------
    OrientationRecord
        The proposals for each part.

    Raises
    ------
    AmprepError
        For wrong input or settings, or when a part has no allowed orientation.

    Examples
    --------
    >>> record = amprep.orient("bracket.stl", printer="EOS M290")
    >>> [(proposal.merits, proposal.figures.shadow_mm3) for proposal in record.parts[0].proposals]
    [(('least support', 'lowest'), 310.5), (('smallest box',), 822.0)]
    """
    if effort not in MEASURED:
        raise JobError(
            f"effort must be fast, normal or thorough, got {effort!r}{nearest_hint(effort, MEASURED)}"
        )
    try:
        restricted = OrientationRules(tuple(no_contact), tuple(face_up), tuple(face_down), tilt_deg)
    except ValueError as error:
        raise JobError(str(error)) from error
    options = OrientOptions(
        folder=None if output is None else Path(output),
        effort=effort,
        restricted=restricted,
        time_limit=time_limit_s,
    )
    resolved = resolve(*job_and_host(inputs, {"printer": printer, **(settings or {})}, plugins))
    return orient_job(resolved, options, watcher=watcher or ProgressWatcher(progress), stop=stop or Stop())
