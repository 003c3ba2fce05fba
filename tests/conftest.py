"""Hypothesis profiles: how many examples property tests try.

The usual one repeats the same examples, 40 where a test asks for 100; ``--hypothesis-profile=full`` repeats all that
tests ask for, and ``--hypothesis-profile=nightly`` explores new ones.
"""

import os
import tempfile
from pathlib import Path

import pytest
from hypothesis import settings

from amprep import supervision

settings.register_profile("usual", deadline=None, derandomize=True, max_examples=40)
settings.register_profile("full", deadline=None, derandomize=True, max_examples=100)
settings.register_profile("nightly", deadline=None, max_examples=2000, print_blob=True)
settings.load_profile("usual")


WITHOUT_COMPILATION = os.environ.get("NUMBA_DISABLE_JIT") == "1"


def pytest_configure(config):
    """Keep the tests from the settings of the developer and from forking, and let hashes wrap around in plain Python.

    numpy warns of that, numba does not.
    """
    supervision.ENABLED = False
    own = str(
        Path(tempfile.gettempdir(), "amprep-tests")
    )  # without the settings and profiles of the developer
    os.environ["XDG_CONFIG_HOME"] = os.environ["APPDATA"] = own
    if WITHOUT_COMPILATION:
        config.addinivalue_line("filterwarnings", "ignore:overflow encountered in scalar:RuntimeWarning")


def pytest_collection_modifyitems(items):
    """Skip tests that would take minutes where kernels run as plain Python."""
    if WITHOUT_COMPILATION:
        for item in items:
            if item.get_closest_marker("compiled"):
                item.add_marker(pytest.mark.skip(reason="too slow without compilation"))
