"""The public Python API: prepare a build step by step, or run a whole job.

The functions are available as ``amprep.load``, ``amprep.pack`` and so on; import them from there. Lengths are in
millimetres and angles in degrees (names end in ``_mm`` and ``_deg``). Records are not modified: every step returns
new ones.
"""

from amprep.api.build_file import diff, verify, write
from amprep.api.edited_build import replan
from amprep.api.inspection import explain_regions, inspect
from amprep.api.orientation import orient
from amprep.api.slices import slice_build
from amprep.api.steps import emit_cells, load, pack, plan_supports
from amprep.api.whole_job import fill_parts, run, support
from amprep.checks.violation import Violation
from amprep.job import Job
from amprep.measures.differences.records import BuildDifferences
from amprep.pipeline.packing import PackedBuild, PackedParts
from amprep.pipeline.reading import LoadedParts
from amprep.pipeline.supporting import PlannedBuild, SupportedBuild
from amprep.pipeline.verifying.build import Verification
from amprep.report.infill import InfillRecord
from amprep.report.inspection.record import InspectionRecord
from amprep.report.orientation.record import OrientationRecord
from amprep.report.record import RunRecord
from amprep.report.regions import RegionsRecord
from amprep.report.replanning import ReplanRecord
from amprep.report.slices.record import SliceRecord

__all__ = [
    "BuildDifferences",
    "InfillRecord",
    "InspectionRecord",
    "Job",
    "LoadedParts",
    "OrientationRecord",
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
