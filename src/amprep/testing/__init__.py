"""Kit for plugin authors: run an offer, check its promises on sample problems, and build small test problems."""

from amprep.checks.violation import Violation
from amprep.testing.cells import check_cell
from amprep.testing.conformance import OfferReport, try_offer, try_plugin
from amprep.testing.offers import LoadedOffer, load_offer
from amprep.testing.problems import box_mesh, packing_problems, sample_parts, support_problems

__all__ = [
    "LoadedOffer",
    "OfferReport",
    "Violation",
    "box_mesh",
    "check_cell",
    "load_offer",
    "packing_problems",
    "sample_parts",
    "support_problems",
    "try_offer",
    "try_plugin",
]
