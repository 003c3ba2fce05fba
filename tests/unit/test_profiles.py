"""Profiles of every kind are found in the same folders."""

import pytest

from amprep.profiles import user_folder


@pytest.mark.parametrize(
    ("platform", "env", "expected"),
    [
        ("linux", {"HOME": "/h"}, "/h/.config/amprep/printers"),
        ("linux", {"HOME": "/h", "XDG_CONFIG_HOME": "/x"}, "/x/amprep/printers"),
        ("darwin", {"HOME": "/h"}, "/h/Library/Application Support/amprep/printers"),
        ("win32", {"USERPROFILE": "/h", "APPDATA": "/r"}, "/r/amprep/printers"),
    ],
)
def test_the_users_folder_follows_the_custom_of_the_platform(platform, env, expected):
    assert user_folder(env, "printers", platform).as_posix() == expected
