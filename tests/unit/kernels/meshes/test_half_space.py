"""Convex polygons are clipped to half-spaces."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.kernels import plain

from amprep.kernels.meshes.half_space import clip_to_half_space


def clip(corners: np.ndarray, axis: int, bound: float, sign: float) -> np.ndarray:
    """The clipped polygon ``(k, 3)``."""
    target = np.empty((len(corners) + 1, 3))
    kept = plain(clip_to_half_space)(corners, len(corners), axis, bound, sign, target)
    return target[:kept]


def area(corners: np.ndarray) -> float:
    """Area of a convex polygon."""
    if len(corners) < 3:
        return 0.0
    spokes = corners[1:] - corners[0]
    return float(np.linalg.norm(np.cross(spokes[:-1], spokes[1:]), axis=1).sum() / 2)


@given(
    st.lists(st.tuples(*[st.floats(-5, 5, width=32)] * 3), min_size=3, max_size=3),
    st.integers(0, 2),
    st.floats(-6, 6, width=32),
)
def test_both_sides_of_a_plane_together_are_the_polygon(
    corners: list[tuple[float, float, float]], axis: int, bound: float
) -> None:
    triangle = np.array(corners, np.float64)
    above, below = clip(triangle, axis, bound, 1.0), clip(triangle, axis, bound, -1.0)
    assert np.all(above[:, axis] >= bound)
    assert np.all(below[:, axis] <= bound)
    assert abs(area(above) + area(below) - area(triangle)) < 1e-9 or np.all(triangle[:, axis] == bound)


def test_a_square_cut_through_its_middle_keeps_four_corners() -> None:
    square = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]])
    assert clip(square, 0, 1.0, 1.0).tolist() == [[1.0, 0, 0], [2, 0, 0], [2, 2, 0], [1, 2, 0]]
    assert len(clip(square, 0, 3.0, 1.0)) == 0
