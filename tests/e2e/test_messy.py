"""A run of a messy STL file makes supports or states a reason, without a traceback."""

import numpy as np
import pytest
import trimesh

BINARY_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def box(size=10.0, corner=(0.0, 0.0, 0.0)):
    mesh = trimesh.creation.box(extents=(size, size, size))
    return mesh.triangles + np.array(corner) + size / 2


def ball(radius=8.0, subdivisions=2):
    return trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius).triangles


def shells(count, size, apart):
    places = apart * np.stack(np.meshgrid(*[np.arange(count)] * 3), axis=-1).reshape(-1, 3)
    return np.concatenate([box(size, place) for place in places])


def random(seed):
    return np.random.default_rng(seed)


def two_cubes_on_an_edge():
    return np.concatenate([box(), box(corner=(10, 10, 0))])


def two_cubes_on_a_face():
    return np.concatenate([box(), box(corner=(10, 0, 0))])


def two_cubes_on_a_corner():
    return np.concatenate([box(), box(corner=(10, 10, 10))])


def with_a_fin():
    return np.concatenate([box(), [[[0, 0, 10], [10, 0, 10], [5, 0, 20]]]])


def with_nan():
    soup = ball().copy()
    soup[17, 1, 2] = np.nan
    return soup


def with_infinity():
    soup = ball().copy()
    soup[3, 0, 0] = np.inf
    return soup


def with_zero_area():
    corner = ball()[:40, :1].repeat(3, axis=1)
    line = np.stack([corner[:, 0], corner[:, 0] + 1, corner[:, 0] + 2], axis=1)
    return np.concatenate([ball(), corner, line])


def noisy_seams():
    return ball() + random(1).normal(0, 1e-5, ball().shape)


def half_flipped():
    soup = ball().copy()
    soup[::2] = soup[::2, ::-1]
    return soup


def self_intersecting():
    from scipy.spatial.transform import Rotation

    turned = [box() @ Rotation.from_rotvec([0, 0.4 * i, 0.3 * i]).as_matrix() for i in range(5)]
    return np.concatenate(turned)


def klein_like():
    """A torus of which a third is inside out."""
    soup = trimesh.creation.torus(10, 3, major_sections=24, minor_sections=12).triangles.copy()
    soup[: len(soup) // 3] = soup[: len(soup) // 3, ::-1]
    return soup


def hollow():
    return np.concatenate([ball(9.0), ball(7.0)[:, ::-1], ball(3.0)])


def flat():
    return box() * (1, 1, 0)


SOUPS = {
    "sound": ball,
    "open": lambda: ball()[10:],
    "one-triangle": lambda: ball()[:1],
    "flipped": lambda: ball()[:, ::-1],
    "half-flipped": half_flipped,
    "every-triangle-twice": lambda: np.concatenate([ball(), ball()]),
    "every-triangle-twice-both-ways": lambda: np.concatenate([ball(), ball()[:, ::-1]]),
    "cubes-on-an-edge": two_cubes_on_an_edge,
    "cubes-on-a-face": two_cubes_on_a_face,
    "cubes-on-a-corner": two_cubes_on_a_corner,
    "fin": with_a_fin,
    "nan": with_nan,
    "infinity": with_infinity,
    "zero-area": with_zero_area,
    "noisy-seams": noisy_seams,
    "self-intersecting": self_intersecting,
    "turning-inside-out": klein_like,
    "hollow-with-a-core": hollow,
    "flat": flat,
    "tiny": lambda: ball() * 1e-6,
    "huge": lambda: ball() * 1e6,
    "beyond-float": lambda: ball() * 1e30,
    "far-away": lambda: ball() + 1e7,
    "needles": lambda: ball() * (1e-3, 1.0, 1.0),
    "hundreds-of-shells": lambda: shells(6, 1.0, 1.5),
    "touching-shells": lambda: shells(4, 1.0, 1.0),
    "nothing": lambda: np.empty((0, 3, 3)),
    "random": lambda: random(2).uniform(0, 20, (60, 3, 3)),
}


def write_binary(path, soup):
    records = np.zeros(len(soup), BINARY_TRIANGLE)
    with np.errstate(over="ignore"):
        records["corners"] = soup
    path.write_bytes(b"messy".ljust(80) + np.uint32(len(soup)).tobytes() + records.tobytes())


def judge(outcome):
    """Check that a run was verified, or ended with an error of one line."""
    assert outcome.code in (0, 1, 2)
    assert "Traceback" not in outcome.err
    assert "internal error" not in outcome.err
    if outcome.code == 2:
        assert len(outcome.err.strip().splitlines()[-1]) > len("amprep: ")
        return
    (build,) = outcome.json["builds"]
    assert build["violations"] == []
    assert all(region["reason"] for region in build["supports"]["unsupported"])


@pytest.mark.parametrize("name", SOUPS)
def test_messy_meshes_get_supports_or_a_reason(amprep, tmp_path, name):
    path = tmp_path / f"{name}.stl"
    write_binary(path, SOUPS[name]())
    cheap = ["--cell", "prism", "--set", "supports.pitch_mm=1", "--dry-run", "--json", "-q"]
    judge(amprep("support", path, "--center", *cheap))
    judge(amprep("run", path, "--allow-surface", *cheap))


@pytest.mark.parametrize("name", ["sound", "flipped", "cubes-on-a-face", "noisy-seams"])
def test_meshes_with_repairable_defects_are_repaired_and_supported(amprep, tmp_path, name):
    path = tmp_path / f"{name}.stl"
    write_binary(path, SOUPS[name]())
    outcome = amprep("support", path, "--center", "--cell", "prism", "--dry-run", "--json", "-q")
    assert outcome.code == 0


FILES = {
    "empty": b"",
    "text": b"This is a shopping list, not a mesh.\n" * 9,
    "solid-and-nothing": b"solid nothing\nendsolid nothing\n",
    "cut-off-text": b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0",
    "words-for-numbers": b"solid x\nfacet normal 0 0 1\nouter loop\n"
    + b"vertex one two three\n" * 3
    + b"endloop\nendfacet\n",
    "a-million-triangles-promised": b"x".ljust(80) + np.uint32(1_000_000).tobytes() + bytes(50),
    "zeros": bytes(4096),
    "ones": b"\xff" * 4096,
    "picture": b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 4,
}


@pytest.mark.parametrize("name", FILES)
def test_files_that_are_not_stl_are_refused_in_one_line(amprep, tmp_path, name):
    path = tmp_path / f"{name}.stl"
    path.write_bytes(FILES[name])
    outcome = amprep("support", path, "--dry-run", "--json", "-q")
    assert outcome.code == 2
    judge(outcome)
