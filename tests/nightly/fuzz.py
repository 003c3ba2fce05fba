"""Run mutated inputs through the command line, each in a process of its own with limits.

    python -m tests.nightly.fuzz --kind xml --seed 0 --cases 500

Strategy: this process imports everything once and forks for each case, which takes milliseconds instead of a start of
Python. A case must end with exit code 0, 1 or 2, and with one line if it is 2. It leaves all files or none, and none
outside the output folder. It takes at most 10 s of processor time and 1 GB.
"""

import argparse
import os
import resource
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from tests.nightly.mutations import FIXTURES, KINDS, Case, make_case

MOST_SECONDS = 10.0
MOST_KILOBYTES = 1_000_000
_HARD_SECONDS = 30


class Ended(NamedTuple):
    """How a case ended; `code` is negative after a signal."""

    code: int
    said: str
    seconds: float
    kilobytes: int


def run_case(case: Case, folder: Path) -> Ended:
    """Run a case in a folder, which holds its files, in a forked process."""
    for name, data in case.files.items():
        (folder / name).write_bytes(data)
    said = folder.parent / f"{folder.name}.err"
    child = os.fork()
    if not child:
        _become(case, folder, said)
    signal.signal(signal.SIGALRM, lambda *_: os.kill(child, signal.SIGKILL))
    signal.alarm(20 * _HARD_SECONDS)
    _, status, used = os.wait4(child, 0)
    signal.alarm(0)
    text = said.read_text(encoding="utf-8", errors="replace")
    said.unlink()
    return Ended(os.waitstatus_to_exitcode(status), text, used.ru_utime + used.ru_stime, used.ru_maxrss)


def _become(case: Case, folder: Path, said: Path) -> None:
    """Turn this forked process into a call of the command line."""
    code = 99
    try:
        resource.setrlimit(resource.RLIMIT_CPU, (_HARD_SECONDS, _HARD_SECONDS))
        os.chdir(folder)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        os.dup2(os.open(said, os.O_WRONLY | os.O_CREAT), 2)
        sys.stdout, sys.stderr = (os.fdopen(number, "w", encoding="utf-8") for number in (1, 2))
        sys.argv = ["amprep", *case.arguments]
        from amprep.cli import main

        main()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 98
    finally:
        sys.stderr.flush()
        os._exit(code)


def faults(case: Case, ended: Ended, folder: Path) -> list[str]:
    """Return what a case did that no input may cause."""
    found = []
    if ended.code not in (0, 1, 2):
        found.append(f"exit code {ended.code}")
    if ended.code == 2 and (ended.said.count("\n") != 1 or not ended.said.startswith("amprep: ")):
        found.append("not one line")
    if "Traceback" in ended.said or "internal error" in ended.said:
        found.append("no message for users")
    if ended.seconds > MOST_SECONDS:
        found.append(f"{ended.seconds:.1f} s")
    if ended.kilobytes > MOST_KILOBYTES:
        found.append(f"{ended.kilobytes / 1e6:.2f} GB")
    return found + _faults_of_files(case, ended, folder)


def _faults_of_files(case: Case, ended: Ended, folder: Path) -> list[str]:
    found = []
    for name, data in case.files.items():
        if not (folder / name).is_file() or (folder / name).read_bytes() != data:
            found.append(f"{name} changed")
    others = {path.name for path in folder.iterdir()} - set(case.files) - {"out"}
    if others:
        found.append(f"files outside: {sorted(others)}")
    written = sorted(path.name for path in (folder / "out").iterdir()) if (folder / "out").is_dir() else []
    is_whole = any(name.endswith(".report.json") for name in written) and not any(
        n.startswith(".") for n in written
    )
    if written and (ended.code not in (0, 1) or not is_whole):
        found.append(f"partial output: {written}")
    return found


def warm_up() -> bytes:
    """Import everything and compile the kernels in this process; return a build file."""
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", AMPREP_LOAD_PLUGINS="")
    from amprep import api, supervision

    supervision.ENABLED = False
    with tempfile.TemporaryDirectory() as folder:
        settings = {"supports.pitch_mm": 4, "packing.strategy": "extreme-points"}
        record = api.run(FIXTURES / "table.stl", output=folder, settings=settings)
        api.inspect(FIXTURES / "knife-edge.stl")
        data = (Path(folder) / record.builds[0].file).read_bytes()
        api.verify(Path(folder) / record.builds[0].file)
    return data


def fuzz(kind: str, first: int, cases: int, build_file: bytes) -> list[str]:
    """Run the cases of a kind with the seeds from `first`; return one line for each that went wrong."""
    found = []
    for seed in range(first, first + cases):
        work = Path(tempfile.mkdtemp())
        try:
            (work / "case").mkdir()
            case = make_case(kind, seed, build_file)
            ended = run_case(case, work / "case")
            wrong = faults(case, ended, work / "case")
            wrong += [f"files outside: {path.name}" for path in work.iterdir() if path.name != "case"]
        finally:
            shutil.rmtree(work)
        if wrong:
            found.append(
                f"{kind} {seed}: {'; '.join(wrong)}: {' '.join(case.arguments)}: {ended.said[:300]!r}"
            )
            print(found[-1], flush=True)
    return found


def main() -> None:
    """Fuzz from the command line and print what was found."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--kind", choices=KINDS, action="append")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--cases", type=int, default=100)
    chosen = parser.parse_args()
    build_file = warm_up()
    for kind in chosen.kind or KINDS:
        began = time.monotonic()
        found = fuzz(kind, chosen.seed, chosen.cases, build_file)
        print(
            f"{kind}: {chosen.cases} cases, {len(found)} wrong, {time.monotonic() - began:.0f} s", flush=True
        )


if __name__ == "__main__":
    main()
