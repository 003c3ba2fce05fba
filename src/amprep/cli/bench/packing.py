"""The packing benchmarks: ``amprep bench mpv``, ``container-loading``, ``esicup`` and ``packing``."""

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from amprep.cli.bench.options import AsJson, First, PackerName, Seed, Seeds, TimeLimit, finish, print_json
from amprep.errors import InputError

if TYPE_CHECKING:
    from amprep.bench.packing.run import PackingResult
    from amprep.bench.packing.thesis_tables import ThesisTable


def mpv(
    class_: Annotated[
        int, typer.Option("--class", metavar="C", min=1, max=8, help="Class of the instances, 1 to 8.")
    ],
    n: Annotated[
        int, typer.Option("--n", metavar="N", min=1, help="Number of boxes; published: 50, 100, 150 and 200.")
    ],
    time_limit: TimeLimit = 10.0,
    packer: PackerName = "auto",
    first: First = 1,
    count: Annotated[int, typer.Option("--count", metavar="N", min=1, help="Number of instances.")] = 10,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Pack the instances of Martello, Pisinger and Vigo (2000) into as few builds as possible."""
    from amprep.bench.packing.run import run_instances
    from amprep.testing.packing_instances import mpv_instance

    instances = [mpv_instance(class_, n, index) for index in range(first, first + count)]
    results = run_instances(instances, packer, seconds=time_limit, seed=seed, progress=_print_line(as_json))
    record = {"benchmark": "mpv", "class": class_, "n": n, "packer": packer, "time_limit_s": time_limit}
    _print(record, results, as_json=as_json)


def container_loading(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="JSON file of instances: container, boxes, rotations.")
    ],
    time_limit: TimeLimit = 30.0,
    packer: PackerName = "auto",
    first: First = 1,
    count: Annotated[
        int, typer.Option("--count", metavar="N", min=0, help="Number of instances; 0: all.")
    ] = 0,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Fill one container with as much volume as possible, for each instance of a file."""
    from amprep.bench.packing.container_loading import read_instances
    from amprep.bench.packing.run import run_instances

    known = read_instances(file)
    if first > len(known):
        raise InputError(
            f"--first must be at most {len(known)}, the number of instances in {file}; got {first}"
        )
    instances = known[first - 1 : first - 1 + count if count else None]
    results = run_instances(instances, packer, seconds=time_limit, seed=seed, progress=_print_line(as_json))
    record = {
        "benchmark": "container-loading",
        "file": file.name,
        "packer": packer,
        "time_limit_s": time_limit,
    }
    _print(record, results, as_json=as_json)


def esicup(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="FILE", help="JSON files of instances: base, meshes, demands."),
    ],
    packer: PackerName = "separation",
    time_limit: TimeLimit = 60.0,
    seeds: Seeds = 1,
    as_json: AsJson = False,
) -> None:
    """Pack the meshes of ESICUP instances on their bases, as low as possible, and check every layout on the meshes.

    The ratio is the height over the record, the mean height of sparrow-3d after
    10 minutes with four workers.
    """
    from amprep.bench.packing.esicup import read_esicup, run_esicup, summary

    known = [(file, read_esicup(file)) for file in files]
    progress = (lambda _: None) if as_json else (lambda result: typer.echo(f"  {result.line}"))
    instances: list[dict[str, Any]] = []
    for file, instance in known:
        name = f"{file.resolve().parent.name}/{file.name}"
        if not as_json:
            typer.echo(name)
        runs = run_esicup(instance, packer, seconds=time_limit, seeds=range(1, seeds + 1), progress=progress)
        shown = [asdict(run) | {"validated": run.validated} for run in runs]
        instances.append(
            {"file": name, "record_height_mm": instance.record, "mean": summary(runs), "runs": shown}
        )
    ratios = [each["mean"]["ratio"] for each in instances if each["mean"]["ratio"] is not None]
    ratio = sum(ratios) / len(ratios) if ratios else None
    if as_json:
        record = {"benchmark": "esicup", "packer": packer, "time_limit_s": time_limit, "seeds": seeds}
        print_json(record | {"mean": {"ratio": ratio, "with_record": len(ratios)}, "instances": instances})
    else:
        _print_heights(instances, ratio)
    finish(valid=all(run["validated"] for each in instances for run in each["runs"]))


def _print_heights(instances: list[dict[str, Any]], ratio: float | None) -> None:
    """Print a table of instances with their records, and the mean ratio."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE)
    table.add_column("instance", no_wrap=True)
    for heading in ("record", "mean height", "least", "ratio", "MiB"):
        table.add_column(heading, justify="right")
    for each in instances:
        record, mean = each["record_height_mm"], each["mean"]
        table.add_row(
            each["file"],
            "-" if record is None else f"{record:.2f}",
            f"{mean['height_mm']:.3f}",
            f"{mean['least_height_mm']:.3f}",
            "-" if mean["ratio"] is None else f"{mean['ratio']:.3f}",
            str(mean["memory_mb"]),
        )
    Console().print(table)
    if ratio is not None:
        typer.echo(f"mean ratio to the record: {ratio:.4f}")


def packing(
    time_limit: TimeLimit = 5.0,
    packers: Annotated[
        list[str] | None,
        typer.Option("--packer", metavar="NAME", help="Packer to measure; repeatable. Default: all."),
    ] = None,
    max_boxes: Annotated[
        int, typer.Option("--max-boxes", metavar="N", min=15, help="Leave out instances with more boxes.")
    ] = 120,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Print the thesis's two packing tables next to our results on instances of the same shape."""
    from amprep.bench.packing.thesis_tables import thesis_tables

    progress = (lambda _: None) if as_json else (lambda line: typer.echo(line, err=True))
    tables = thesis_tables(packers or [], max_boxes, seconds=time_limit, seed=seed, progress=progress)
    if as_json:
        print_json([_table_record(table) for table in tables])
    else:
        for table in tables:
            _print_table(table)
    finish(valid=all(result.validated for table in tables for row in table.ours.values() for result in row))


def _table_record(table: "ThesisTable") -> dict[str, Any]:
    ours = {label: [result.record for result in row] for label, row in table.ours.items()}
    return {"table": table.title, "boxes": table.boxes, "thesis": table.thesis, "instances": ours}


def _print_table(table: "ThesisTable") -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from amprep.bench.packing.thesis_tables import table_cell

    shown = Table("boxes", *map(str, table.boxes), box=box.SIMPLE, title=table.title)
    for name, cells in table.thesis.items():
        shown.add_row(f"thesis: {name}", *cells, style="dim")
    for label, row in table.ours.items():
        shown.add_row(label, *(table_cell(result) if result.validated else "INVALID" for result in row))
    Console().print(shown)


def _print_line(as_json: bool) -> "Callable[[PackingResult], None]":
    """Return a function that prints each result at once, unless JSON was asked for."""
    return (lambda _: None) if as_json else (lambda result: typer.echo(result.line))


def _mean(name: str, value: float) -> str:
    match name:
        case "fill_ratio":
            return f"filled {value:.1%}"
        case "seconds":
            return f"{value:.2f} s"
        case _:
            return f"{name} {value:.6g}"


def _print(record: dict[str, Any], results: "list[PackingResult]", *, as_json: bool) -> None:
    """Print the means, or everything as JSON, and end the command."""
    from amprep.bench.packing.run import means

    record |= {"mean": means(results), "instances": [result.record for result in results]}
    if as_json:
        print_json(record)
    else:
        typer.echo("mean: " + ", ".join(_mean(name, value) for name, value in record["mean"].items()))
    finish(valid=all(result.validated for result in results))
