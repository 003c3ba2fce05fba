"""Reading and writing 3MF; the only package that knows lib3mf, and it loads it only when a function runs."""

from pathlib import Path

from amprep.model.build import Build
from amprep.model.part import Part


def read_parts(path: Path) -> list[Part]:
    """Read the parts of a 3MF job; see `amprep.threemf.reading.read_parts`."""
    from amprep.threemf import reading

    return reading.read_parts(path)


def write_build(build: Build, path: Path) -> None:
    """Write a build job; see `amprep.threemf.writing.write_build`."""
    from amprep.threemf import writing

    writing.write_build(build, path)


def read_build(path: Path) -> Build:
    """Read a build job back from its file alone; see `amprep.threemf.build_reading.read_build`."""
    from amprep.threemf import build_reading

    return build_reading.read_build(path)


__all__ = ["read_build", "read_parts", "write_build"]
