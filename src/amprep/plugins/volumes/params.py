"""Parameters of the built-in volume makers."""

from dataclasses import dataclass

from amprep.validation import require, require_bounds


@dataclass(frozen=True)
class TwoBoxesParams:
    """Parameters of `boxes-two`.

    Attributes
    ----------
    objective
        ``union``: least volume of the union of both boxes; ``larger``: least volume of the larger box.
    planes
        Greatest number of planes along each axis at which a face of a box is tried before the best places are
        refined. Sets with no more distinct coordinates than this are solved exactly.
    """

    objective: str = "union"
    planes: int = 48

    def __post_init__(self) -> None:
        known = self.objective in {"union", "larger"}
        require(known, "objective must be union or larger", repr(self.objective))
        require_bounds(self, "planes", at_least=2, at_most=256)
