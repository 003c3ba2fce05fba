"""The number of examples of a property test, scaled by the chosen hypothesis profile."""

from hypothesis import HealthCheck, settings
from tests.shared.optional import present

FULL = 100
"""Examples of a test that does not say how many it needs, in the full profile."""


def examples(number: int, *, suppress: tuple[HealthCheck, ...] = ()) -> settings:
    """Try `number` examples in the full profile, fewer in the usual one and more in the nightly one.

    A number below 100 says that an example is expensive, one above 100 that a fault would be rare.
    """
    profile = present(settings.default)
    return settings(
        max_examples=max(1, number * profile.max_examples // FULL), suppress_health_check=suppress
    )
