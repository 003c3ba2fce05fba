"""Warming up works on a small part with every offer, goes on when one fails, and leaves no file."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from amprep.bench import warming
from amprep.errors import AmprepError
from amprep.host import Host
from amprep.model import Progress, Stop
from amprep.stl import write_stl


class Titles:
    """Notes what is shown."""

    def __init__(self) -> None:
        self.shown: list[str] = []

    @contextmanager
    def stage(self, name: str) -> Iterator[Progress]:
        self.shown.append(name)
        yield lambda _, message: self.shown.append(message)


@pytest.fixture
def alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Let temporary folders be in a folder of the test."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def test_every_offer_that_may_need_kernels_has_a_task() -> None:
    host = Host.load(plugins_enabled=False)
    titles = [title for title, _ in warming._tasks(host)]
    for kind in ("packer", "volume", "router", "cell"):
        assert {f"{kind} {name}" for name in host.offers(kind)} <= set(titles)
    assert len(titles) == len(set(titles))


def test_what_fails_is_left_out_and_nothing_stays(alone: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    host, done = Host.load(plugins_enabled=False), list[str]()

    def fails(part: Path, folder: Path) -> None:
        assert part.is_file()
        assert folder.is_dir()
        raise AmprepError("no solver")

    tasks = [("a", fails), ("b", lambda *_: done.append("b"))]
    monkeypatch.setattr(warming, "_tasks", lambda _: iter(tasks))
    titles = Titles()
    warming.warm_up(plugins=host, watcher=titles)
    assert titles.shown == ["compile", "a", "b"]
    assert done == ["b"]
    assert list(alone.iterdir()) == []


def test_it_ends_early_when_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    host, stop = Host.load(plugins_enabled=False), Stop()
    monkeypatch.setattr(warming, "_tasks", lambda _: iter([("a", lambda *_: stop.cancelled.set())] * 2))
    titles = Titles()
    warming.warm_up(plugins=host, watcher=titles, stop=stop)
    assert titles.shown == ["compile", "a"]


def test_the_part_can_be_supported(alone: Path) -> None:
    host = Host.load(plugins_enabled=False)
    tasks = dict(warming._tasks(host))
    part = alone / "table.stl"
    write_stl(warming._table(), part)
    tasks["cell prism below a part"](part, alone)
    tasks["judges"](part, alone)
    assert (alone / "table.supported.3mf").is_file()
