"""Write the slices of a build."""

from pathlib import Path

from amprep.api.arguments import require_record
from amprep.model import Build, Progress, Stop, silent
from amprep.pipeline.slicing.course import slice_build as write_slices
from amprep.pipeline.supporting import SupportedBuild
from amprep.report.slices.record import SliceRecord


def slice_build(
    build: str | Path | SupportedBuild | Build,
    layer_mm: float,
    form: str = "cli",
    *,
    output: str | Path,
    time_limit_s: float | None = None,
    progress: Progress = silent,
) -> SliceRecord:
    """Write the contours of the parts and supports of a build, layer by layer.

    Layers begin at the plate, and each is cut in its middle. Outer contours are counter-clockwise, holes clockwise;
    overlapping shells of a part are united, and walls without thickness become open lines. All files appear, or none.

    Parameters
    ----------
    build
        Path of a build job that amprep wrote, or a build from `emit_cells`.
    layer_mm
        Thickness of a layer.
    form
        ``cli`` or ``cli-binary`` (Common Layer Interface, one file of the parts and one of the supports), ``svg``
        (pictures of at most 100 layers) or ``3mf-slice`` (one 3MF file with the Slice extension).
    output
        Folder of the files; it is created.
    time_limit_s
        Time after which the work ends and nothing is written; None for no limit.
    progress
        Called with the fraction that is done and a message.

    Raises
    ------
    InputError
        When the file is not a build job that amprep wrote, or the thickness or the form is wrong.
    AmprepError
        When the time ends, or a file cannot be written.

    Examples
    --------
    >>> amprep.slice_build("out/bracket.build-1.3mf", 0.04, "cli", output="slices").layers
    1250
    """
    from amprep.threemf import read_build

    if isinstance(build, str | Path):
        build = read_build(Path(build))
    require_record(build, (SupportedBuild, Build), "slice_build", "pass a path or the result of emit_cells")
    plain = build.build if isinstance(build, SupportedBuild) else build
    return write_slices(plain, layer_mm, form, Path(output), stop=Stop.after(time_limit_s), progress=progress)
