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
