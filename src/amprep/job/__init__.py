"""The job: parts to print, printer and rules, typed and checked once."""

from amprep.job.loading import job_from_inputs, job_of, load_job, make_job
from amprep.job.overrides import apply_sets, override
from amprep.job.parts import apply_part_settings, names_part
from amprep.job.settings.cells import CellSettings
from amprep.job.settings.job import InputSpec, Job, ReadingSettings
from amprep.job.settings.packing import PackingSettings, as_names
from amprep.job.settings.parts import PartSettings
from amprep.job.settings.supports import SupportSettings
from amprep.printers.catalogue import Printer, find_printer, list_printers

__all__ = [
    "CellSettings",
    "InputSpec",
    "Job",
    "PackingSettings",
    "PartSettings",
    "Printer",
    "ReadingSettings",
    "SupportSettings",
    "apply_part_settings",
    "apply_sets",
    "as_names",
    "find_printer",
    "job_from_inputs",
    "job_of",
    "list_printers",
    "load_job",
    "make_job",
    "names_part",
    "override",
]
