"""Options that several commands share, each declared once, and a decorator that adds them to a command."""

import inspect
import os
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import partial, wraps
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

import typer

from amprep.cli import completion

_JOB, _OUTPUT, _PLUGINS = "Settings of the job", "Output", "Plugins"

Plugins = Annotated[
    list[str] | None,
    typer.Option(
        "-p",
        "--plugin",
        metavar="MODULE",
        help="Load a plugin module too; no:NAME blocks a plugin.",
        rich_help_panel=_PLUGINS,
    ),
]
NoPlugins = Annotated[
    bool, typer.Option("--no-plugins", help="Use the built-in plugins only.", rich_help_panel=_PLUGINS)
]
AsJson = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]


Workers = Annotated[
    int | None,
    typer.Option(
        "--workers",
        min=1,
        metavar="COUNT",
        help="Largest number of processes; default: one for each core. The results are the same with any number.",
        rich_help_panel=_OUTPUT,
    ),
]


def supervise_plugins(
    modules: list[str] | None,
    *,
    without_plugins: bool = False,
    output: Path | None = None,
    time_limit: float | None = None,
) -> None:
    """Watch over this process from a second one if plugins may be loaded that are not built in.

    Call it before any other module is imported: a process with threads must not fork.

    Parameters
    ----------
    modules, without_plugins
        Values of ``-p`` and ``--no-plugins``.
    output
        Output folder.
    time_limit
        Value of ``--time-limit``.
    """
    asked = any(not name.startswith("no:") for name in modules or [])
    if asked or not (without_plugins or os.environ.get("AMPREP_LOAD_PLUGINS") == ""):
        from importlib.metadata import entry_points

        from amprep.supervision import supervise

        if asked or entry_points(group="amprep"):
            supervise(output, time_limit)


job_option = partial(typer.Option, rich_help_panel=_JOB)
output_option = partial(typer.Option, rich_help_panel=_OUTPUT)

Printer = Annotated[
    str | None,
    job_option(
        "--printer",
        metavar="NAME",
        help="Printer by name or profile file; see 'amprep printers list'.",
        autocompletion=completion.printers,
    ),
]
Material = Annotated[
    str | None,
    job_option(
        "--material",
        metavar="NAME",
        help="Material by name or profile file; see 'amprep materials list'.",
        autocompletion=completion.materials,
    ),
]
Packer = Annotated[
    str | None,
    job_option(
        "--packer",
        metavar="NAME",
        help="Packer by name; see 'amprep plugins list'.",
        autocompletion=completion.packers,
    ),
]
Cell = Annotated[
    str | None,
    job_option(
        "--cell",
        metavar="NAME",
        help="Lattice cell by name, or a file that declares one; see 'amprep cells list'.",
        autocompletion=completion.cells,
    ),
]
Target = Annotated[
    str | None,
    job_option(
        "--for",
        metavar="TARGET",
        help="Program that will open the build jobs: generic, prusaslicer or cura.",
    ),
]
Sets = Annotated[
    list[str] | None,
    job_option(
        "--set",
        metavar="KEY=VALUE",
        help="Set a key of the job file, for example supports.pitch_mm=0.8; repeatable.",
    ),
]
OpenReport = Annotated[
    bool, output_option("--open", help="Open the report in the browser when the files are written.")
]
Force = Annotated[bool, typer.Option("--force", help="Replace files that exist.")]
DryRun = Annotated[bool, output_option("--dry-run", help="Plan and verify everything, but write nothing.")]
ResultAsJson = Annotated[bool, output_option("--json", help="Print the result as JSON.")]
ReportAsJson = Annotated[bool, output_option("--json", help="Print the report as JSON on standard output.")]
Quiet = Annotated[bool, output_option("--quiet", "-q", help="Print errors only: no progress and no table.")]
ProgressForm = Annotated[
    Literal["bars", "lines"],
    output_option(
        "--progress",
        metavar="FORM",
        help="Show progress as bars, or as lines: JSON for programs, on standard error.",
    ),
]
LogFile = Annotated[
    Path | None, output_option("--log", metavar="FILE", help="Write what is done, and when, to a file.")
]
Debug = Annotated[bool, output_option("--debug", help="Show the traceback of an error.")]


@dataclass(frozen=True, kw_only=True)
class ReadingOptions:
    """Options of every command that reads meshes: `run`, `support`, `lattice` and `inspect`."""

    strict: Annotated[
        bool, job_option("--strict", help="Refuse 3MF files that break any rule of the specification.")
    ] = False
    unit: Annotated[
        str | None,
        job_option(
            "--unit",
            metavar="UNIT",
            help="Unit of STL, OBJ, PLY and OFF files: millimetre (default), micron, centimetre, inch, foot or metre.",
        ),
    ] = None

    @property
    def reading(self) -> dict[str, Any]:
        """The settings of reading that options change, by dotted keys; None where an option is not given."""
        return {"reading.strict": self.strict or None, "reading.unit": self.unit}


