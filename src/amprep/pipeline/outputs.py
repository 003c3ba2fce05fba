"""The output folder: files are written to a hidden folder inside it and appear together at the end."""

import re
import shutil
import tempfile
from pathlib import Path
from types import TracebackType
from typing import Self

from amprep.errors import InputError


def safe_name(text: str) -> str:
    """Return `text` as a valid file name of letters, digits, dots, dashes, underscores and spaces."""
    kept = re.sub(r"[^\w.\- ]+", "_", text).strip(". ")
    return kept[:100] or "unnamed"


class OutputFolder:
    """Collects the files of a run and publishes them together; after an exception no file appears.

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
        If the folder cannot be created or written.
    """

    def __init__(self, folder: Path, stem: str, *, numbered: bool = True) -> None:
        self.folder, self.stem, self.numbered = folder, safe_name(stem), numbered
        self._names: list[str] = []

    def __enter__(self) -> Self:
        self._made = not self.folder.exists()
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            self._staging = Path(tempfile.mkdtemp(prefix=".amprep-", dir=self.folder))
        except OSError as error:
            raise InputError(f"cannot write to the output folder {self.folder}: {error.strerror}") from error
        return self

    def path(self, suffix: str) -> Path:
        """Return the path at which to write the file ``STEM.suffix``; it will be published."""
        path = self.staged(suffix)
        self._names.append(path.name)
        return path

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
        matches = (pattern.fullmatch(path.name) for path in self.folder.iterdir())
        return sorted(match[0] for match in matches if match and int(match[1]) > count)

    def publish(self) -> None:
        """Move every file to the output folder; a rename is atomic, so no file is ever incomplete."""
        for name in self._names:
            (self._staging / name).replace(self.folder / name)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        shutil.rmtree(self._staging, ignore_errors=True)
        if self._made and not any(self.folder.iterdir()):
            self.folder.rmdir()
