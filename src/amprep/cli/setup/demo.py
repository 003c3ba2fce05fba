"""``amprep demo``: run the demo job that comes with amprep."""

from dataclasses import replace
from importlib.resources import files
from pathlib import Path

from amprep.cli.jobs.reporting import build_and_report
from amprep.cli.options import BuildOptions, with_options

_FOLDER = Path("amprep-demo")


@with_options(BuildOptions)
def demo(*, options: BuildOptions) -> None:
    """Run the demo: sixteen parts with supports in one metal build.

    It writes to the folder amprep-demo, or to the one given by -o.
    """
    chosen = replace(options, output=options.output or _FOLDER)
    build_and_report("run", [str(_job_file())], chosen, {})


def _job_file() -> Path:
    """Return the demo job: an installed package contains a copy, a source tree has it among its fixtures."""
    packed = Path(str(files("amprep"))) / "demo" / "job.toml"
    return packed if packed.is_file() else Path(__file__).parents[4] / "fixtures" / "demo" / "job.toml"
