"""Keys of seals: a shared secret, or a pair of Ed25519 keys in PEM files."""

import hmac
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from amprep.errors import InputError

LARGEST_KEY = 64 * 1024
"""Largest key file, bytes."""

LEAST_SECRET = 16
"""Least length of a shared secret, bytes."""

SECRET, SIGNATURE = "hmac-sha256", "ed25519"
"""Methods of seals with a key: HMAC (RFC 2104) with SHA-256, and Ed25519 signatures (RFC 8032)."""


class Key(NamedTuple):
    """A key that was read from a file.

    Attributes
    ----------
    method
        `SECRET` or `SIGNATURE`.
    sign
        Makes the code of a message; None for a public key.
    holds
        Tells whether a code belongs to a message.
    """

    method: str
    sign: Callable[[bytes], bytes] | None
    holds: Callable[[bytes, bytes], bool]


def read_key(path: Path) -> Key:
    """Read a key: an Ed25519 private or public key in PEM form, or any other file as a shared secret.

    Raises
    ------
    InputError
        If the file cannot be read, is too large or too short, or holds another kind of key; and for a PEM file if the
        package cryptography is not installed.
    """
    try:
        if path.stat().st_size > LARGEST_KEY:
            raise InputError(f"{path}: a key file must have at most {LARGEST_KEY} bytes")
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot read the key: {error.strerror or error}") from error
    if data.lstrip().startswith(b"-----BEGIN"):
        return _pem_key(data, path)
    secret = data.strip()
    if len(secret) < LEAST_SECRET:
        raise InputError(f"{path}: a secret must have at least {LEAST_SECRET} bytes, got {len(secret)}")
    return _secret_key(secret)


def _secret_key(secret: bytes) -> Key:
    def sign(message: bytes) -> bytes:
        return hmac.digest(secret, message, "sha256")

    return Key(SECRET, sign, lambda message, code: hmac.compare_digest(sign(message), code))


def _pem_key(data: bytes, path: Path) -> Key:
    try:
        from cryptography.exceptions import InvalidSignature, UnsupportedAlgorithm
        from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey
        from cryptography.hazmat.primitives.serialization import load_pem_private_key, load_pem_public_key
    except ImportError as error:
        raise InputError(f"{path}: PEM keys need one more package: pip install 'amprep[seal]'") from error
    try:
        is_public = b"PUBLIC KEY" in data[:80]
        key = load_pem_public_key(data) if is_public else load_pem_private_key(data, password=None)
    except (ValueError, TypeError, UnsupportedAlgorithm) as error:
        raise InputError(
            f"{path}: expected an Ed25519 key in PEM form without a password, got something else"
        ) from error
    if not isinstance(key, Ed25519PrivateKey | Ed25519PublicKey):
        raise InputError(f"{path}: expected an Ed25519 key, got another kind of key")
    public = key.public_key() if isinstance(key, Ed25519PrivateKey) else key

    def holds(message: bytes, code: bytes) -> bool:
        try:
            public.verify(code, message)
        except InvalidSignature:
            return False
        return True

    return Key(SIGNATURE, key.sign if isinstance(key, Ed25519PrivateKey) else None, holds)
