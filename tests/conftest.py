"""Hypothesis profiles: the usual one repeats the same examples, ``--hypothesis-profile=nightly`` explores new ones."""

from hypothesis import settings

settings.register_profile("usual", deadline=None, derandomize=True, max_examples=100)
settings.register_profile("nightly", deadline=None, max_examples=2000, print_blob=True)
settings.load_profile("usual")
