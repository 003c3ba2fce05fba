"""A seal shows every change of its file, and with a key, whether the owner of the key sealed it."""

import json

import pytest

from amprep.errors import InputError
from amprep.sealing.keys import LARGEST_KEY, read_key
from amprep.sealing.seal import check_seal, seal_file, seal_path

serialization = pytest.importorskip("cryptography.hazmat.primitives.serialization")
ed25519 = pytest.importorskip("cryptography.hazmat.primitives.asymmetric.ed25519")


@pytest.fixture
def build(tmp_path):
    path = tmp_path / "a.build-1.3mf"
    path.write_bytes(bytes(range(256)) * 40)
    return path


def secret(folder, name="secret", text="a secret of some length"):
    path = folder / name
    path.write_text(text)
    return path


def pem_pair(folder, name="owner"):
    private = ed25519.Ed25519PrivateKey.generate()
    pem, raw = serialization.Encoding.PEM, serialization.NoEncryption()
    keys = {
        f"{name}.pem": private.private_bytes(pem, serialization.PrivateFormat.PKCS8, raw),
        f"{name}.pub": private.public_key().public_bytes(
            pem, serialization.PublicFormat.SubjectPublicKeyInfo
        ),
    }
    for file, data in keys.items():
        (folder / file).write_bytes(data)
    return [folder / file for file in keys]


@pytest.mark.parametrize("position", [0, 5000, 10239])
@pytest.mark.parametrize("keyed", [False, True])
def test_one_changed_byte_anywhere_breaks_the_seal(build, tmp_path, position, keyed):
    key = secret(tmp_path) if keyed else None
    seal_file(build, key)
    assert check_seal(build, key).fault == ""
    data = bytearray(build.read_bytes())
    data[position] ^= 1
    build.write_bytes(data)
    assert "changed after it was sealed" in check_seal(build, key).fault


def test_a_file_that_was_changed_and_sealed_again_without_the_key_is_found(build, tmp_path):
    private, public = pem_pair(tmp_path)
    seal_file(build, private)
    assert check_seal(build, public) == check_seal(build, private)
    assert check_seal(build, public).fault == ""
    build.write_bytes(b"other")
    code = json.loads(seal_path(build).read_text(encoding="utf-8"))["code"]
    seal_file(build, None)
    assert "sealed with sha256, expected ed25519" in check_seal(build, public).fault
    record = json.loads(seal_path(build).read_text(encoding="utf-8")) | {"method": "ed25519", "code": code}
    seal_path(build).write_text(json.dumps(record))
    assert "another key" in check_seal(build, public).fault


def test_another_key_of_the_same_kind_does_not_pass(build, tmp_path):
    seal_file(build, pem_pair(tmp_path)[0])
    assert "another key" in check_seal(build, pem_pair(tmp_path, "other")[1]).fault
    seal_file(build, secret(tmp_path))
    assert "another key" in check_seal(build, secret(tmp_path, "s2", "another secret, as long")).fault


def test_a_missing_seal_is_a_fault_only_where_a_key_asks_for_one(build, tmp_path):
    assert check_seal(build, None) == ("", "")
    assert "expected the seal a.build-1.3mf.seal" in check_seal(build, secret(tmp_path)).fault


def test_the_same_file_and_key_give_the_same_seal(build, tmp_path):
    private, _ = pem_pair(tmp_path)
    first = seal_file(build, private)[0].read_bytes()
    assert seal_file(build, private)[0].read_bytes() == first


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"short", "at least 16 bytes"),
        (b"x" * (LARGEST_KEY + 1), "at most"),
        (b"-----BEGIN PRIVATE KEY-----\nAAAA\n-----END PRIVATE KEY-----\n", "expected an Ed25519 key"),
        (b"-----BEGIN NOTHING-----", "expected an Ed25519 key"),
    ],
)
def test_what_is_no_key_is_refused_in_one_line(tmp_path, data, words):
    path = tmp_path / "key"
    path.write_bytes(data)
    with pytest.raises(InputError, match=words) as caught:
        read_key(path)
    assert "\n" not in str(caught.value)


def test_a_public_key_cannot_seal(build, tmp_path):
    with pytest.raises(InputError, match="public key cannot seal"):
        seal_file(build, pem_pair(tmp_path)[1])
    assert not seal_path(build).exists()


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"format": "amprep seal 1"}', "[" * 4000, '{"a": 1}', "x" * 5000, "\x00"]
)
def test_a_damaged_seal_is_refused_in_one_line(build, text):
    seal_path(build).write_text(text)
    with pytest.raises(InputError, match=r"not a seal|expected a seal"):
        check_seal(build, None)


def test_a_code_that_is_no_number_is_a_fault(build, tmp_path):
    key = secret(tmp_path)
    path, _ = seal_file(build, key)
    path.write_text(
        json.dumps(json.loads(path.read_text(encoding="utf-8")) | {"code": "no hexadecimal digits"})
    )
    assert "damaged" in check_seal(build, key).fault
