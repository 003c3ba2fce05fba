"""The layer for Cura, on stand-ins of Cura's classes: menu, messages, cancelling and the change of the scene."""

import ast
import json
from importlib import import_module
from pathlib import Path

import pytest
from stand_ins import Desktop, Mesh, Message, Node

PLUGIN = Path(__file__).parents[1] / "cura_amprep"


@pytest.fixture
def prepared(stand_in, monkeypatch):
    """Return a function that prepares a plate with nodes and a given outcome, and returns the application."""

    def call(outcome, *nodes, machine=True):
        import cura_amprep

        def prepare(_order, _process, on_progress):
            on_progress("pack", 0.5, "box 3")
            if isinstance(outcome, Exception):
                raise outcome
            return outcome

        monkeypatch.setattr(import_module("cura_amprep.extension"), "prepare", prepare)
        application = stand_in(nodes, machine=machine)
        added = cura_amprep.register(application)["extension"]
        added.menu["Prepare plate with amprep"]()
        return application, added

    return call


def result(**values):
    from cura_amprep.outcome import Outcome

    return Outcome("Text.", **values)


def test_the_build_replaces_the_models_and_the_report_opens(prepared, tmp_path):
    outcome = result(
        builds=(tmp_path / "a.3mf",), report=tmp_path / "report.html", is_good=True, has_all=True
    )
    blocker = Node(Mesh(), isNonPrintingMesh=True)
    application, added = prepared(outcome, Node(Mesh()), Node(children=[Node(Mesh())]), blocker)
    assert application.root.children == [blocker]
    assert application.read == [(str(tmp_path / "a.3mf"), "open_as_model")]
    progress, end = Message.shown
    assert progress.texts == ["pack: box 3"]
    assert progress.progress == 50.0
    assert progress.hidden
    assert (end.text, end.kind) == ("Text.", Message.MessageType.POSITIVE)
    end.actionTriggered.emit(end, end.actions[0])
    assert Desktop.opened == [str(tmp_path / "report.html")]
    added.menu["Prepare plate with amprep"]()  # it may run again: the plate is empty now
    assert Message.shown[-1].text == "There is no model on the plate."


@pytest.mark.parametrize(
    ("outcome", "text", "kind"),
    [
        (result(), "Text.", Message.MessageType.ERROR),
        (result(is_cancelled=True), "Text.", Message.MessageType.NEUTRAL),
        (KeyError("why"), "The plugin failed: 'why'", Message.MessageType.ERROR),
    ],
)
def test_without_a_build_the_plate_stays_as_it_is(prepared, outcome, text, kind):
    node = Node(Mesh())
    application, _ = prepared(outcome, node)
    assert application.root.children == [node]
    assert application.read == []
    assert (Message.shown[-1].text, Message.shown[-1].kind) == (text, kind)


def test_models_stay_where_no_build_holds_all_of_them(prepared, tmp_path):
    node = Node(Mesh())
    application, _ = prepared(result(builds=(tmp_path / "a.3mf", tmp_path / "b.3mf")), node)
    assert application.root.children == [node]
    assert application.read == []
    assert Message.shown[-1].kind == Message.MessageType.WARNING


def test_without_a_printer_nothing_starts(prepared):
    prepared(result(), Node(Mesh()), machine=False)
    assert [message.text for message in Message.shown] == ["Add a printer first."]


def test_the_message_of_the_progress_cancels(stand_in, monkeypatch):
    from cura_amprep.extension import AmprepExtension
    from cura_amprep.outcome import outcome_of

    def prepare(order, process, on_progress):
        (message,) = Message.shown
        message.actionTriggered.emit(message, "cancel")
        return outcome_of(process.run(["missing"], on_progress), order.folder)

    monkeypatch.setattr(import_module("cura_amprep.extension"), "prepare", prepare)
    AmprepExtension(stand_in([Node(Mesh())])).menu["Prepare plate with amprep"]()
    assert Message.shown[-1].text == "Cancelled. Nothing was written."


def test_the_dialog_shows_the_settings_and_stores_known_ones(stand_in):
    from cura_amprep.dialog import PAGE
    from cura_amprep.extension import AmprepExtension

    application = stand_in()
    AmprepExtension(application).menu["Settings"]()
    ((path, context),) = application.pages
    assert path == str(PAGE)
    manager = context["manager"]
    manager.store("cell", " x-wall ")
    manager.store("unknown", "value")
    assert application.values["amprep/cell"] == "x-wall"
    assert "amprep/unknown" not in application.values
    assert {row["key"]: row["value"] for row in manager.rows}["cell"] == "x-wall"
    text = PAGE.read_text(encoding="utf-8")
    assert "manager.rows" in text
    assert "manager.store" in text


def test_cura_4_and_5_accept_the_description_of_the_plugin():
    described = json.loads((PLUGIN / "plugin.json").read_text(encoding="utf-8"))
    assert {"name", "author", "version", "description"} <= set(described)
    assert described["supported_sdk_versions"] == ["7.0.0", "8.0.0"]


@pytest.mark.parametrize("path", sorted(PLUGIN.glob("*.py")), ids=lambda path: path.name)
def test_the_code_is_python_3_8(path):
    source = path.read_text(encoding="utf-8")
    tree = ast.parse(source, feature_version=(3, 8))
    assert "from __future__ import annotations" in source  # annotations are newer, and never evaluated
    assert not any(isinstance(node, ast.Match) for node in ast.walk(tree))
