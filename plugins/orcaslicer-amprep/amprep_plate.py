# /// script
# requires-python = ">=3.12"
# dependencies = ["numpy"]
#
# [tool.orcaslicer.plugin]
# name = "amprep"
# description = "Packs the models, plans supports that stand on the plate, and writes a verified build."
# author = "amprep contributors"
# version = "0.1.0"
# ///
"""A script plugin of OrcaSlicer: hand the models to amprep, show its progress, and tell where the build is.

The interface of plugins lets them read the model but not change it, so the user opens the build.
"""

import json
import os
import queue
import subprocess
import threading
import webbrowser
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, cast

import numpy as np
import orca

DEFAULTS = {"program": "amprep", "printer": "", "packer": "", "cell": "", "material": "", "folder": ""}
"""Keys of the plugin's configuration, and what applies without them.

An empty text leaves a choice to amprep, and an empty printer means the selected one.
"""

_OF_ORCASLICER = ("PYTHONHOME", "PYTHONPATH", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH")
"""Variables by which a packaged OrcaSlicer finds its own Python and libraries; they would break another Python."""

_POLL_S = 0.1
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""A triangle of a binary STL file."""


@dataclass(frozen=True)
class Ended:
    """How a command ended: exit code, standard output, last line of standard error that is no progress."""

    code: int
    output: str
    error: str
    cancelled: bool


class PreparePlate(orca.script.ScriptPluginCapabilityBase):
    """Prepares all printable models."""

    def get_name(self) -> str:
        """Return the name in the list of plugins."""
        return "Prepare plate with amprep"

    def execute(self, *_context: Any) -> Any:
        """Prepare the models with a progress dialog, and show the outcome."""
        settings = {**DEFAULTS, **json.loads(self.get_config() or "{}")}
        folder = Path(settings["folder"] or orca.host.plugin.storage()).expanduser()
        try:
            names = write_models(orca.host.model(), folder / "plate")
            if not names:
                return orca.ExecutionResult.skipped("There is no printable model.")
            ended = self._run(settings, folder)
            # the files may have been there before the user closed the dialog
            if ended.cancelled and ended.code != 0:
                return orca.ExecutionResult.skipped("Cancelled; nothing was written.")
            if ended.code not in (0, 1):
                return _failure(ended.error)
            return _show(json.loads(ended.output), folder)
        except OSError as error:
            return _failure(f"{error.filename or settings['program']}: {error.strerror or error}")
        except (ValueError, KeyError, IndexError, TypeError):
            return _failure("amprep printed nothing that this plugin can read; update both.")

    def _run(self, settings: dict[str, str], folder: Path) -> Ended:
        ui = orca.host.ui
        style = ui.PD_APP_MODAL | ui.PD_AUTO_HIDE | ui.PD_CAN_ABORT
        with ui.create_progress_dialog("amprep", "Preparing the plate", style=style) as dialog:
            printer = settings["printer"]
            if not printer:
                profile = write_printer(orca.host.preset_bundle().current_printer_preset(), folder / "plate")
                command = [
                    "printers",
                    "import",
                    str(profile),
                    "-o",
                    str(folder / "plate"),
                    "--force",
                    "--json",
                ]
                ended = run([settings["program"], *command], dialog)
                if ended.code != 0 or ended.cancelled:
                    return ended
                printer = json.loads(ended.output)["files"][0]
            return run(run_arguments(settings, folder, printer), dialog)


def run_arguments(settings: dict[str, str], folder: Path, printer: str) -> list[str]:
    """Return the command that prepares the models in the folder ``plate``."""
    command = [settings["program"], "run", str(folder / "plate" / "models"), "--for", "prusaslicer", "--json"]
    command += ["--progress", "lines", "--name", "plate", "-o", str(folder), "--printer", printer]
    for option in ("packer", "cell", "material"):
        if settings[option]:
            command += [f"--{option}", settings[option]]
    return command


def write_models(model: Any, folder: Path) -> list[str]:
    """Write each printable instance as a binary STL file where it is on the plate, and return the names of the files.

    Parameters
    ----------
    model
        OrcaSlicer's model. Volumes of an object that are no parts, such as modifiers, are left out.
    folder
        Gets the folder ``models``, whose STL files are replaced.
    """
    target = folder / "models"
    target.mkdir(parents=True, exist_ok=True)
    for old in target.glob("*.stl"):
        old.unlink()
    names = []
    for number, item in enumerate(model.objects(), 1):
        for copy, instance in enumerate(item.instances(), 1):
            corners = list(_corners(item, instance))
            if instance.printable and corners:
                name = "".join(sign if sign.isalnum() or sign in " -_" else "-" for sign in item.name)[:60]
                names.append(f"{name or 'model'} {number}-{copy}.stl")
                _write_stl(np.concatenate(corners), target / names[-1])
    return names


def _corners(item: Any, instance: Any) -> Iterator[np.ndarray[Any, Any]]:
    """Yield the corners of the triangles of each part of an object, ``(n, 3, 3)`` mm, in world coordinates."""
    for volume in item.volumes():
        if volume.is_model_part():
            mesh = volume.mesh()
            matrix = np.asarray(instance.matrix()) @ np.asarray(volume.matrix())
            points = np.asarray(mesh.vertices(), np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
            faces = np.asarray(mesh.triangles())
            # a mirrored mesh would be inside out
            yield points[faces[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else faces]


def _write_stl(corners: np.ndarray[Any, Any], path: Path) -> None:
    triangles = np.zeros(len(corners), _TRIANGLE)
    triangles["corners"] = corners
    path.write_bytes(bytes(80) + np.uint32(len(corners)).tobytes() + triangles.tobytes())


def write_printer(preset: Any, folder: Path) -> Path:
    """Write bed and height of a printer preset as a profile of OrcaSlicer, which ``amprep printers import`` reads."""
    keys = ("printable_area", "printable_height", "bed_exclude_area")
    values = {
        key: preset.config_value(key) for key in keys
    }  # texts, as profiles have them; None without the key
    profile = {
        "type": "machine",
        "name": preset.name,
        **{key: value for key, value in values.items() if value},
    }
    path = folder / "machine.json"
    path.write_text(json.dumps(profile, indent=1), encoding="utf-8")
    return path


def run(command: list[str], dialog: Any) -> Ended:
    """Run a command, show its progress, and end it if the user closes the dialog.

    Threads read both outputs, because the dialog must be updated while the command is silent.
    """
    process = subprocess.Popen(  # noqa: S603 - no shell; the program is the user's choice
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8",
        errors="replace", env=environment(os.environ), creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
    )  # fmt: skip
    lines: queue.Queue[str | None] = queue.Queue()
    output: list[str] = []
    error, cancelled = "", False
    with process:
        threading.Thread(target=_pass_on, args=(cast("IO[str]", process.stderr), lines), daemon=True).start()
        reader = threading.Thread(
            target=lambda: output.append(cast("IO[str]", process.stdout).read()), daemon=True
        )
        reader.start()
        while (line := _next(lines)) is not None:
            step = progress_of(line)
            error = line.strip() if line and step is None else error
            goes_on = dialog.update(round(100 * step[1]), step[0]) if step else dialog.pulse()
            if not goes_on and not cancelled:
                cancelled = True
                process.terminate()
        code = process.wait()
        reader.join()
    return Ended(code, "".join(output), error, cancelled)


def environment(own: Mapping[str, str]) -> dict[str, str]:
    """Return the environment for another Python, with UTF-8 output."""
    return {**{key: value for key, value in own.items() if key not in _OF_ORCASLICER}, "PYTHONUTF8": "1"}


def _pass_on(stream: IO[str], lines: "queue.Queue[str | None]") -> None:
    for line in stream:
        lines.put(line)
    lines.put(None)


def _next(lines: "queue.Queue[str | None]") -> str | None:
    """Return the next line, an empty one if there is none yet, or None at the end."""
    try:
        return lines.get(timeout=_POLL_S)
    except queue.Empty:
        return ""


def progress_of(line: str) -> tuple[str, float] | None:
    """Return the text and fraction of a line of progress; None if it is something else."""
    if not line.startswith("{"):
        return None
    try:
        step = json.loads(line)
        return f"{step['stage']}: {step['message']}".rstrip(": "), float(step["fraction"])
    except (ValueError, RecursionError, KeyError, TypeError):
        return None


def _show(report: dict[str, Any], folder: Path) -> Any:
    """Tell where the builds are and what must be fixed, and open the report if the user wants it."""
    builds = [str(folder / Path(build["file"]).name) for build in report["builds"] if build["file"]]
    counts = {
        "Parts that were not placed": len(report["unplaced"]),
        "Must be fixed": report["triage"]["must_fix"],
    }
    problems = [f"{what}: {count}" for what, count in counts.items() if count]
    text = "\n".join(
        [*problems, "Open these files in OrcaSlicer, one for each plate:", *builds, "", "Open the report?"]
    )
    icon = "warning" if problems else "info"
    if orca.host.ui.message(text, title="amprep", buttons="yes_no", icon=icon) == "yes":
        webbrowser.open((folder / "plate.report.html").resolve().as_uri())
    return orca.ExecutionResult.success(f"Builds: {', '.join(builds)}")


def _failure(text: str) -> Any:
    return orca.ExecutionResult.failure(orca.PluginResult.RecoverableError, text or "amprep failed")


@orca.plugin
class AmprepPlugin(orca.base):
    """The package that OrcaSlicer loads."""

    def register_capabilities(self) -> None:
        """Register the script."""
        orca.register_capability(PreparePlate)
