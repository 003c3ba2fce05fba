"""Write the page of a build that was planned again: the report that a run gives, with this build alone."""

from dataclasses import replace

from amprep.model import Build, Packing, PackingProblem, Stop
from amprep.pipeline.outputs import OutputFolder
from amprep.pipeline.packing import PackedBuild, PackedParts
from amprep.pipeline.passes import take_regions
from amprep.pipeline.reading import LoadedParts
from amprep.pipeline.record import build_record, run_record
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.stages import Clock
from amprep.pipeline.supporting import SupportedBuild, removal_of
from amprep.report.replanning import ReplanRecord, part_lines, verified_words

PAGE = "report.html"
"""The page, after the name of the build."""


def write_page(
    record: ReplanRecord,
    build: Build,
    resolved: ResolvedJob,
    outputs: OutputFolder,
    clock: Clock,
    stop: Stop,
) -> None:
    """Write the page, which first says what was done to each part.

    Parameters
    ----------
    record
        What was planned again, verified.
    build
        The build.
    resolved
        The job by which supports were planned.
    outputs
        Folder of the files.
    clock, stop
        Time the stage ``report``; end measurement early.
    """
    from amprep.report.page.html import write_html

    with clock.stage("report"):
        job, name = replace(resolved.job, name=record.build_id), record.build_id
        resolved = replace(resolved, job=job)
        taken = take_regions(resolved, build.parts) if build.settings.supported else None
        supported = SupportedBuild(
            build,
            overhangs=taken.overhangs if taken else (),
            removal=removal_of(job, build),
            rules=frozenset(taken.used) if taken else frozenset(),
        )
        own = replace(
            build_record(supported, job, stop),
            file=record.file,
            sha256=record.sha256,
            verification=record.violations,
        )
        parts = tuple({id(each.part): each.part for each in build.parts}.values())
        notes = (record.source, *part_lines(record), *record.notes, verified_words(record))
        as_it_is = PackedParts(
            PackingProblem((), job.printer.space),
            Packing((), stop_reason="places of the file"),
            (PackedBuild(resolved, 1, name, build.parts),),
            notes,
        )
        run = run_record(LoadedParts(resolved, parts, ()), as_it_is, [own], outputs)
        write_html(replace(run, stages=clock.times), outputs.path(PAGE))
