"""Make the job of a call from its inputs and settings, and load the plugins."""

import os
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from amprep.errors import JobError
from amprep.host import Host
from amprep.job import Job, job_of, make_job, override


def job_and_host(
    inputs: Sequence[str | Path | Job],
    changes: Mapping[str, Any],
    plugins: Host | Sequence[str],
    default: str | None = None,
) -> tuple[Job, Host]:
    """Return the job of the inputs and the offers of plugins; `default` names a job whose parts are in memory."""
    host = (
        plugins if isinstance(plugins, Host) else _host(tuple(plugins), os.environ.get("AMPREP_LOAD_PLUGINS"))
    )
    first = inputs[0] if inputs else None
    if isinstance(first, Job):
        if len(inputs) > 1:
            raise JobError(f"a Job must be the only input, got {len(inputs)}")
        job = first
    elif default is not None and not inputs:
        job = make_job({}, name=default, folder=None, source="Python")
    else:
        job = job_of([str(each) for each in inputs], source="Python")
    return override(job, changes), host


@cache
def _host(modules: tuple[str, ...], _environment: str | None) -> Host:
    """Load the plugins once per process and per value of AMPREP_LOAD_PLUGINS."""
    return Host.load(modules=modules)
