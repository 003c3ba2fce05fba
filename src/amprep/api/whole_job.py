"""Run a whole job, as the commands ``amprep run``, ``amprep support`` and ``amprep lattice`` do."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from amprep.api.job import job_and_host
from amprep.host import Host
from amprep.job import Job
from amprep.model import Progress, Stop, silent
from amprep.pipeline.fill_parts import LatticeOptions, fill_marked_regions
from amprep.pipeline.resolve import resolve
from amprep.pipeline.run import RunOptions, run_job
from amprep.pipeline.stages import ProgressWatcher, Watcher
from amprep.pipeline.support_plate import support_plate
from amprep.report.infill import InfillRecord
from amprep.report.record import RunRecord


def run(
    *inputs: str | Path | Job,
    output: str | Path,
    printer: str | Path | Mapping[str, Any] | None = None,
    settings: Mapping[str, Any] | None = None,
    dry_run: bool = False,
    stl: bool = False,
    allow_surface: bool = False,
    time_limit_s: float | None = None,
    plugins: Host | Sequence[str] = (),
    stop: Stop | None = None,
    progress: Progress = silent,
    watcher: Watcher | None = None,
) -> RunRecord:
    """Run a whole job, as the command ``amprep run`` does: read, pack, support, write, verify and report.

    Parameters
    ----------
    inputs
        One job file (.toml), or mesh files, 3MF files and folders, also as ``NAME:4`` for four copies.
    output
        Folder for the build jobs, reports and pictures.
    printer
        Printer by name, path of a printer profile, or a table like one; default: the job's, else the EOS M290.
    settings
        Settings of the job by the dotted keys of a job file, for example ``{"packing.strategy": "auto"}``.
    dry_run
        Whether everything is planned and verified, but nothing is written.
    stl
        Whether parts and supports are written as STL files as well.
    allow_surface
        Whether meshes that are not solids are accepted as surfaces.
    time_limit_s
        Seconds after which packing and routing end with their best result so far; None for no limit.
    plugins
        Plugin modules to load beside the installed plugins, by name or path.
    stop
        Ends the run early when it is set.
    progress
        Called with the fraction of a stage that is done, and a message that begins with the name of the stage.
    watcher
        Shows the stages of the run; takes the place of `progress`.

    Returns
    -------
    RunRecord
        Record of the run: builds, unplaced copies, warnings, files. ``record.faults`` is 0 when everything is placed,
        supported and verified.

    Raises
    ------
    AmprepError
        For wrong input or settings, a plugin that fails, or when nothing fits the build volume.

    Examples
    --------
    >>> record = amprep.run("job.toml", output="out", settings={"supports.pitch_mm": 2})
    >>> [build.file for build in record.builds]
    ['job.build-1.3mf']
    """
    options = RunOptions(Path(output), dry_run, stl, allow_surface, time_limit_s)
    resolved = resolve(*job_and_host(inputs, {"printer": printer, **(settings or {})}, plugins))
    return run_job(resolved, options, watcher=watcher or ProgressWatcher(progress), stop=stop or Stop())


def support(
    *inputs: str | Path | Job,
    output: str | Path,
    center: bool = False,
    printer: str | Path | Mapping[str, Any] | None = None,
    settings: Mapping[str, Any] | None = None,
    dry_run: bool = False,
    stl: bool = False,
    allow_surface: bool = False,
    time_limit_s: float | None = None,
    plugins: Host | Sequence[str] = (),
    stop: Stop | None = None,
    progress: Progress = silent,
    watcher: Watcher | None = None,
) -> RunRecord:
    """Support parts at the positions in their files, as the command ``amprep support`` does; nothing is packed.

    Parameters
    ----------
    center
        Whether all parts together are first moved to the middle of the plate and onto it.
    inputs, output, printer, settings, dry_run, stl, allow_surface, time_limit_s, plugins, stop, progress, watcher
        As in `run`.

    Raises
    ------
    AmprepError
        For wrong input or settings, a plugin that fails, or a part outside the build volume.

    Examples
    --------
    >>> record = amprep.support("plate.3mf", output="out")
    >>> record.builds[0].file
    'plate.supported.3mf'
    """
    options = RunOptions(Path(output), dry_run, stl, allow_surface, time_limit_s)
    resolved = resolve(*job_and_host(inputs, {"printer": printer, **(settings or {})}, plugins))
    watcher = watcher or ProgressWatcher(progress)
    return support_plate(resolved, options, center=center, watcher=watcher, stop=stop or Stop())


def fill_parts(
    *inputs: str | Path | Job,
    output: str | Path,
    region_files: Sequence[str | Path] = (),
    regions: Sequence[str] = (),
    shell_mm: float | None = None,
    size_mm: float | None = None,
    height_mm: float | None = None,
    settings: Mapping[str, Any] | None = None,
    dry_run: bool = False,
    stl: bool = False,
    plugins: Host | Sequence[str] = (),
    stop: Stop | None = None,
    progress: Progress = silent,
    watcher: Watcher | None = None,
) -> InfillRecord:
    """Fill marked regions of parts with lattice cells, as the command ``amprep lattice`` does.

    Parameters
    ----------
    output
        Folder of the output files, or the 3MF file to write; the other files are then named after it.
    region_files
        Mesh files of further regions, in the coordinates of the input.
    regions
        Names of the regions to fill; all regions if empty.
    shell_mm
        Depth below the surface from which parts are filled, instead of marked regions.
    size_mm, height_mm
        Size and height of a cell; None for the default size, and for a height equal to the size.
    settings
        Settings of the job by dotted keys, for example ``{"cells.strategy": "bcc"}``.
    inputs, dry_run, stl, plugins, stop, progress, watcher
        As in `run`.

    Raises
    ------
    AmprepError
        For wrong input or settings, a cell that fails, or when there is no region to fill.

    Examples
    --------
    >>> record = amprep.fill_parts("wheel.3mf", output="out", settings={"cells.strategy": "bcc"})
    >>> record.files
    ('wheel.lattice.3mf', 'wheel.lattice.png', 'wheel.lattice.report.json')
    """
    job, host = job_and_host(inputs, settings or {}, plugins)
    folder, stem = Path(output), f"{job.name}.lattice"
    if folder.suffix.lower() == ".3mf":
        folder, stem = folder.resolve().parent, folder.stem
    files = tuple(Path(each) for each in region_files)
    options = LatticeOptions(
        folder, stem, files, tuple(regions), shell_mm, size_mm, height_mm, stl=stl, dry_run=dry_run
    )
    return fill_marked_regions(
        job, host, options, watcher=watcher or ProgressWatcher(progress), stop=stop or Stop()
    )
