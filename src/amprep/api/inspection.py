"""Inspect parts, as the command ``amprep inspect`` does."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from amprep.api.job import job_and_host
from amprep.host import Host
from amprep.job import Job
from amprep.model import Progress, Stop, silent
from amprep.pipeline.inspecting import InspectOptions, inspect_job
from amprep.pipeline.inspecting import regions as region_stage
from amprep.pipeline.resolve import resolve
from amprep.pipeline.stages import ProgressWatcher, Watcher
from amprep.report.inspection.record import InspectionRecord
from amprep.report.regions import RegionsRecord


def inspect(
    *inputs: str | Path | Job,
    volumes: str | Sequence[str] = (),
    output: str | Path | None = None,
    printer: str | Path | Mapping[str, Any] | None = None,
    settings: Mapping[str, Any] | None = None,
    time_limit_s: float | None = None,
    plugins: Host | Sequence[str] = (),
    stop: Stop | None = None,
    progress: Progress = silent,
    watcher: Watcher | None = None,
) -> InspectionRecord:
    """Say what is in files, what is wrong with it, what needs support, where it fits, and compare bounding volumes.

    Parameters
    ----------
    inputs
        Mesh files, 3MF files and folders, or one job file (.toml).
    volumes
        Volume makers to try: ``all``, names, or chains such as ``bounding-mesh,convex-pieces``.
    output
        Folder for a page, a JSON report and pictures; None to write nothing.
    printer
        Printer that the parts must fit; default: the job's, else every printer that is known.
    settings
        Settings of the job by dotted keys, for example ``{"supports.overhang_angle_deg": 40}``.
    time_limit_s
        Seconds after which volume makers end with their best result and no other one begins; None for no limit.
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
    InspectionRecord
        Files and parts; ``record.faults`` is 0 when nothing is wrong.

    Raises
    ------
    AmprepError
        For wrong input or settings.

    Examples
    --------
    >>> record = amprep.inspect("bracket.stl", volumes="all")
    >>> [(volume.makers, round(volume.ratio, 2)) for volume in record.parts[0].volumes]
    [('box', 2.31), ('mesh', 1.0)]
    """
    options = InspectOptions(
        volumes=(volumes,) if isinstance(volumes, str) else tuple(volumes),
        folder=None if output is None else Path(output),
        time_limit=time_limit_s,
    )
    resolved = resolve(*job_and_host(inputs, {"printer": printer, **(settings or {})}, plugins))
    return inspect_job(resolved, options, watcher=watcher or ProgressWatcher(progress), stop=stop or Stop())


def explain_regions(
    *inputs: str | Path | Job,
    part: str = "*",
    center: bool = False,
    printer: str | Path | Mapping[str, Any] | None = None,
    settings: Mapping[str, Any] | None = None,
    allow_surface: bool = False,
    plugins: Host | Sequence[str] = (),
    progress: Progress = silent,
    watcher: Watcher | None = None,
) -> RegionsRecord:
    """List the overhang regions of parts with their verdicts and the rule that takes each; no supports are planned.

    Parameters
    ----------
    inputs
        Mesh files, 3MF files and folders, or one job file (.toml).
    part
        Name of the part or of its file; ``*`` and ``?`` stand for any letters and any one letter.
    center
        Whether all parts together are first moved to the middle of the plate and onto it.
    printer
        Printer by name, path of a printer profile, or a table like one; default: the job's, else the EOS M290.
    settings
        Settings of the job by dotted keys, for example ``{"rule": [{"kind": "bore", "support": False}]}``.
    allow_surface
        Whether meshes that are not solids are accepted as surfaces.
    plugins
        Plugin modules to load beside the installed plugins, by name or path.
    progress
        Called with the fraction of a stage that is done, and a message that begins with the name of the stage.
    watcher
        Shows the stages; takes the place of `progress`.

    Raises
    ------
    AmprepError
        For wrong input or settings, or when no part has that name.

    Examples
    --------
    >>> record = amprep.explain_regions("job.toml", part="bracket")
    >>> [(region.verdict, region.rule) for region in record.regions]
    [('self-supporting: bore 3.9 mm', 'self-supporting'), ('ledge 6.0 mm over 1.0: needs support', '[[rule]] 2')]
    """
    resolved = resolve(*job_and_host(inputs, {"printer": printer, **(settings or {})}, plugins))
    shown = watcher or ProgressWatcher(progress)
    return region_stage.explain_regions(
        resolved, part, center=center, allow_surface=allow_surface, watcher=shown
    )
