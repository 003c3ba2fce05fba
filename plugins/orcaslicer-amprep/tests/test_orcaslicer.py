"""The script for OrcaSlicer, on a stand-in of the few classes of its module `orca` that the script uses."""

import json
import os
import sys
from importlib import import_module
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import amprep

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float32)
FACES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ],
    np.int32,
)
"""A unit cube."""
STL = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""A triangle of a binary STL file."""


def volume(size, *, is_part=True):
    mesh = SimpleNamespace(vertices=lambda: CORNERS * np.float32(size), triangles=lambda: FACES)
    return SimpleNamespace(is_model_part=lambda: is_part, mesh=lambda: mesh, matrix=lambda: np.eye(4))


def instance(at, *, mirrored=False, printable=True):
    matrix = np.diag([-1.0 if mirrored else 1.0, 1, 1, 1])
    matrix[:3, 3] = at
    return SimpleNamespace(matrix=lambda: matrix, printable=printable)


def model_object(name, volumes, instances):
    return SimpleNamespace(name=name, volumes=lambda: volumes, instances=lambda: instances)


class Dialog:
    """A progress dialog that the user closes after some updates."""

    def __init__(self, updates=10**9):
        self.left, self.shown = updates, []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def update(self, value, message=""):
        self.shown.append((value, message))
        return self.pulse()

    def pulse(self, message=""):  # noqa: ARG002 - the signature of OrcaSlicer
        self.left -= 1
        return self.left > 0


class ClosedAtTheEnd(Dialog):
    """A progress dialog that the user closes when it shows progress."""

    def update(self, value, message=""):
        self.shown.append((value, message))
        return False


class Orca(ModuleType):
    """The module `orca` with a model, a printer and a configuration."""

    def __init__(self, folder):
        super().__init__("orca")
        self.objects: list[Any] = []
        self.config: dict[str, str] = {}
        self.messages: list[str] = []
        self.dialog = Dialog()
        base = type("ScriptPluginCapabilityBase", (), {"get_config": lambda _: json.dumps(self.config)})
        self.script = SimpleNamespace(ScriptPluginCapabilityBase=base)
        self.base, self.plugin = object, lambda package: package
        self.registered: list[Any] = []
        self.register_capability = self.registered.append
        self.PluginResult = SimpleNamespace(RecoverableError="error")
        self.ExecutionResult = SimpleNamespace(
            success=lambda text: ("success", text),
            skipped=lambda text: ("skipped", text),
            failure=lambda kind, text: (kind, text),
        )
        values = {"printable_area": "0x0,60x0,60x40,0x40", "printable_height": "50"}
        preset = SimpleNamespace(name="My printer", config_value=values.get)
        self.host = SimpleNamespace(
            model=lambda: SimpleNamespace(objects=lambda: self.objects),
            preset_bundle=lambda: SimpleNamespace(current_printer_preset=lambda: preset),
            plugin=SimpleNamespace(storage=lambda: str(folder)),
            ui=SimpleNamespace(
                PD_APP_MODAL=1,
                PD_AUTO_HIDE=2,
                PD_CAN_ABORT=4,
                create_progress_dialog=lambda *_, **__: self.dialog,
                message=self.message,
            ),
        )

    def message(self, text, **_):
        self.messages.append(text)
        return "no"


@pytest.fixture
def orca(monkeypatch, tmp_path):
    stand_in = Orca(tmp_path / "storage")
    monkeypatch.setitem(sys.modules, "orca", stand_in)
    yield stand_in
    sys.modules.pop("amprep_plate", None)


def program(tmp_path, code):
    """The path of a program that runs Python code."""
    path = tmp_path / "program"
    path.write_text(f"#!{sys.executable}\n{code}\n", encoding="utf-8")
    path.chmod(0o755)
    return str(path)


def execute(orca):
    script = import_module("amprep_plate")
    script.AmprepPlugin().register_capabilities()
    return orca.registered[-1]().execute()


posix = pytest.mark.skipif(os.name == "nt", reason="the programs of these tests are scripts")


@posix
def test_amprep_prepares_the_models_for_the_selected_printer(orca, tmp_path):
    orca.objects = [model_object("box", [volume((10, 5, 4))], [instance((5, 5, 0))])]
    orca.config = {
        "program": program(tmp_path, "from amprep.cli import main\nmain()"),
        "packer": "extreme-points",
    }
    kind, text = execute(orca)
    assert kind == "success", text
    folder = tmp_path / "storage"
    report = json.loads((folder / "plate.report.json").read_text(encoding="utf-8"))
    assert report["printer"] == "My printer"
    np.testing.assert_allclose(report["builds"][0]["build_volume_mm"], (60, 40, 50))
    assert report["target"] == "prusaslicer"
    assert str(folder / "plate.build-1.3mf") in orca.messages[0]
    assert (folder / "plate.build-1.3mf").is_file()
    assert "pack" in {message.partition(":")[0] for _, message in orca.dialog.shown}


def test_printable_instances_are_written_where_they_are_and_modifiers_are_not(orca, tmp_path):
    script = import_module("amprep_plate")
    turned = instance((30, 20, 0), mirrored=True)
    parts = [volume((10, 5, 4)), volume((2, 2, 2), is_part=False)]
    orca.objects = [
        model_object("a/b", parts, [instance((1, 2, 0)), turned, instance((9, 9, 9), printable=False)])
    ]
    names = script.write_models(orca.host.model(), tmp_path)
    assert names == ["a-b 1-1.stl", "a-b 1-2.stl"]
    assert len(amprep.load(tmp_path / "models").parts) == 2
    for name, low in zip(names, [(1, 2, 0), (20, 20, 0)], strict=True):
        corners = np.frombuffer((tmp_path / "models" / name).read_bytes()[84:], STL)["corners"].astype(float)
        np.testing.assert_allclose(corners.min(axis=(0, 1)), low)
        np.testing.assert_allclose(np.ptp(corners.reshape(-1, 3), axis=0), (10, 5, 4))
        # a mesh inside out would have a negative volume
        assert np.linalg.det(corners - np.array(low)).sum() / 6 == pytest.approx(200)
    assert script.write_models(SimpleNamespace(objects=list), tmp_path) == []
    assert list((tmp_path / "models").iterdir()) == []


def test_without_a_model_nothing_starts(orca):
    assert execute(orca) == ("skipped", "There is no printable model.")


@posix
def test_closing_the_dialog_ends_the_program(orca, tmp_path):
    orca.objects = [model_object("box", [volume((1, 1, 1))], [instance((0, 0, 0))])]
    orca.config = {"program": program(tmp_path, "import time\ntime.sleep(60)"), "printer": "EOS M290"}
    orca.dialog = Dialog(updates=1)
    assert execute(orca) == ("skipped", "Cancelled; nothing was written.")


@posix
def test_an_error_of_amprep_is_the_result(orca, tmp_path):
    orca.objects = [model_object("box", [volume((1, 1, 1))], [instance((0, 0, 0))])]
    code = "import sys\nsys.stderr.write('amprep: wrong\\n')\nsys.exit(2)"
    orca.config = {"program": program(tmp_path, code)}
    assert execute(orca) == ("error", "amprep: wrong")


def test_a_program_that_is_missing_is_an_error(orca, tmp_path):
    orca.objects = [model_object("box", [volume((1, 1, 1))], [instance((0, 0, 0))])]
    orca.config = {"program": str(tmp_path / "missing")}
    kind, text = execute(orca)
    assert kind == "error"
    assert text == f"{tmp_path / 'missing'}: No such file or directory"


@posix
def test_an_answer_that_is_no_report_is_an_error(orca, tmp_path):
    orca.objects = [model_object("box", [volume((1, 1, 1))], [instance((0, 0, 0))])]
    orca.config = {"program": program(tmp_path, "print('{}')"), "printer": "EOS M290"}
    kind, text = execute(orca)
    assert (kind, "update both" in text) == ("error", True)


@posix
def test_a_build_that_was_written_before_the_dialog_closed_is_told(orca, tmp_path):
    report = {"builds": [{"file": "plate.build-1.3mf"}], "unplaced": [], "triage": {"must_fix": 0}}
    step = {"stage": "write", "fraction": 1.0, "message": ""}
    code = (
        "import json, signal, sys\nsignal.signal(signal.SIGTERM, signal.SIG_IGN)\n"
        f"sys.stderr.write(json.dumps({step!r}) + chr(10))\nprint(json.dumps({report!r}))"
    )
    orca.objects = [model_object("box", [volume((1, 1, 1))], [instance((0, 0, 0))])]
    orca.config = {"program": program(tmp_path, code), "printer": "EOS M290", "folder": str(tmp_path)}
    orca.dialog = ClosedAtTheEnd()
    assert execute(orca)[0] == "success"


@posix
def test_what_must_be_fixed_is_said(orca, tmp_path):
    report = {"builds": [{"file": "../plate.build-1.3mf"}], "unplaced": [{}], "triage": {"must_fix": 2}}
    orca.objects = [model_object("box", [volume((1, 1, 1))], [instance((0, 0, 0))])]
    code = f"import json, sys\nprint(json.dumps({report!r}))\nsys.exit(1)"
    orca.config = {"program": program(tmp_path, code), "printer": "EOS M290", "folder": str(tmp_path)}
    assert execute(orca)[0] == "success"
    assert orca.messages[0].startswith("Parts that were not placed: 1\nMust be fixed: 2\n")
    assert str(tmp_path / "plate.build-1.3mf") in orca.messages[0]


@pytest.mark.parametrize(
    "line", ["{", "{}", "[1]", '{"stage": "a", "message": "b", "fraction": "c"}', "{" * 9999]
)
def test_a_foreign_line_is_no_progress(orca, line):  # noqa: ARG001 - the script imports the module
    progress_of = import_module("amprep_plate").progress_of
    assert progress_of(line) is None
    assert progress_of('{"stage": "pack", "message": "", "fraction": 0.5}') == ("pack", 0.5)
