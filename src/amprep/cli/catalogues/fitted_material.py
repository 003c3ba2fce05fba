"""``amprep printers fit``: make a material profile whose speed is that of a machine."""

import json
from pathlib import Path
from typing import Annotated

import typer

from amprep import cli
from amprep.cli import completion
from amprep.cli.options import AsJson, Force


def fit(
    log: Annotated[
        Path,
        typer.Argument(
            metavar="LOG.csv", help="Log of a build with the columns layer, seconds and area (mm2 scanned)."
        ),
    ],
    like: Annotated[
        str,
        typer.Option(
            metavar="MATERIAL",
            help="Material from which the profile takes all other keys.",
            autocompletion=completion.materials,
        ),
    ] = "metal",
    name: Annotated[
        str | None, typer.Option(metavar="NAME", help="Name of the profile; default: that of the log.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE.toml", help="The profile; default: it is printed."),
    ] = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Fit the time for recoating and the speed of scanning to the log of a build.

    The result is a material profile for jobs on this machine. It says how well
    it predicts layers that were not fitted.

    Exit codes: 0 if done, 2 if the log cannot be used.
    """
    from dataclasses import asdict, replace

    from amprep.errors import AmprepError, InputError
    from amprep.files import replacing
    from amprep.materials.catalogue import find_material
    from amprep.materials.layer_log import read_layer_log
    from amprep.measures.printing.fit import fit_speed
    from amprep.profiles import profile_text

    base = find_material(like)
    if output is not None and output.exists() and not force:
        raise AmprepError(f"{output} exists already; use --force to replace it")
    try:
        found = fit_speed(*read_layer_log(log))
    except ValueError as error:
        raise InputError(f"{log}: {error}") from error
    words = (
        f"fitted to {found.layers - found.left_out} of {found.layers} layers; fitted to every third of them, the "
        f"total of the others is {100 * found.total_error:.1f} % off, the worst tenth {100 * found.worst_error:.1f} %"
    )
    profile = replace(
        base,
        name=name or log.stem,
        aliases=(),
        based_on="",
        recoating_s=round(found.recoating_s, 3),
        scan_mm2_s=round(found.scan_mm2_s, 3),
        source=f"speed {words} (log {log.name}); all other figures from {base.name}: {base.source}",
    )
    text = profile_text({key: value for key, value in asdict(profile).items() if key != "based_on"})
    if output is not None:
        with replacing(output) as temporary:
            temporary.write_text(text, encoding="utf-8")
    if as_json:
        typer.echo(
            json.dumps({**found._asdict(), "name": profile.name, "file": output and str(output)}, indent=2)
        )
    else:
        typer.echo(
            f"recoating {found.recoating_s:.2f} s, scanning {found.scan_mm2_s:.1f} mm2/s: {words}", err=True
        )
        typer.echo(text if output is None else f"wrote {output}", nl=output is not None)
    raise typer.Exit(cli.DONE)
