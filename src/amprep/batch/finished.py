"""The file in a job's output folder that says that the job is finished, so that no batch runs it again."""

import json
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from amprep.batch.records import BatchJob, JobFigures, JobOutcome, State
from amprep.errors import AmprepError
from amprep.files import read_json
from amprep.report.json_values import write_json_file

FILE = "amprep-batch-job.json"
"""Name of the file."""

_LARGEST = 16 << 20
_FORMAT = 1


def note_finished(job: BatchJob, outcome: JobOutcome) -> None:
    """Write the file of a job whose files are complete; a job without a digest gets none.

    Raises
    ------
    AmprepError
        If it cannot be written.
    """
    if not job.digest or outcome.state not in {"done", "incomplete"}:
        return
    values = {
        "format": _FORMAT,
        "digest": job.digest,
        "state": outcome.state,
        "figures": outcome.figures._asdict(),
        "files": {name: (job.folder / name).stat().st_size for name in outcome.files},
        "seconds": round(outcome.seconds, 3),
    }
    write_json_file(values, job.folder / FILE)


def finished_before(job: BatchJob) -> JobOutcome | None:
    """Return how a job ended earlier; None if it did not, if it has changed since, or if a file is missing."""
    path = job.folder / FILE
    if not job.digest or not path.is_file():
        return None
    with suppress(AmprepError, OSError, ValueError, TypeError, KeyError, AttributeError):
        values: dict[str, Any] = read_json(path, "a note of a batch", _LARGEST)
        if values["format"] != _FORMAT or values["digest"] != job.digest:
            return None
        files = {str(name): int(size) for name, size in values["files"].items()}
        if any(Path(name).name != name for name in files):
            return None
        if any((job.folder / name).stat().st_size != size for name, size in files.items()):
            return None
        figures = JobFigures(**{str(key): int(value) for key, value in values["figures"].items()})
        state: State = "done" if values["state"] == "done" else "incomplete"
        found = JobOutcome(job.name, job.source, job.folder, state, "", figures, tuple(files))
        return replace(found, seconds=float(values["seconds"]), earlier=True)
    return None


def json_object(text: str) -> dict[str, Any]:
    """Return a JSON object; empty if the text is none."""
    with suppress(ValueError, RecursionError):
        found = json.loads(text)
        return found if isinstance(found, dict) else {}
    return {}
