"""Load plugins, list their offers, choose an offer by name, and guard every call."""

from amprep.host.chosen import Chosen, choose
from amprep.host.manager import Host
from amprep.host.mismatch import mismatches
from amprep.host.offers import KINDS, Kind, Listed

__all__ = ["KINDS", "Chosen", "Host", "Kind", "Listed", "choose", "mismatches"]
