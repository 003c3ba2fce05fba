"""Atomic file writing, and temporary folders that show whether their process lives."""

import json
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from amprep.errors import AmprepError, InputError

PREFIX = ".amprep-"
_OWNER = re.compile(re.escape(PREFIX) + r"(\d+)-(\d+)-\w+")


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path beside `path`; rename it to `path` at the end, or delete it after an exception.

    Raises
    ------
    AmprepError
        If the folder or the file cannot be written.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield temporary
        temporary.replace(path)
    except OSError as error:
        raise AmprepError(f"cannot write {path}: {error.strerror or error}; choose another folder") from error
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def make_temporary_folder(folder: Path) -> tuple[Path, int | None]:
    """Make a hidden folder inside `folder`; its name holds the number of this process and when it began.

    Returns
    -------
    The path, and a file descriptor that holds a lock on it as long as the process lives; None where locks do not exist.
    """
    pid = os.getpid()
    path = Path(tempfile.mkdtemp(prefix=f"{PREFIX}{pid}-{_began(pid)}-", dir=folder))
    return path, _lock(path)


def remove_abandoned(folder: Path) -> None:
    """Remove the temporary folders inside `folder` whose processes ended without removing them.

    A folder is kept if its process lives, by its number and the time it began, or if someone holds its lock: a number
    says nothing about processes of other machines and containers.
    """
    for path in folder.glob(f"{PREFIX}*"):
        owner = _OWNER.fullmatch(path.name)
        if owner is None or path.is_symlink() or is_running(int(owner[1]), int(owner[2])):
            continue
        lock = _lock(path)
        if lock is not None:
            shutil.rmtree(path, ignore_errors=True)
            os.close(lock)


def is_running(pid: int, began: int) -> bool:
    """Tell whether the process of a number runs that began at a time, as `_began` returns it."""
    if not hasattr(os, "fork"):
        return True  # on Windows nothing tells without ending the process
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return _began(pid) in (began, 0)


def _began(pid: int) -> int:
    """Return when a process began, in clock ticks since the start of the machine; 0 if the system does not say."""
    try:
        text = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
        return int(text.rpartition(")")[2].split()[19])
    except (OSError, ValueError, IndexError):
        return 0


def _lock(path: Path) -> int | None:
    """Return a file descriptor that holds the only lock on a folder; None if another process has it."""
    try:
        import fcntl
    except ImportError:
        return None
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except OSError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        return None
    return descriptor


@contextmanager
def taking_turns(folder: Path) -> Iterator[None]:
    """Let no other process be in such a block for the same folder; where locks do not exist, do nothing."""
    try:
        import fcntl

        descriptor = os.open(folder, os.O_RDONLY)
    except (ImportError, OSError):
        yield
        return
    try:
        with suppress(OSError):  # a file system without locks
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


@contextmanager
def held_alone(path: Path) -> Iterator[bool]:
    """Hold a lock by a file, which exists in the block only, and yield whether no other process holds it.

    The lock ends with the process, however that ends. Where locks do not exist, all processes get it.

    Raises
    ------
    OSError
        If the file cannot be made.
    """
    descriptor, is_alone = _open_locked(path)
    try:
        yield is_alone
    finally:
        if is_alone:
            path.unlink(missing_ok=True)
        os.close(descriptor)


def _open_locked(path: Path) -> tuple[int, bool]:
    """Return a descriptor of a file, and whether its lock is now held; make the file if it does not exist."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
        try:
            import fcntl

            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return descriptor, False
        except (ImportError, OSError):  # a system or a file system without locks
            return descriptor, True
        with suppress(FileNotFoundError):  # whoever held it may have removed it in between
            if os.path.samestat(path.stat(), os.fstat(descriptor)):
                return descriptor, True
        os.close(descriptor)


def read_json(path: Path, what: str, largest: int) -> Any:
    """Return the value in a JSON file of a limited size.

    Parameters
    ----------
    path
        The file.
    what
        What it should be, with its article, for messages.
    largest
        Largest size, bytes.

    Raises
    ------
    InputError
        If it cannot be read, is too large, or is not JSON.
    """
    try:
        if path.stat().st_size > largest:
            raise InputError(f"{path}: expected {what}, but the file is larger than {_size_words(largest)}")
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: expected {what}, but the file is not JSON") from error


def _size_words(size: int) -> str:
    """Return a size in bytes as text."""
    return f"{size >> 20} MiB" if size >= 1 << 20 else f"{size >> 10} KiB"
