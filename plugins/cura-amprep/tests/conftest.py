"""Stand-ins of Cura's modules in place of the modules."""

import sys

import pytest
from stand_ins import Application, Desktop, Message, modules


@pytest.fixture
def stand_in(monkeypatch):
    """The class `Application`, with all stand-ins in place of Cura's modules."""
    for name, module in modules().items():
        monkeypatch.setitem(sys.modules, name, module)
    for name in ("extension", "dialog"):
        monkeypatch.delitem(sys.modules, f"cura_amprep.{name}", raising=False)
    Message.shown.clear()
    Desktop.opened.clear()
    yield Application
    for name in ("extension", "dialog"):
        sys.modules.pop(f"cura_amprep.{name}", None)
