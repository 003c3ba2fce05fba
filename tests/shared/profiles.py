"""Folders of profiles of a project and of a user, and the claims that hold for profiles of every kind."""

from dataclasses import dataclass, field
from pathlib import Path

import pytest

from amprep.errors import JobError


@dataclass(frozen=True)
class Places:
    """A project folder, and an environment whose configuration folder is empty; unpacks into the two."""

    kind: str
    root: Path
    env: dict[str, str] = field(init=False)

    def __post_init__(self) -> None:
        for name in ("project", "config/amprep"):
            (self.root / name / f"{self.kind}s").mkdir(parents=True)
        env = {"XDG_CONFIG_HOME": str(self.root / "config"), "HOME": str(self.root)}
        object.__setattr__(self, "env", env)

    def __iter__(self):
        return iter((self.root / "project", self.env))


def assert_refused(places, find, listed, text, message):
    """Assert that an invalid profile is refused with its path, and gives one warning in the list."""
    folder, env = places
    path = folder / f"{places.kind}s" / "broken.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(JobError, match=message) as caught:
        find("broken", folder, env)
    assert str(path) in str(caught.value)
    assert len(listed(folder, env)[1]) == 1
