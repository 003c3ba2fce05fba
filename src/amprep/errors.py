"""Errors that amprep raises: one base class, and one class for each cause. Every message is one line."""

from collections.abc import Iterable
from difflib import get_close_matches


class AmprepError(Exception):
    """Base class of all errors of amprep; the command line prints the message and exits with code 2."""


class InputError(AmprepError):
    """A file cannot be read, has the wrong format, or exceeds a limit."""


class MeshError(InputError):
    """A mesh is not a solid; the message names the part and the reason."""


class JobError(AmprepError):
    """A job file, printer profile or command-line setting is wrong."""


class PluginError(AmprepError):
    """A plugin cannot be loaded, chosen or run; the message names the plugin, its distribution and its version."""


class Interrupted(AmprepError):
    """The user interrupted the run; the command line exits with code 130."""


def nearest_hint(name: str, known: Iterable[str]) -> str:
    """Return `` (did you mean 'x'?)`` with the most similar known name, or the list of known names."""
    names = sorted(known)
    close = get_close_matches(name, names, n=1)
    if close:
        return f" (did you mean {close[0]!r}?)"
    return f" (known: {', '.join(names)})" if names else ""
