"""Rules of the 3MF specification, one file per chapter: what a package breaks, and whether that may touch its parts."""

from collections.abc import Mapping

from amprep.threemf.rules.broken import BrokenRule, BrokenRules
from amprep.threemf.rules.model_parts import check_model_parts
from amprep.threemf.rules.opc import check_package

__all__ = ["BrokenRule", "find_broken_rules"]


def find_broken_rules(entries: Mapping[str, bytes]) -> tuple[BrokenRule, ...]:
    """Return the rules that a package breaks, those that may touch its parts first.

    The work and the memory are proportional to the size of the package. Equal findings are counted, not listed.

    Parameters
    ----------
    entries
        Name -> contents of each entry of a package that has been scanned: its XML is well-formed and has no document
        type definition.
    """
    found = BrokenRules()
    start = check_package(entries, found)
    check_model_parts(entries, start, found)
    return found.listed()