@dataclass(frozen=True, kw_only=True)
class JobOptions(ReadingOptions):
    """Options of every command that takes a job: `run`, `support` and `lattice`."""

    cell: Cell = None
    lattice: Annotated[
        str | None,
        job_option(
            "--lattice",
            metavar="FORM",
            help="Write struts of cells as beams (generic files only) or as mesh; default: as the cell says.",
        ),
    ] = None
    target: Target = None
    sets: Sets = None
    name: Annotated[
        str | None,
        output_option(
            "--name",
            metavar="NAME",
            help="Name of the job and its files; default: the job file, the only input, or the folder of all inputs.",
        ),
    ] = None
    output: Annotated[
        Path | None,
        output_option(
            "-o", "--output", metavar="FOLDER", help="Output folder; default: the folder of the first input."
        ),
    ] = None
    stl: Annotated[bool, output_option("--stl", help="Write STL files as well.")] = False
    dry_run: DryRun = False
    as_json: ReportAsJson = False
    quiet: Quiet = False
    progress: ProgressForm = "bars"
    plugins: Plugins = None
    no_plugins: NoPlugins = False
    workers: Workers = None
    log: LogFile = None
    debug: Debug = False

    @property
    def changes(self) -> dict[str, Any]:
        """The settings of the job that options change, by dotted keys; None where an option is not given."""
        return {
            "name": self.name,
            "cells.strategy": self.cell,
            "cells.lattice": self.lattice,
            "target": self.target,
            **self.reading,
        }


@dataclass(frozen=True, kw_only=True)
class BuildOptions(JobOptions):
    """Options of the commands that make build jobs: `run` and `support`."""

    printer: Printer = None
    material: Material = None
    labels: Annotated[
        str | None,
        job_option(
            "--labels",
            metavar="FILE.csv",
            help="List of texts that are engraved into copies of parts, or raised from them.",
        ),
    ] = None
    router: Annotated[
        str | None,
        job_option(
            "--router",
            metavar="NAME",
            help="Support router by name; see 'amprep plugins list'.",
            autocompletion=completion.routers,
        ),
    ] = None
    connector: Annotated[
        str | None,
        job_option(
            "--connector", metavar="KIND", help="End of supports at the part: full, teeth, point or extend."
        ),
    ] = None
    base: Annotated[
        str | None,
        job_option("--base", metavar="KIND", help="Base of supports on the plate: direct, flange or raft."),
    ] = None
    supports_as: Annotated[
        str | None,
        job_option(
            "--supports-as",
            metavar="TYPE",
            help="Type of supports in a generic file: support (default) or model.",
        ),
    ] = None
    open_report: OpenReport = False
    seed: Annotated[
        int | None, job_option("--seed", metavar="N", help="Seed of the random numbers; default 0.")
    ] = None
    time_limit: Annotated[
        float | None,
        job_option(
            "--time-limit",
            min=0.0,
            metavar="SECONDS",
            help="Stop packing and routing after this time, leave out supports that are not finished after twice as "
            "long, and end verification after three times as long.",
        ),
    ] = None
    allow_surface: Annotated[
        bool, job_option("--allow-surface", help="Accept meshes that are not solids as surfaces.")
    ] = False

    @property
    def changes(self) -> dict[str, Any]:
        """The settings of the job that options change, by dotted keys; None where an option is not given."""
        return {
            "printer": self.printer,
            "material": self.material,
            "supports.strategy": self.router,
            "labels": self.labels,
            **super().changes,
            "seed": self.seed,
            "supports.write_as": self.supports_as,
            "cells.connector": self.connector,
            "cells.base": self.base,
        }


def with_options(options: type[Any]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Return a decorator that adds the fields of a dataclass to a command as options.

    The command has a keyword-only parameter ``options`` and gets an instance of the dataclass. typer reads the
    signature of a command, therefore the decorator replaces it by the parameters of the command followed by one
    parameter for each field.

    Parameters
    ----------
    options
        Dataclass whose fields all have defaults and annotations as typer takes them.
    """
    hints = get_type_hints(options, include_extras=True)
    shared = [
        inspect.Parameter(
            field.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=field.default,
            annotation=hints[field.name],
        )
        for field in fields(options)
    ]

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        own = inspect.signature(command, eval_str=True).parameters.values()
        parameters = [each for each in own if each.name != "options"] + shared

        @wraps(command)
        def wrapper(**given: Any) -> None:
            chosen = options(**{field.name: given.pop(field.name) for field in fields(options)})
            command(options=chosen, **given)

        by_name = [each.replace(kind=inspect.Parameter.KEYWORD_ONLY) for each in parameters]
        wrapper.__signature__ = inspect.Signature(by_name)  # type: ignore[attr-defined]
        wrapper.__annotations__ = {each.name: each.annotation for each in parameters}
        return wrapper

    return decorate
