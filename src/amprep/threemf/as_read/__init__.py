"""Read a build file a second time, as its target reads it, without amprep's own metadata.

The structure comes from the XML, the arrays of meshes and beams from lib3mf.
"""

from typing import TYPE_CHECKING

from amprep.checks.printed.found import PrintedFile
from amprep.model.build import Target
from amprep.threemf.as_read.cura import read_as_cura
from amprep.threemf.as_read.generic import read_as_generic
from amprep.threemf.as_read.meshes import ObjectMeshes
from amprep.threemf.as_read.prusaslicer import read_as_prusaslicer
from amprep.threemf.as_read.structure import read_structure

if TYPE_CHECKING:
    from lib3mf import Lib3MF

_READERS = {"generic": read_as_generic, "cura": read_as_cura, "prusaslicer": read_as_prusaslicer}


def read_as_printed(package: bytes, model: "Lib3MF.Model", target: Target) -> PrintedFile:
    """Return what the target would print.

    Parameters
    ----------
    package
        The scanned package.
    model
        The same package, read by lib3mf.
    target
        The program that will open the file.

    Raises
    ------
    ValueError
        If the target could not read the file.
    """
    return _READERS[target](read_structure(package), ObjectMeshes(model))
