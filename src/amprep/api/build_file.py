"""Write a build job and verify it."""

from dataclasses import dataclass, field
from pathlib import Path

from amprep.api.arguments import require_record
from amprep.checks.packing.pairs import PairCounts
from amprep.checks.violation import Violation
from amprep.errors import InputError
from amprep.model import Build, Progress, Stop, silent
from amprep.pipeline.supporting import SupportedBuild
from amprep.pipeline.verify import verify_build, verify_file


@dataclass(frozen=True)
class Verification:
    """Result of verifying a build against every promise.

    Attributes
    ----------
    violations
        The broken promises; empty when all hold.
    pairs
        How many pairs of parts were judged by which method: their enclosing boxes, the distance of their triangles, or
        the intersection of their solids.
    extent
        For promises on supports that depend on the rules of the build: limit, tolerance, and what was judged.
    """

    violations: tuple[Violation, ...]
    pairs: PairCounts = field(default_factory=PairCounts)
    extent: dict[str, str] = field(default_factory=dict)

    @property
    def ok(self) -> bool:
        """Whether every promise holds."""
        return not self.violations

    def __str__(self) -> str:
        """One line per broken promise."""
        lines = map(str, self.violations)
        return "\n".join(lines) or "every promise holds"


def write(build: SupportedBuild | Build, path: str | Path) -> Path:
    """Write a build job as a 3MF file and return its path.

    The file appears when it is complete, so an interrupted call leaves no file. Missing folders are created.

    Parameters
    ----------
    build
        A build from `emit_cells`.
    path
        File to write; it ends in ``.3mf``.

    Raises
    ------
    InputError
        When the path does not end in ``.3mf`` or cannot be written.

    Examples
    --------
    >>> amprep.write(supported, "out/bracket.build-1.3mf")
    PosixPath('out/bracket.build-1.3mf')
    """
    from amprep.threemf import write_build

    path = Path(path)
    if path.suffix.lower() != ".3mf":
        raise InputError(f"{path}: a build job must be a .3mf file; choose another name")
    require_record(build, (SupportedBuild, Build), "write", "pass the result of emit_cells")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from error
    write_build(build.build if isinstance(build, SupportedBuild) else build, path)
    return path


def verify(
    build: str | Path | SupportedBuild | Build, *, stop: Stop | None = None, progress: Progress = silent
) -> Verification:
    """Verify a build against every promise: from its file alone, or as it is in memory.

    Parameters
    ----------
    build
        Path of a build job that amprep wrote, or a build from `emit_cells`.
    stop
        Ends the work early.
    progress
        Called with the fraction that is done and a message.

    Raises
    ------
    InputError
        When the file is not a build job that amprep wrote.

    Examples
    --------
    >>> print(amprep.verify("out/bracket.build-1.3mf"))
    every promise holds
    """
    if isinstance(build, str | Path):
        return Verification(*verify_file(Path(build), stop=stop, progress=progress))
    require_record(build, (SupportedBuild, Build), "verify", "pass a path or the result of emit_cells")
    judged = build.build if isinstance(build, SupportedBuild) else build
    return Verification(*verify_build(judged, stop=stop, progress=progress))
