"""Fill marked regions of parts with cells: read, fill, judge, measure, write, report."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from amprep import __version__
from amprep.cells.answers import Emit
from amprep.checks.infill import check_filled
from amprep.errors import JobError
from amprep.geometry.meshes.offset import offset_inwards
from amprep.host import Host
from amprep.infill.block import default_size
from amprep.infill.fill_region import FilledPart, fill_region, meets
from amprep.infill.regions import KIND, chosen, with_files, without
from amprep.job import Job
from amprep.materials.catalogue import densities_of
from amprep.measures.filled_part import pockets_of
from amprep.model import Appearance, CellRequest, Cells, Lattice, Mesh, Part, Progress, Region, Stop
from amprep.pipeline.outputs import OutputFolder, safe_name
from amprep.pipeline.reading import expand_inputs, read_all, warnings_about
from amprep.pipeline.resolve import choose_cell, read_by
from amprep.pipeline.stages import Clock, Watcher
from amprep.report.cutaway import draw_cut
from amprep.report.infill import FilledPartRecord, InfillRecord, write_json
from amprep.stl import write_stl
from amprep.threemf import write_parts


@dataclass(frozen=True)
class LatticeOptions:
    """Options of ``amprep lattice``.

    Attributes
    ----------
    folder, stem
        Output folder, and beginning of the names of the output files.
    regions
        Mesh files of further regions.
    names
        Names of the regions to fill; all regions if empty.
    shell
        Depth (mm) below the surface from which the part is filled, instead of marked regions.
    size, height
        Size and height of a cell, mm; None for the default size, and for a height equal to the size.
    stl
        Whether parts are also written as STL files.
    dry_run
        Whether nothing is written.
    """

    folder: Path
    stem: str
    regions: tuple[Path, ...] = ()
    names: tuple[str, ...] = ()
    shell: float | None = None
    size: float | None = None
    height: float | None = None
    stl: bool = False
    dry_run: bool = False


@dataclass(frozen=True, eq=False)
class _PartFill:
    """A part, the regions that meet it, and the result of filling them."""

    part: Part
    regions: tuple[Region, ...]
    filled: FilledPart | None = None

    @property
    def result(self) -> Part:
        """The part to write; colours of single triangles and painted regions are lost by filling."""
        if self.filled is None:
            return self.part
        part = without(self.part, self.regions)
        return replace(
            part,
            mesh=self.filled.mesh,
            volume_mm3=self.filled.mesh.signed_volume,
            appearance=Appearance(part.appearance.colour, part.appearance.material),
            regions=tuple(region for region in part.regions if region.triangles is None),
        )


def fill_marked_regions(
    job: Job, host: Host, options: LatticeOptions, *, watcher: Watcher, stop: Stop
) -> InfillRecord:
    """Fill the marked regions of the parts of a job with its cell and return a record for the report.

    All files appear together at the end; an interrupted run leaves none.

    Parameters
    ----------
    job
        The job: inputs, cell and target program.
    host
        Offers of plugins.
    options
        Regions, size of cells and outputs.
    watcher
        Receives the progress of the stages.
    stop
        Cancels the cell emitter.

    Raises
    ------
    AmprepError
        For wrong input, an unknown or failing cell, or when there is no region to fill.
    """
    _check(options)
    clock = Clock(watcher)
    cell = choose_cell(host, job)
    with clock.stage("read") as progress:
        parts = _read(job, host, options, progress)
    with clock.stage("regions") as progress:
        work = _regions(parts, options, progress)
    marked = [region.mesh for each in work for region in each.regions if region.mesh]
    size = options.size or default_size(marked)
    height = options.height or size
    done = []
    for each in work:
        with clock.stage("fill") as progress:

            def emit(request: CellRequest, progress: Progress = progress) -> Cells:
                return cell.emit(request, stop=stop, progress=progress)

            done.append(_filled(each, emit, job, size, height, progress))
    records = tuple(_measured(each, each.filled, job, clock) for each in done if each.filled is not None)
    record = InfillRecord(
        job.name,
        __version__,
        cell.name,
        size,
        height,
        job.cells.powder_hole_mm,
        records,
        tuple(each.part.name for each in done if each.filled is None),
        warnings=(*host.warnings, *warnings_about([each.part for each in work]), *_notes(done, job)),
    )
    if options.dry_run:
        return replace(record, stages=clock.times)
    with OutputFolder(options.folder, options.stem, numbered=False) as outputs:
        return _written(record, done, job, options, outputs, clock)


def _check(options: LatticeOptions) -> None:
    for name, value in (("--size", options.size), ("--height", options.height), ("--shell", options.shell)):
        if value is not None and not 0.0 < value < 1e4:
            raise JobError(f"{name} must be above 0 and below 10000 mm, got {value:g}")
    if options.shell is not None and (options.regions or options.names):
        raise JobError("--shell fills the whole inside of parts; use it without --region and --region-name")


def _read(job: Job, host: Host, options: LatticeOptions, progress: Progress) -> list[Part]:
    def read(path: Path) -> list[Part]:
        return read_by(host, path, job)

    files = expand_inputs([(entry.path, entry.quantity) for entry in job.inputs], host.suffixes)
    return with_files(read_all(files, read, progress=progress), options.regions, read)


def _regions(parts: Sequence[Part], options: LatticeOptions, progress: Progress) -> list[_PartFill]:
    """Return every part with the regions that meet it."""
    if options.shell is not None:
        return [_PartFill(part, _inside(part, options.shell, progress)) for part in parts]
    work = []
    for part, regions in zip(parts, chosen(parts, options.names), strict=True):
        met = tuple(each for each in regions if each.mesh and meets(part.mesh, each.mesh))
        work.append(_PartFill(part, met))
    if not any(each.regions for each in work):
        raise JobError("the regions are outside the parts, so they cannot be filled with cells")
    return work


def _inside(part: Part, shell: float, progress: Progress) -> tuple[Region, ...]:
    progress(0.1, f"offsetting the surface of {part.name}")
    points, triangles = offset_inwards(*part.mesh.arrays, shell, shell / 2.0)
    if not len(triangles):
        raise JobError(
            f"{part.name} must be thicker than twice the shell of {shell:g} mm somewhere; choose a thinner --shell"
        )
    return (Region(KIND, f"inside of {part.name}", mesh=Mesh(points, triangles)),)


def _filled(
    each: _PartFill, emit: Emit, job: Job, size: float, height: float, progress: Progress
) -> _PartFill:
    if not each.regions:
        return each
    filled = fill_region(
        each.part.mesh,
        [region.mesh for region in each.regions if region.mesh],
        emit,
        size=size,
        height=height,
        overlap=job.cells.overlap_mm,
        beams=job.beams,
        progress=progress,
    )
    return replace(each, filled=filled)


def _measured(each: _PartFill, filled: FilledPart, job: Job, clock: Clock) -> FilledPartRecord:
    """Judge and measure a filled part."""
    part, settings = each.part, job.cells
    regions = [region.mesh for region in each.regions if region.mesh]
    with clock.stage("judge"):
        found = check_filled(
            part.name, part.mesh, regions, filled.cells, filled.mesh, dropped=filled.dropped_volume_mm3
        )
    with clock.stage("powder"):
        pockets = pockets_of(filled.mesh, settings.powder_hole_mm)
        before = pockets_of(part.mesh, settings.powder_hole_mm) if pockets else ()
    return FilledPartRecord(
        part,
        tuple(region.name for region in each.regions),
        filled,
        settings.density_g_cm3 or densities_of([part.appearance.material], job.material, job.folder)[0],
        pockets,
        sum(pocket.volume for pocket in before),
        tuple(found),
    )


def _notes(done: Sequence[_PartFill], job: Job) -> list[str]:
    """Return notes on repairs, and on data that a part loses when it is filled."""
    notes = []
    for each in done:
        result = each.result
        notes += [f"{each.part.name}: {note}" for note in result.notes]
        if each.filled is None:
            continue
        if each.part.appearance.triangle_colours is not None:
            notes.append(f"{each.part.name}: colours of single triangles are not kept")
        if len(result.regions) < len(without(each.part, each.regions).regions):
            notes.append(f"{each.part.name}: painted supports are not kept")
        if job.target != "prusaslicer" and any(region.kind != KIND for region in result.regions):
            notes.append(f"{each.part.name}: blockers and enforcers are kept in files for PrusaSlicer only")
    return notes


def _written(
    record: InfillRecord,
    done: Sequence[_PartFill],
    job: Job,
    options: LatticeOptions,
    outputs: OutputFolder,
    clock: Clock,
) -> InfillRecord:
    """Write and publish all files, and return the record with their names."""
    parts = [each.result for each in done]
    lattices: dict[int, tuple[Lattice, Mesh]] = {
        index: (each.filled.lattice, each.part.mesh)
        for index, each in enumerate(done)
        if each.filled is not None and each.filled.lattice is not None
    }
    files = [outputs.name("3mf")]
    with clock.stage("write"):
        write_parts(parts, outputs.path("3mf"), title=outputs.stem, target=job.target, lattices=lattices)
        for number, part in enumerate(parts if options.stl else (), start=1):
            suffix = f"{number:03d}.{safe_name(part.name)}.stl"
            write_stl(Mesh(part.mesh.vertices + part.origins[0], part.mesh.triangles), outputs.path(suffix))
            files.append(outputs.name(suffix))
    with clock.stage("picture"):
        draw_cut([each.result.mesh for each in done if each.filled is not None], outputs.path("png"))
    files += [outputs.name("png"), outputs.name("report.json")]
    record = replace(record, files=tuple(files), stages=clock.times)
    write_json(record, outputs.path("report.json"))
    outputs.publish()
    return record
