"""Every packer on offer, with budgets of work that are small enough for many problems."""

from typing import Any

import numpy as np

from amprep.host import Host
from amprep.model import Stop, silent

HOST = Host.load()
PACKERS = sorted(HOST.offers("packer"))

BUDGETS: dict[str, dict[str, Any]] = {
    "annealing": {"moves": 50},
    "auto": {"work": 20.0},
    "block-building": {"work": 20.0},
    "ip": {"effort": 0.005},
    "ip-local-search": {"effort": 0.002, "steps": 4},
    "column-generation": {"effort": 0.001, "proof": 20.0},
    "plates": {"work": 20.0, "failures": 3},
    "separation": {"work": 5.0},
}
"""Smaller budgets for packers that solve programs or search long: no promise depends on them."""


def accepted_by(packer):
    """What a packer accepts."""
    return HOST.choose("packer", packer).offer.accepts


def packed_by(packer, problem, stop=None):
    """The packing of a packer with its small budget."""
    listed = HOST.choose("packer", packer)
    params, rng = HOST.params(listed, BUDGETS.get(packer, {})), np.random.default_rng(1)
    return HOST.call(listed, problem, params=params, rng=rng, stop=stop or Stop(), progress=silent)
