"""Read and write 3MF files. This is the only package that uses lib3mf, which it loads when a function needs it."""

from amprep.threemf.build.edited import EditedFile, read_edited_file
from amprep.threemf.build.read import BuildFile, read_build, read_build_file
from amprep.threemf.read import read_parts
from amprep.threemf.read.beams import read_beams
from amprep.threemf.read.objects import modifier_note
from amprep.threemf.write import write_build
from amprep.threemf.write.parts import write_parts

__all__ = [
    "BuildFile",
    "EditedFile",
    "modifier_note",
    "read_beams",
    "read_build",
    "read_build_file",
    "read_edited_file",
    "read_parts",
    "write_build",
    "write_parts",
]
