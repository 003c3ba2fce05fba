"""``amprep demo``: run the demo job that comes with amprep."""

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Annotated

from amprep.cli.jobs.reporting import build_and_report
from amprep.cli.options import BuildOptions, output_option, with_options


@dataclass(frozen=True, kw_only=True)
class DemoOptions(BuildOptions):
    """Options of the demo: those of `run` with an output folder of its own."""

    output: Annotated[Path, output_option("-o", "--output", metavar="FOLDER", help="Output folder.")] = Path(
        "amprep-demo"
    )


@with_options(DemoOptions)
def demo(*, options: DemoOptions) -> None:
    """Run the demo: sixteen parts with supports in one metal build.

    It writes to the folder amprep-demo, or to the one given by -o, and may
    take minutes the first time, when code is compiled for this machine.

    Exit codes: as 'amprep run'.
    """
    build_and_report("run", [str(_job_file())], options, {})


def _job_file() -> Path:
    """Return the demo job: an installed package contains a copy, a source tree has it among its fixtures."""
    packed = Path(str(files("amprep"))) / "demo" / "job.toml"
    return packed if packed.is_file() else Path(__file__).parents[4] / "fixtures" / "demo" / "job.toml"
