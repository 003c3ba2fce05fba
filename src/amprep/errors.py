"""The errors amprep raises on purpose: one base class, a few named ones, one line each."""

from collections.abc import Iterable
from difflib import get_close_matches


class AmprepError(Exception):
    """A broken contract a person can act on; the command line prints it as one line and exits with 2."""


class InputError(AmprepError):
    """A file could not be read, is not what it claims to be, or exceeds a limit."""


class MeshError(InputError):
    """A mesh is not a solid; the message names the part and the reason."""


class JobError(AmprepError):
    """A job file, printer profile or command-line setting is wrong."""


class PluginError(AmprepError):
    """A plugin could not be loaded, chosen or run; the message names it, its distribution and version."""


class Interrupted(AmprepError):
    """The user stopped the run; the command line exits with 130."""


def nearest_hint(name: str, known: Iterable[str]) -> str:
    """Return `` (did you mean 'x'?)`` for the known name nearest to `name`, or the list of known names."""
    names = sorted(known)
    close = get_close_matches(name, names, n=1)
    if close:
        return f" (did you mean {close[0]!r}?)"
    return f" (known: {', '.join(names)})" if names else ""
