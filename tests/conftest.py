"""Property tests try the same examples every time; ``--hypothesis-profile=explore`` tries new ones."""

from hypothesis import settings

settings.register_profile("explore", deadline=None)
settings.register_profile("same", deadline=None, derandomize=True)
settings.load_profile("same")
