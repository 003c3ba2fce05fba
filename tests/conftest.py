"""Hypothesis profiles: the usual one repeats the same examples, ``--hypothesis-profile=nightly`` explores new ones."""

import os

from hypothesis import settings

settings.register_profile("usual", deadline=None, derandomize=True, max_examples=100)
settings.register_profile("nightly", deadline=None, max_examples=2000, print_blob=True)
settings.load_profile("usual")


def pytest_configure(config):
    """Let hashes wrap around where kernels run as plain Python: numpy warns of that, numba does not."""
    if os.environ.get("NUMBA_DISABLE_JIT") == "1":
        config.addinivalue_line("filterwarnings", "ignore:overflow encountered in scalar:RuntimeWarning")
