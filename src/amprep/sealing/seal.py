"""Seal build files, and check seals."""

import hashlib
import json
from pathlib import Path
from typing import NamedTuple

from amprep.errors import InputError
from amprep.files import read_json, replacing
from amprep.sealing.keys import Key, read_key

FORMAT = "amprep seal 1"
"""Form of a seal; it is part of what is signed."""

PLAIN = "sha256"
"""Method of a seal without a key."""

_LARGEST_SEAL = 4096
"""Largest seal, bytes."""

# Strategy. A seal covers every byte of the file, so no tool can change the file unnoticed, whatever it changes. It is
# a file of its own, because a seal inside the file would have to leave itself out. Without a key it shows accidental
# changes only: whoever changes the file can seal it again.


class CheckedSeal(NamedTuple):
    """What a seal shows.

    Attributes
    ----------
    words
        What was checked, for the user: ``sealed with ed25519, checked with the key``; empty without a seal.
    fault
        What is wrong, or empty.
    """

    words: str
    fault: str


def seal_path(file: Path) -> Path:
    """Return the path of the seal of a file: beside it, with ``.seal`` added to its name."""
    return file.with_name(f"{file.name}.seal")


def file_digest(file: Path) -> str:
    """Return the SHA-256 of the bytes of a file.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    try:
        with file.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror or error}") from error


def seal_file(file: Path, key_file: Path | None) -> tuple[Path, str]:
    """Write the seal of a file; return its path and its method.

    Parameters
    ----------
    file
        The file, of any kind.
    key_file
        An Ed25519 private key in PEM form, or a file with a secret; None for a seal that shows accidental changes.

    Raises
    ------
    InputError
        If the file or the key cannot be read, or the key is a public one.
    AmprepError
        If the seal cannot be written.
    """
    key = None if key_file is None else read_key(key_file)
    if key is not None and key.sign is None:
        raise InputError(f"{key_file}: a public key cannot seal; give the private key")
    digest = file_digest(file)
    record = {"format": FORMAT, "sha256": digest, "method": PLAIN if key is None else key.method}
    if key is not None and key.sign is not None:
        record["code"] = key.sign(_message(digest)).hex()
    path = seal_path(file)
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    return path, record["method"]


def check_seal(file: Path, key_file: Path | None) -> CheckedSeal:
    """Check the seal of a file, which is beside it.

    A file without a seal has a fault only if a key is given.

    Parameters
    ----------
    file
        The file.
    key_file
        The secret, or the Ed25519 private or public key; None checks the digest alone.

    Raises
    ------
    InputError
        If the file, its seal or the key cannot be read.
    """
    key, path = None if key_file is None else read_key(key_file), seal_path(file)
    if not path.exists():
        return CheckedSeal("", "" if key is None else f"expected the seal {path.name} beside the file")
    record = _read_seal(path)
    if record["sha256"] != file_digest(file):
        return CheckedSeal("sealed", "the file was changed after it was sealed")
    if key is None:
        return CheckedSeal(f"sealed with {record['method']}, checked without a key", "")
    words = f"sealed with {record['method']}, checked with the key"
    return CheckedSeal(words, _code_fault(record, key))


def _code_fault(record: dict[str, str], key: Key) -> str:
    """Return what is wrong with the code of a seal whose digest is right."""
    if record["method"] != key.method:
        return f"it is sealed with {record['method']}, expected {key.method} by the key"
    try:
        code = bytes.fromhex(record.get("code", ""))
    except ValueError:
        return "the code of the seal is damaged"
    return "" if key.holds(_message(record["sha256"]), code) else "it was sealed with another key"


def _message(digest: str) -> bytes:
    return f"{FORMAT}\n{digest}\n".encode()


def _read_seal(path: Path) -> dict[str, str]:
    """Return a seal, whose values are all text.

    Raises
    ------
    InputError
        If it cannot be read or is not a seal.
    """
    record = read_json(path, "a seal", _LARGEST_SEAL)
    known = isinstance(record, dict) and all(isinstance(each, str) for each in record.values())
    if not known or record.get("format") != FORMAT or not {"sha256", "method"} <= record.keys():
        raise InputError(f"{path}: not a seal of this version of amprep")
    return dict(record)
