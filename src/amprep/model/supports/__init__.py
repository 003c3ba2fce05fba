"""Records of support planning: the problem on the layered grid, the edges, the plan, and the rules."""

from amprep.model.supports.edges import DIRECTIONS, SupportEdges
from amprep.model.supports.problem import (
    CAPACITY,
    CONNECTOR_BLOCKED,
    ENCLOSED,
    EXCEPTED,
    LARGEST_COST,
    NO_FREE_VOXEL_BELOW,
    OUT_OF_TIME,
    REASONS,
    ROUTER_REASONS,
    SLENDER,
    TERRITORY,
    Escalation,
    Status,
    SupportPlan,
    SupportProblem,
    Unconnected,
    Voxel,
)
from amprep.model.supports.rules import Grounding, SupportRules

__all__ = [
    "CAPACITY",
    "CONNECTOR_BLOCKED",
    "DIRECTIONS",
    "ENCLOSED",
    "EXCEPTED",
    "LARGEST_COST",
    "NO_FREE_VOXEL_BELOW",
    "OUT_OF_TIME",
    "REASONS",
    "ROUTER_REASONS",
    "SLENDER",
    "TERRITORY",
    "Escalation",
    "Grounding",
    "Status",
    "SupportEdges",
    "SupportPlan",
    "SupportProblem",
    "SupportRules",
    "Unconnected",
    "Voxel",
]
