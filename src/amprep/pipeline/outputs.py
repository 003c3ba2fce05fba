"""The output folder: files are written to a hidden folder inside it and appear together at the end."""

import os
import re
import shutil
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self

from amprep.errors import InputError
from amprep.files import make_temporary_folder, remove_abandoned, taking_turns
from amprep.interruption import clean_with, files_appeared, held, raise_lost

REPORTS = ("report.html", "report.json", "placements.csv")
"""The reports of a run; their names begin with that of the job."""

_ATTEMPTS = 5
"""Another run that ends in between may remove the new folder, because it is empty."""


def safe_name(text: str) -> str:
    """Return `text` as a valid file name of letters, digits, dots, dashes, underscores and spaces."""
    kept = re.sub(r"[^\w.\- ]+", "_", text).strip(". ")
    return kept[:100] or "unnamed"


def _refuse_unusable(folder: Path) -> None:
    """Refuse an output folder that is a file, or below one, or that this user may not write to."""
    nearest = next((each for each in (folder, *folder.parents) if each.exists()), None)
    if nearest is not None and not nearest.is_dir():
        raise InputError(
            f"cannot write to the output folder {folder}: {nearest} is a file; choose another by -o"
        )
    if nearest is not None and not os.access(nearest, os.W_OK):
        raise InputError(f"cannot write to the output folder {folder}: no permission; choose another by -o")


class OutputFolder:
    """Collects the files of a run and publishes them together; after an exception or a signal no file appears.

    A run that was killed leaves its hidden folder; the next run into the same output folder removes it.

    Parameters
    ----------
    folder
        Created if it does not exist.
    stem
        Beginning of all file names.
    numbered
        False if there is only one build, whose files need no number.

    Raises
    ------
    InputError
        If the folder cannot be created or written; what is known before anything is written is refused at once.
    """

    def __init__(self, folder: Path, stem: str, *, numbered: bool = True) -> None:
        _refuse_unusable(folder)
        self.folder, self.stem, self.numbered = folder, safe_name(stem), numbered
        self._names: dict[str, None] = {}

    def __enter__(self) -> Self:
        self._made: list[Path] = []
        with held():
            try:
                self._make()
                remove_abandoned(self.folder)
            except OSError as error:
                self._remove_made()
                raise self._not_writable(error) from error
            clean_with(self._remove)
        return self

    def _make(self) -> None:
        for attempt in range(1, _ATTEMPTS + 1):
            self._made = [each for each in (self.folder, *self.folder.parents) if not each.exists()]
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
                self._staging, self._lock = make_temporary_folder(self.folder)
            except FileNotFoundError:
                if attempt == _ATTEMPTS:
                    raise
            else:
                return

    def _not_writable(self, error: OSError) -> InputError:
        return InputError(f"cannot write to the output folder {self.folder}: {error.strerror or error}")

    def path(self, suffix: str) -> Path:
        """Return the path at which to write the file ``STEM.suffix``; it will be published."""
        return self.named(self.name(suffix))

    def named(self, name: str) -> Path:
        """Return the path at which to write a file of any name; it will be published."""
        self._names[name] = None
        return self._staging / name

    def add(self, names: Iterable[str]) -> None:
        """Publish files, too, that another process wrote at their paths."""
        self._names.update(dict.fromkeys(names))

    def staged(self, suffix: str) -> Path:
        """Return the path of the file ``STEM.suffix`` before it is published."""
        return self._staging / f"{self.stem}.{suffix}"

    def name(self, suffix: str) -> str:
        """Return the name ``STEM.suffix``."""
        return f"{self.stem}.{suffix}"

    def of_build(self, number: int, suffix: str) -> str:
        """Return the suffix of a file of build `number`: ``build-2.3mf``, or ``3mf`` if builds are not numbered."""
        return f"build-{number}.{suffix}" if self.numbered else suffix

    def stale_builds(self, count: int) -> list[str]:
        """Return the names of build files with numbers above `count`, from an earlier run; they are not changed."""
        pattern = re.compile(re.escape(self.stem) + r"\.build-(\d+)\.3mf")
        with suppress(OSError):  # the folder may have vanished, which `publish` reports
            matches = [pattern.fullmatch(path.name) for path in self.folder.iterdir()]
            return sorted(match[0] for match in matches if match and int(match[1]) > count)
        return []

    def publish(self) -> None:
        """Move every file to the output folder, where all of them appear or none.

        A rename is atomic, so no file is ever incomplete. Signals wait until the last file is in place. Runs into the
        same folder take turns, so that their files do not mix.

        Raises
        ------
        InputError
            If a file cannot appear; the folder then is as it was.
        """
        raise_lost()
        with taking_turns(self.folder), held():
            for name in self._names:
                if (self.folder / name).is_dir() and not (self.folder / name).is_symlink():
                    raise InputError(
                        f"cannot write {self.folder / name}: a folder has this name; move it away"
                    )
            self._move_all()
            files_appeared()

    def _move_all(self) -> None:
        """Move every file; if one cannot be moved, move all of them and their predecessors back."""
        moved: list[tuple[Path, Path, Path]] = []
        try:
            for name in self._names:
                new, target, old = self._staging / name, self.folder / name, self._staging / f"{name}.old"
                moved.append((new, target, old))
                with suppress(FileNotFoundError):
                    _keep(target, old)
                new.replace(target)
        except OSError as error:
            for new, target, old in reversed(moved):
                with suppress(OSError):
                    _move_back(new, target, old)
            raise self._not_writable(error) from error

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with held():
            clean_with(None)
            self._remove()

    def _remove(self) -> None:
        """Remove the hidden folder and the folders that this run made."""
        shutil.rmtree(self._staging, ignore_errors=True)
        if self._lock is not None:
            os.close(self._lock)
        self._remove_made()

    def _remove_made(self) -> None:
        """Remove the folders that this run made, as far as they are empty."""
        with suppress(OSError):
            for each in self._made:
                each.rmdir()


def _keep(target: Path, old: Path) -> None:
    """Give the file at `target` a second name; where files have one name only, rename it."""
    try:
        os.link(target, old, follow_symlinks=False)
    except FileNotFoundError:
        raise
    except OSError:
        target.rename(old)


def _move_back(new: Path, target: Path, old: Path) -> None:
    """Undo the move of `new` to `target`, whose predecessor is at `old` if there was one."""
    if not new.exists() and target.exists():
        target.rename(new)
    if os.path.lexists(old):
        old.replace(target)
