"""Kill a job at random moments, and look for what must never be there.

    python tests/benchmarks/kills.py [--kills 100] [--seed 1] [--signals INT,TERM,KILL] [INPUT... --set KEY=VALUE...]

Each kill starts `amprep run` with a job in an empty folder and sends one signal after a random part of the job's time.
Then it checks that the output folder holds all files of the job or none, that every file is whole, that the exit code
tells which, and that no hidden folder is left after the next run. It is no test of pytest, because it takes an hour.
"""

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import zipfile
from collections import Counter
from pathlib import Path

from PIL import Image

FIXTURES = Path(__file__).parents[2] / "fixtures"


def start(output, inputs):
    """Start the job; `inputs` are inputs and options of `amprep run`."""
    command = [
        sys.executable,
        "-c",
        "from amprep.cli import main; main()",
        "run",
        *inputs,
        "-o",
        output,
        "-q",
    ]
    return subprocess.Popen(
        [*map(str, command)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=dict(os.environ, AMPREP_LOAD_PLUGINS=""),
    )


def whole(path):
    """Tell whether a file is readable to its end."""
    if path.suffix == ".3mf":
        return zipfile.ZipFile(path).testzip() is None
    if path.suffix == ".json":
        return bool(json.loads(path.read_text(encoding="utf-8")))
    if path.suffix == ".png":
        Image.open(path).load()
        return True
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".csv":
        columns = text.partition("\n")[0].count(",")
        return text.endswith("\n") and all(line.count(",") >= columns for line in text.splitlines())
    return text.rstrip().endswith("</html>")


def faults(output, expected, code, number):
    """Return what is wrong after a job ended with an exit code."""
    visible = (
        {path.name for path in output.iterdir() if not path.name.startswith(".")}
        if output.is_dir()
        else set()
    )
    hidden = [path.name for path in output.iterdir() if path.name.startswith(".")] if output.is_dir() else []
    found = [f"{name} is not whole" for name in visible if not whole(output / name)]
    found += [f"only {sorted(visible)}"] if visible and visible != expected else []
    found += [f"left {hidden}"] if hidden and number != signal.SIGKILL else []
    allowed = {0, 1} if visible else {128 + number, -number}
    if number == signal.SIGKILL:  # it may come when all files have appeared
        allowed.add(-number)
    return found + ([f"exit code {code} with {len(visible)} files"] if code not in allowed else [])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--signals", default="INT,TERM,KILL")
    parser.add_argument("inputs", nargs="*", default=[str(FIXTURES / "demo" / "demo.3mf")])
    chosen, options = parser.parse_known_args()
    inputs = [*chosen.inputs, *options]
    rng = random.Random(chosen.seed)
    work = Path(tempfile.mkdtemp())
    wrong = 0
    try:
        began = time.monotonic()
        start(work / "whole", inputs).communicate()
        seconds = time.monotonic() - began
        expected = {path.name for path in (work / "whole").iterdir()}
        print(f"the job takes {seconds:.1f} s and writes {len(expected)} files; seed {chosen.seed}")
        for name in chosen.signals.split(","):
            number = signal.Signals[f"SIG{name}"]
            codes: Counter[int] = Counter()
            for kill in range(chosen.kills):
                output = work / f"{name}-{kill}"
                job = start(output, inputs)
                time.sleep(rng.uniform(0.05, 1.05) * seconds)  # before, Python itself starts
                job.send_signal(number)
                _, said = job.communicate()
                codes[job.returncode] += 1
                found = faults(output, expected, job.returncode, number)
                found += [f"said {said!r}"] if said.count("\n") > 1 or "Traceback" in said else []
                wrong += len(found)
                for fault in found:
                    print(f"{name} {kill}: {fault}")
                if number != signal.SIGKILL:
                    shutil.rmtree(output, ignore_errors=True)
            print(f"SIG{name}: {chosen.kills} kills, exit codes {dict(codes)}", flush=True)
        left = [path for path in work.glob("KILL-*") if list(path.glob(".*"))]
        print(f"{len(left)} hidden folders after SIGKILL; running the job into one of them")
        for output in left[:1]:
            start(output, inputs).communicate()
            wrong += len(list(output.glob(".*")))
            print(f"hidden folders left: {len(list(output.glob('.*')))}")
    finally:
        shutil.rmtree(work)
    print("nothing is wrong" if not wrong else f"{wrong} faults")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
