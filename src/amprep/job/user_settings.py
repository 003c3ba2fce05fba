"""Settings of the user: what every job gets that does not state it."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from amprep.errors import JobError, nearest_hint
from amprep.job.overrides import override
from amprep.job.settings.job import Job
from amprep.profiles import user_folder
from amprep.validation import read_table

KEYS = ("printer", "material", "target")
"""The keys that the file may have; they mean the same as in a job file."""


class WithUserSettings(NamedTuple):
    """A job, the settings of the user that it got, and the file that states them."""

    job: Job
    taken: Mapping[str, str]
    file: Path


def with_user_settings(job: Job, env: Mapping[str, str] = os.environ) -> WithUserSettings:
    """Return a job with the settings of the user for the keys that it does not state.

    The file is ``settings.toml`` in the configuration folder of the user; without it, nothing changes.

    Parameters
    ----------
    job
        The job.
    env
        Environment variables that determine the configuration folder.

    Raises
    ------
    JobError
        If the file is no TOML, has another key, or a value that a job may not have.
    """
    file = user_folder(env, "settings.toml")
    if not file.is_file():
        return WithUserSettings(job, {}, file)
    table = read_table(file, "settings")
    for key, value in table.items():
        if key not in KEYS:
            raise JobError(f"{file}: unknown key {key!r}{nearest_hint(key, KEYS)}")
        if not isinstance(value, str):
            raise JobError(f"{file}: {key}: expected a text, got {value!r}")
    taken = {key: value for key, value in table.items() if key not in job.table}
    try:
        return WithUserSettings(override(job, taken), taken, file)
    except JobError as error:
        raise JobError(f"{file}: {error}") from error
