"""Installation in a profile of the user, and nowhere else."""

import shlex
import sys
from pathlib import Path

import pytest

from amprep.errors import InputError
from amprep.slicers.presets import folders
from amprep.slicers.presets.install import install


@pytest.fixture
def settings(tmp_path):
    (tmp_path / "print").mkdir()
    (tmp_path / "print" / "My fine.ini").write_text("layer_height = 0.1\n", encoding="utf-8")
    process = tmp_path / "user" / "default" / "process"
    process.mkdir(parents=True)
    (process / "My fine.json").write_text('{"name": "My fine"}', encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize(
    ("slicer", "path"),
    [
        ("prusaslicer", "print/My fine.ini"),
        ("superslicer", "print/My fine.ini"),
        ("orcaslicer", "user/default/process/My fine.json"),
    ],
)
def test_the_profile_gets_the_command(settings, slicer, path):
    before = (settings / path).read_text(encoding="utf-8")
    shown = install(slicer, ["--strict"], profile="My fine", folder=settings, write=False)
    assert (settings / path).read_text(encoding="utf-8") == before
    done = install(slicer, ["--strict"], profile="My fine", folder=settings, write=True)
    text = (settings / path).read_text(encoding="utf-8")
    assert (done.profile, shown.profile, done.command) == (settings / path, None, shown.command)
    assert "amprep hook gcode --strict" in text
    assert "gcode_label_objects" in text


@pytest.mark.parametrize("name", ["My fin", "../print/My fine", ""])
def test_a_profile_that_does_not_exist_is_refused_with_those_that_do(settings, name):
    with pytest.raises(InputError, match="there are 'My fine'"):
        install("prusaslicer", [], profile=name, folder=settings, write=True)


def test_without_profiles_the_user_is_told_to_save_one(tmp_path):
    with pytest.raises(InputError, match="save one in the slicer"):
        install("prusaslicer", [], profile="x", folder=tmp_path, write=True)


@pytest.mark.parametrize(
    ("platform", "environment", "expected"),
    [
        ("linux", {}, "/home/me/.config/PrusaSlicer"),
        ("linux", {"XDG_CONFIG_HOME": "/conf"}, "/conf/PrusaSlicer"),
        ("darwin", {}, "/home/me/Library/Application Support/PrusaSlicer"),
        ("win32", {"APPDATA": "/roaming"}, "/roaming/PrusaSlicer"),
    ],
)
def test_settings_are_where_the_system_has_them(monkeypatch, platform, environment, expected):
    monkeypatch.setattr(sys, "platform", platform)
    found = folders.settings_folders("prusaslicer", environment, Path("/home/me"))
    assert found[0] == Path(expected)


@pytest.mark.parametrize("name", ["a b", "builds (1)", "$HOME", "it's", 'a"b', "a;b&c"])
def test_the_shell_of_a_slicer_reads_the_folder_as_it_is(settings, name):
    done = install("prusaslicer", ["--folder", name], profile="My fine", folder=settings, write=False)
    assert shlex.split(done.command)[-4:] == ["hook", "gcode", "--folder", name]


def test_windows_knows_only_double_quotes(monkeypatch, settings):
    monkeypatch.setattr(sys, "platform", "win32")
    done = install("prusaslicer", ["--folder", "a b"], profile="My fine", folder=settings, write=False)
    assert done.command.endswith('hook gcode --folder "a b"')


def test_a_profile_that_is_no_json_is_named(settings):
    path = settings / "user/default/process/My fine.json"
    path.write_text("{", encoding="utf-8")
    with pytest.raises(InputError, match=r"My fine\.json: not a profile: not JSON"):
        install("orcaslicer", [], profile="My fine", folder=settings, write=True)
    assert path.read_text(encoding="utf-8") == "{"
