"""The plugin host: loads plugins, lists their offers, chooses by name, guards every call."""

from amprep.host.manager import Host
from amprep.host.mismatch import fits
from amprep.host.offers import KINDS, Kind, Listed

__all__ = ["KINDS", "Host", "Kind", "Listed", "fits"]
