"""Which parts and supports must stay together: a support ties all parts that it holds."""

from dataclasses import dataclass

from amprep.errors import AmprepError
from amprep.model.build import Build


@dataclass(frozen=True)
class Group:
    """Indices of the placed parts and of the supports that hold them, each ascending."""

    parts: tuple[int, ...]
    supports: tuple[int, ...]


def groups_of(build: Build) -> list[Group]:
    """Return every part in exactly one group, the groups in the order of their first parts.

    Raises
    ------
    AmprepError
        If a support holds no part, or one that is not in the build.
    """
    leader = list(range(len(build.parts)))
    for support in build.supports:
        held = set(support.parts)
        if not held or not held <= set(range(len(leader))):
            raise AmprepError(
                f"support {support.name!r} must hold parts of its build, it holds {support.parts}"
            )
        joined = {leader[part] for part in held}
        leader = [min(joined) if first in joined else first for first in leader]
    return [
        Group(
            tuple(part for part, first in enumerate(leader) if first == head),
            tuple(i for i, support in enumerate(build.supports) if leader[support.parts[0]] == head),
        )
        for head in sorted(set(leader))
    ]
