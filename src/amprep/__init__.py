"""Prepare additive-manufacturing builds: packing, supports, lattice cells, 3MF build jobs.

The public Python API is this package with `amprep.testing`, `amprep.hookspecs`, `amprep.model`, `amprep.cells` and
`amprep.errors`; see ``docs/python.md``. Its names are imported when they are first used, so that ``import amprep`` and
the command line start fast.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from amprep.api import (
        BuildDifferences,
        InfillRecord,
        InspectionRecord,
        Job,
        LoadedParts,
        PackedBuild,
        PackedParts,
        PlannedBuild,
        RegionsRecord,
        ReplanRecord,
        RunRecord,
        SliceRecord,
        SupportedBuild,
        Verification,
        Violation,
        diff,
        emit_cells,
        explain_regions,
        fill_parts,
        inspect,
        load,
        orient,
        pack,
        plan_supports,
        replan,
        run,
        slice_build,
        support,
        verify,
        write,
    )

__version__ = "0.1.0"

__all__ = [
    "BuildDifferences",
    "InfillRecord",
    "InspectionRecord",
    "Job",
    "LoadedParts",
    "PackedBuild",
    "PackedParts",
    "PlannedBuild",
    "RegionsRecord",
    "ReplanRecord",
    "RunRecord",
    "SliceRecord",
    "SupportedBuild",
    "Verification",
    "Violation",
    "__version__",
    "diff",
    "emit_cells",
    "explain_regions",
    "fill_parts",
    "inspect",
    "load",
    "orient",
    "pack",
    "plan_supports",
    "replan",
    "run",
    "slice_build",
    "support",
    "verify",
    "write",
]


def __getattr__(name: str) -> Any:
    """Import a name of the public API when it is first used."""
    if name not in __all__:
        raise AttributeError(f"module 'amprep' has no attribute {name!r}")
    value = getattr(import_module("amprep.api"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return the names of the public API."""
    return sorted(__all__)
