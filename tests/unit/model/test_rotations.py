"""The words for allowed rotations."""

import json

import numpy as np
import pytest

from amprep.errors import JobError
from amprep.model.rotations import axis_rotations, parse_rotations


def test_none_is_the_identity_alone():
    assert np.array_equal(parse_rotations("none").matrices, np.eye(3)[None])


def test_z90_leaves_z_alone_and_turns_x_to_y():
    matrices = parse_rotations("z90").matrices
    assert len(matrices) == 4
    assert np.array_equal(matrices[0], np.eye(3))
    assert np.array_equal(matrices[1] @ [1, 0, 0], [0, 1, 0])
    assert (matrices[:, 2, 2] == 1).all()


def test_axis_gives_the_24_different_rotations_of_a_cube():
    matrices = axis_rotations()
    assert len({tuple(m.ravel()) for m in matrices}) == 24
    assert np.allclose(np.linalg.det(matrices), 1)
    assert np.array_equal(matrices[0], np.eye(3))


def test_each_axis_named_may_point_up_and_is_turned_by_quarters():
    for word, axes in (("up-z", "z"), ("up-xz", "zx"), ("UP-xyz", "zyx")):
        matrices = parse_rotations(word).matrices
        assert ["xyz"[np.argmax(m[2])] for m in matrices[::4]] == list(axes)
        assert len({tuple(m.ravel()) for m in matrices}) == 4 * len(axes)
        assert (matrices[:, 2].max(axis=1) == 1).all()
    assert np.array_equal(parse_rotations("up-z").matrices, parse_rotations("z90").matrices)
    with pytest.raises(JobError, match="up-xz"):
        parse_rotations("up-w")


def angles_of(word):
    matrices = parse_rotations(word).matrices
    assert np.allclose(matrices @ matrices.transpose(0, 2, 1), np.eye(3), atol=1e-15)
    assert (matrices[:, 2] == [0, 0, 1]).all()
    return np.degrees(np.arctan2(matrices[:, 1, 0], matrices[:, 0, 0])).round(9) % 360


def test_a_step_about_z_gives_its_multiples_and_exact_quarter_turns():
    assert angles_of("z15").tolist() == list(range(0, 360, 15))
    assert angles_of("Z22.5").tolist() == [22.5 * k for k in range(16)]
    assert np.array_equal(parse_rotations("z30").matrices[::3], parse_rotations("z90").matrices)
    assert np.array_equal(parse_rotations("z360").matrices, np.eye(3)[None])


def test_turns_in_forbidden_bands_are_left_out_with_the_ends_of_the_bands():
    assert angles_of("z30 except 30-60, 200-220").tolist() == [0, 90, 120, 150, 180, 240, 270, 300, 330]
    assert angles_of("z45 except 300-45").tolist() == [90, 135, 180, 225, 270]
    assert angles_of("z45 except 360-360").tolist() == list(range(45, 360, 45))
    assert angles_of("z1 except 0.5-359.5").tolist() == [0]


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("z0", "between 1 and 360"),
        ("z0.5", "between 1 and 360"),
        ("z15 except", "expected one of"),
        ("z15 except 30", "expected one of"),
        ("z15 except 30-60,", "expected one of"),
        ("z15 except 30-400", "between 0 and 360"),
        ("z90 except 0-360", "no turn"),
        ("z90 except 350-300", "no turn"),
    ],
)
def test_a_step_or_band_that_makes_no_sense_is_refused(word, said):
    with pytest.raises(JobError, match=said):
        parse_rotations(word)


@pytest.mark.parametrize("word", ["about-z", "free"])
def test_continuous_freedoms_have_their_own_word(word):
    assert parse_rotations(word).freedom == word


def test_matrices_come_as_a_list_or_as_json():
    listed = axis_rotations()[[0, 7]].tolist()
    assert np.array_equal(parse_rotations(listed).matrices, parse_rotations(json.dumps(listed)).matrices)


def test_a_rounded_matrix_becomes_a_true_rotation():
    r = 0.7071
    (matrix,) = parse_rotations([[[r, -r, 0], [r, r, 0], [0, 0, 1]]]).matrices
    assert np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-15)


@pytest.mark.parametrize(
    "words",
    [
        "zz90",
        "",
        "[[",
        "[]",
        [],
        [[1, 2]],
        "[[[1,0,0],[0,1,0],[0,0,-1]]]",
        [[[2, 0, 0], [0, 2, 0], [0, 0, 2]]],
        "[null]",
        [["x"]],
        [[[float("nan")] * 3] * 3],
        "[" * 100_000,
    ],
)
def test_anything_else_is_refused_in_one_line(words):
    with pytest.raises(JobError) as caught:
        parse_rotations(words)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400
