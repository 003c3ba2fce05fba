"""Files are written whole; folders of dead processes are removed, those of living ones never."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from amprep.errors import AmprepError
from amprep.files import PREFIX, is_running, make_temporary_folder, remove_abandoned, replacing


def made_by_another(folder, then):
    """Let another process make a temporary folder and do something; return that folder's path."""
    code = (
        "import os; from pathlib import Path; from amprep.files import make_temporary_folder\n"
        f"made = make_temporary_folder(Path({str(folder)!r})); print(made[0], flush=True); {then}"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stdin=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    return process, Path(process.stdout.readline().strip())


def test_after_an_error_neither_the_file_nor_a_temporary_one_is_left(tmp_path):
    def failing():
        with replacing(tmp_path / "a.txt") as temporary:
            temporary.write_text("half")
            raise OSError(28, "No space left on device")

    with pytest.raises(
        AmprepError, match=r"cannot write .*a\.txt: No space left on device; choose another folder"
    ):
        failing()
    assert list(tmp_path.iterdir()) == []


def test_the_folder_of_a_killed_process_is_removed_and_that_of_a_living_one_stays(tmp_path):
    killed, left = made_by_another(tmp_path, "os.kill(os.getpid(), 9)")
    killed.communicate()
    living, kept = made_by_another(tmp_path, "input()")
    assert left.is_dir()
    remove_abandoned(tmp_path)
    assert (left.exists(), kept.is_dir()) == (False, True)
    living.communicate("\n")


def test_a_process_that_began_later_has_only_the_same_number(tmp_path):
    own, lock = make_temporary_folder(tmp_path)
    began = int(own.name.split("-")[2])
    assert is_running(os.getpid(), began)
    assert not is_running(os.getpid(), began + 1)
    assert lock is not None
    os.close(lock)


def test_a_folder_with_a_lock_stays_although_its_number_is_that_of_no_process_here(tmp_path):
    own, lock = make_temporary_folder(tmp_path)
    stranger = own.rename(tmp_path / f"{PREFIX}999999999-1-abc")
    remove_abandoned(tmp_path)
    assert stranger.is_dir()
    assert lock is not None
    os.close(lock)
    remove_abandoned(tmp_path)
    assert not stranger.exists()


def test_links_and_folders_of_others_stay(tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "mine.txt").write_text("mine")
    (tmp_path / f"{PREFIX}999999999-1-abc").symlink_to(elsewhere)
    (tmp_path / f"{PREFIX}notes").mkdir()
    remove_abandoned(tmp_path)
    assert (elsewhere / "mine.txt").read_text(encoding="utf-8") == "mine"
    assert (tmp_path / f"{PREFIX}notes").is_dir()
