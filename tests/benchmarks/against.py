"""Run the same benchmarks on the working tree and on another revision, in turns, and print the ratios.

    python tests/benchmarks/against.py REVISION [--rounds N] [--only NAME] [--limit RATIO]

Names of modules differ between revisions, so both sides are driven through the command line. `BENCHMARKS` lists the
spellings of each command and of each figure. The exit code is 1 if a time or a result is worse by more than the limit.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[2]
MAX_EXTRA_ROUNDS = 6
"""Further rounds for a benchmark whose ratio exceeds the limit, because other work on the machine is noise."""

NOISE = 0.02
"""Smaller differences are not counted: seconds of a short benchmark vary by that much."""

Figures = dict[str, float]
Record = dict[str, Any]


@dataclass(frozen=True)
class Benchmark:
    """A command and the figures that are compared.

    Attributes
    ----------
    commands
        Spellings of the same command; the first one that a revision accepts is used.
    read
        Returns the figures of the JSON output, less is better. None: only the processor time of the command counts.
    """

    name: str
    commands: tuple[str, ...]
    read: Callable[[Record], Figures] | None = None


@dataclass
class Side:
    """A source tree, the commands that it accepts, and the least figures measured so far."""

    source: Path
    accepted: dict[str, str] = field(default_factory=dict)
    best: Figures = field(default_factory=dict)

    def measure(self, benchmark: Benchmark, folder: Path) -> None:
        """Run a benchmark once and keep the least figures."""
        for name, value in self.run(benchmark, folder).items():
            self.best[name] = min(value, self.best.get(name, value))

    def run(self, benchmark: Benchmark, folder: Path) -> Figures:
        """Run a benchmark once; return its figures by name."""
        known = self.accepted.get(benchmark.name)
        for command in [known] if known else benchmark.commands:
            before = _children_seconds()
            ended = self.amprep(command, folder)
            seconds = _children_seconds() - before
            if ended.returncode == 0:
                self.accepted[benchmark.name] = command
                found = (
                    {"seconds": seconds}
                    if benchmark.read is None
                    else benchmark.read(json.loads(ended.stdout))
                )
                return {f"{benchmark.name} {name}": value for name, value in found.items()}
        raise SystemExit(
            f"{self.source}: '{benchmark.name}' failed; last output:\n{ended.stdout}{ended.stderr}"
        )

    def amprep(self, command: str, folder: Path) -> subprocess.CompletedProcess[str]:
        """Run amprep from this source tree."""
        environment = os.environ | {"PYTHONPATH": str(self.source / "src")}
        words = [
            sys.executable,
            "-m",
            "amprep",
            *command.format(folder=folder, fixtures=ROOT / "fixtures").split(),
        ]
        return subprocess.run(words, env=environment, cwd=folder, capture_output=True, text=True, check=False)


def _children_seconds() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def _packing_seconds(record: Record) -> Figures:
    return {"seconds": sum(each["seconds"] for each in record["instances"])}


def _packing_builds(record: Record) -> Figures:
    mean = record["mean"]
    return {"mean builds": mean.get("builds", mean.get("bins"))}


def _empty_fraction(record: Record) -> Figures:
    mean = record["mean"]
    return {"empty fraction": 1.0 - mean.get("fill_ratio", mean.get("share"))}


def _routing_seconds(record: Record) -> Figures:
    return {f"{each['router']} seconds": each["seconds"] for each in record["results"]}


def _merging_seconds(record: Record) -> Figures:
    return {"seconds": record["results"][0]["seconds"]}


ROUTERS = "--router push-relabel --router min-cost-flow --router shortest-paths"

BENCHMARKS = (
    Benchmark("start", ("--help",)),
    Benchmark("run", ("run {fixtures}/table.stl --set supports.pitch_mm=3 -o {folder}/out",)),
    Benchmark("support volume", ("bench support-volume --pitch 3 --json",)),
    Benchmark(
        "extreme-points",
        ("bench mpv --class 1 --n 100 --count 10 --packer extreme-points --json",),
        _packing_seconds,
    ),
    Benchmark(
        "tabu", ("bench mpv --class 7 --n 50 --count 2 --time-limit 2 --packer tabu --json",), _packing_builds
    ),
    Benchmark("auto", ("bench mpv --class 5 --n 50 --count 3 --time-limit 2 --json",), _packing_builds),
    Benchmark(
        "block-building",
        ("bench container-loading {folder}/boxes.json --time-limit 3 --packer block-building --json",),
        _empty_fraction,
    ),
    Benchmark(
        "two balls", (f"bench supports --size E --scene two-balls {ROUTERS} --json",), _routing_seconds
    ),
    Benchmark(
        "plate", (f"bench supports --size C --scene plate --capacity 1 {ROUTERS} --json",), _routing_seconds
    ),
    Benchmark(
        "large plate",
        ("bench supports --size D --scene plate --capacity 1 --router push-relabel --json",),
        _routing_seconds,
    ),
    Benchmark("merging", ("bench merging --cells 50000 --sample 1000 --json",), _merging_seconds),
)


def write_instance(folder: Path) -> None:
    """Write the meshes and the container-loading instances that the commands read."""
    sides = np.random.default_rng(3).integers(25, 120, (8, 3)).tolist()
    turns = {f"ROTATION_{order}": 1 for order in ("XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")}
    items = [{"X": x, "Y": y, "Z": z, "COPIES": 17, **turns} for x, y, z in sides]
    instance = {"container": {"X": 587, "Y": 233, "Z": 220}, "items": items}
    (folder / "boxes.json").write_text(json.dumps({"instances": [instance]}), encoding="utf-8")


@contextmanager
def checked_out(revision: str, folder: Path) -> Iterator[Path]:
    """Yield a worktree of a revision."""
    tree = folder / "other"
    git = ["git", "-C", str(ROOT), "worktree"]
    subprocess.run([*git, "add", "--detach", "--force", str(tree), revision], check=True, capture_output=True)
    try:
        yield tree
    finally:
        subprocess.run([*git, "remove", "--force", str(tree)], check=True, capture_output=True)


def compare(benchmark: Benchmark, other: Side, ours: Side, folder: Path, rounds: int, limit: float) -> bool:
    """Measure a benchmark on both sides in turns, print its figures and return whether one is worse."""
    for side in (other, ours):
        side.run(benchmark, folder)  # compiles
    for number in range(rounds + MAX_EXTRA_ROUNDS):
        for side in (other, ours) if number % 2 else (ours, other):
            side.measure(benchmark, folder)
        worse = {name for name, value in ours.best.items() if is_worse(name, value, other.best[name], limit)}
        if number + 1 >= rounds and not worse:
            break
    for name in ours.best:
        ratio = ours.best[name] / max(other.best[name], 1e-9)
        mark = "  worse" if name in worse else ""
        print(f"{name:36} {other.best[name]:10.3f} {ours.best[name]:10.3f} {ratio:8.2f}{mark}", flush=True)
    return bool(worse)


def is_worse(name: str, ours: float, theirs: float, limit: float) -> bool:
    """Return whether our figure is worse by more than the limit, and a time by more than noise."""
    return ours > limit * theirs and (not name.endswith("seconds") or ours > theirs + NOISE)


def main() -> int:
    """Compare the working tree with a revision."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("revision", help="commit, branch or tag to compare with")
    parser.add_argument(
        "--rounds", type=int, default=3, help="runs of each benchmark on each side (default 3)"
    )
    parser.add_argument(
        "--only", action="append", default=[], metavar="NAME", help="run this benchmark; repeatable"
    )
    parser.add_argument("--limit", type=float, default=1.05, help="greatest accepted ratio (default 1.05)")
    options = parser.parse_args()
    chosen = [each for each in BENCHMARKS if not options.only or each.name in options.only]
    if not chosen:
        parser.error(f"--only must be one of {', '.join(each.name for each in BENCHMARKS)}")
    worse = False
    with tempfile.TemporaryDirectory() as name, checked_out(options.revision, Path(name)) as tree:
        folder = Path(name)
        write_instance(folder)
        print(f"{'least of the rounds':36} {options.revision[:10]:>10} {'now':>10} {'ratio':>8}")
        for benchmark in chosen:
            sides = Side(tree), Side(ROOT)
            worse |= compare(benchmark, *sides, folder, options.rounds, options.limit)
    return int(worse)


if __name__ == "__main__":
    sys.exit(main())
