"""Read and write 3MF files. This is the only package that uses lib3mf, which it loads when a function needs it."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from amprep.arrays import Floats, Ints
from amprep.model.build import Build, Lattice, Target
from amprep.model.mesh import Mesh
from amprep.model.part import Part


def read_parts(path: Path) -> list[Part]:
    """Read the parts of a 3MF job; see `amprep.threemf.read.read_parts`."""
    from amprep.threemf.read import read_parts as run

    return run(path)


def read_beams(path: Path) -> tuple[Floats, Ints, Floats] | None:
    """Read the beam lattice of a 3MF file; see `amprep.threemf.read.beams.read_beams`."""
    from amprep.threemf.read.beams import read_beams as run

    return run(path)


def modifier_note(name: str) -> str:
    """Return the note about a modifier; see `amprep.threemf.read.objects.modifier_note`."""
    from amprep.threemf.read.objects import modifier_note as run

    return run(name)


def write_build(build: Build, path: Path) -> None:
    """Write a build file; see `amprep.threemf.write.write_build`."""
    from amprep.threemf.write import write_build as run

    run(build, path)


def write_parts(
    parts: Sequence[Part],
    path: Path,
    *,
    title: str,
    target: Target = "generic",
    lattices: Mapping[int, tuple[Lattice, Mesh]] | None = None,
) -> None:
    """Write parts as a job; see `amprep.threemf.write.parts.write_parts`."""
    from amprep.threemf.write.parts import write_parts as run

    run(parts, path, title=title, target=target, lattices=lattices)


def read_build(path: Path) -> Build:
    """Read a build from its file; see `amprep.threemf.build.read.read_build`."""
    from amprep.threemf.build.read import read_build as run

    return run(path)


__all__ = [
    "modifier_note",
    "read_beams",
    "read_build",
    "read_parts",
    "write_build",
    "write_parts",
]
