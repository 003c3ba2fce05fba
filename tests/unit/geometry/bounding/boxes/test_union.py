import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from tests.shared.coverings import boxes_volume
from tests.shared.examples import examples

from amprep.geometry.bounding.boxes.union import union_volume, union_volumes


@given(boxes=arrays(float, (4, 6), elements=st.integers(0, 6).map(float)))
@examples(100)
def test_the_volume_of_a_union_follows_from_inclusion_and_exclusion(boxes):
    assert union_volume(boxes) == pytest.approx(boxes_volume(boxes))
    assert union_volumes(boxes[None]) == pytest.approx([boxes_volume(boxes)])
