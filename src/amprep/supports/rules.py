"""How the supports of a build are to be planned: the job's wishes, in the planner's units."""

from dataclasses import dataclass
from typing import Literal

from amprep.model.build import Grounding
from amprep.model.supports import Escalation
from amprep.supports.grid.sizing import MEMORY_MB
from amprep.supports.routes.network import Rules


@dataclass(frozen=True)
class Wishes:
    """What `amprep.supports.plan.plan_supports` goes by; lengths in mm, areas in mm2.

    Attributes
    ----------
    pitch
        None chooses one by `choose_pitch`.
    gap
        Least distance between supports and parts sideways; 0 for none.
    grounding
        ``plate``, or ``anywhere``: what finds no way to the plate may stand on the part it belongs to.
    memory_mb
        What the grid may take.
    edge_capacity, node_capacity, costs, material, escalation
        As in `amprep.model.supports.SupportProblem`.
    load_area, load_height
        Overhang on one edge, and height up to which that holds (`Rules`); 0 for no limit.
    least_area, least_length
        What is smaller needs no support, unless the part would start in the air there.
    share_between_parts
        ``avoid``: part by part, sharing only where a red square would otherwise stay unconnected; ``allow``:
        one network.
    slender
        Columns higher than so many times their width are joined to others; None joins none.
    """

    overhang_angle_deg: float = 45.0
    strut_angle_deg: float = 45.0
    pitch: float | None = None
    gap: float = 0.0
    grounding: Grounding = "plate"
    memory_mb: int = MEMORY_MB
    edge_capacity: int = 0
    node_capacity: int = 0
    costs: tuple[int, int] = (1, 2)
    material: tuple[float, float] = (1.0, 1.0)
    escalation: Escalation = "none"
    load_area: float = 0.0
    load_height: float = 0.0
    least_area: float = 0.5
    least_length: float = 0.5
    share_between_parts: Literal["avoid", "allow"] = "avoid"
    slender: float | None = None

    @property
    def rules(self) -> Rules:
        """What holds for every network."""
        return Rules(
            self.edge_capacity,
            self.node_capacity,
            self.costs,
            self.material,
            self.escalation,
            self.load_area,
            self.load_height,
        )
