"""Ten thousand mutated inputs a night; a finding becomes a small test beside the code that it concerns.

python -m pytest -m nightly tests/nightly
"""

import pytest
from tests.nightly.fuzz import fuzz, warm_up
from tests.nightly.mutations import KINDS

CASES, BLOCKS = 1700, 4


@pytest.fixture(scope="module")
def build_file():
    return warm_up()


@pytest.mark.nightly
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
@pytest.mark.parametrize("block", range(BLOCKS))
@pytest.mark.parametrize("kind", KINDS)
def test_no_input_does_what_no_input_may_do(kind, block, build_file):
    """The message lists kind and seed of each case; `python -m tests.nightly.fuzz` repeats it."""
    size = CASES // BLOCKS
    assert fuzz(kind, block * size, size, build_file) == []
