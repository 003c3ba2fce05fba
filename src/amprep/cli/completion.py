"""Names that a shell completes: of printers, materials, packers, routers and lattice cells."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from amprep.host.offers import Kind


def printers(incomplete: str) -> list[str]:
    """Return the names of printers that begin so, in lower case with dashes, as a shell takes them without quotes."""
    from amprep.printers.catalogue import list_printers

    return _matching((each.name for each in list_printers()[0]), incomplete)


def materials(incomplete: str) -> list[str]:
    """Return the names of materials that begin so."""
    from amprep.materials.catalogue import list_materials

    return _matching((each.name for each in list_materials()[0]), incomplete)


def packers(incomplete: str) -> list[str]:
    """Return the names of packers that begin so."""
    return _offers("packer", incomplete)


def routers(incomplete: str) -> list[str]:
    """Return the names of support routers that begin so."""
    return _offers("router", incomplete)


def cells(incomplete: str) -> list[str]:
    """Return the names of lattice cells that begin so."""
    return _offers("cell", incomplete)


def _offers(kind: "Kind", incomplete: str) -> list[str]:
    from amprep.host import Host

    return _matching(Host.load().offers(kind), incomplete)


def _matching(names: "Iterable[str]", incomplete: str) -> list[str]:
    from amprep.profiles import normalised

    wanted = normalised(incomplete)
    return sorted(name.lower().replace(" ", "-") for name in names if normalised(name).startswith(wanted))
