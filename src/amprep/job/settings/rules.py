"""Settings of single overhang regions in a job."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, get_args

from amprep.geometry.overhangs.regions import Kind
from amprep.job.settings.cells import CellSettings
from amprep.job.settings.supports import SupportSettings
from amprep.model.contacts import ConnectorKind, ConnectorRules
from amprep.model.supports.rules import OverhangJudgement
from amprep.overhangs.conditions import RegionConditions
from amprep.validation import require

_CONDITIONS = tuple(each.name for each in fields(RegionConditions))
_OF_THESIS: tuple[Kind, ...] = ("face", "edge", "tip")
_CONNECTOR = tuple(each.name for each in fields(ConnectorRules))


@dataclass(frozen=True)
class RuleSettings(RegionConditions):
    """Settings in a ``[[rule]]`` entry, for the overhang regions that meet its conditions.

    None keeps the setting of the job.

    Attributes
    ----------
    support
        False: the regions get no supports; they are listed, but are no fault.
    cell, params
        Name of the lattice cell or path of a file that declares it, and its parameters.
    pitch_mm
        Horizontal voxel size of the support grid.
    contact_spacing_mm
        Largest distance between neighbouring contacts.
    """

    support: bool = True
    cell: str | None = None
    params: Mapping[str, Any] = field(default_factory=dict)
    pitch_mm: float | None = None
    contact_spacing_mm: float | None = None
    connector: ConnectorKind | None = None
    tooth_pitch_mm: float | None = None
    tooth_width_mm: float | None = None
    tooth_height_mm: float | None = None
    point_pitch_mm: float | None = None
    point_mm: float | None = None
    point_height_mm: float | None = None
    neck_mm: float | None = None
    neck_height_mm: float | None = None
    perforation_mm: float | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        given = [each.name for each in fields(self) if self._sets(each.name)]
        require(
            self.support or given == ["support"],
            "a [[rule]] entry with support = false must have no other settings",
            ", ".join(name for name in given if name != "support"),
        )
        require(bool(given), "a [[rule]] entry must have a setting beside its conditions", "none")

    def require_kinds(self, rules: OverhangJudgement) -> None:
        """Raise `ValueError` if no overhang can be of a kind, or of a size, that the rule asks for.

        With the rules of the thesis overhangs are faces, edges and tips without a size; with limits none is a ``face``.
        """
        thesis = rules == "thesis"
        possible = [kind for kind in get_args(Kind) if (kind in _OF_THESIS if thesis else kind != "face")]
        fits = not self.kinds or any(kind in possible for kind in self.kinds)
        known = ", ".join(repr(kind) for kind in possible)
        require(fits, f"with rules = {rules!r} kind must be one of {known}", ", ".join(map(repr, self.kinds)))
        require(
            not thesis or self.size is None,
            "size must be left out with rules = 'thesis', because overhangs have no size there",
            self.size and list(self.size),
        )

    def cells(self, job: CellSettings) -> CellSettings:
        """Return the cell settings of the job with those of the rule; another cell starts from its own parameters."""
        given = {name: value for name in _CONNECTOR if (value := getattr(self, name)) is not None}
        cell = job.strategy if self.cell is None else self.cell
        params = {**(job.params if cell == job.strategy else {}), **self.params}
        return replace(job, strategy=cell, params=params, **given)

    def supports(self, job: SupportSettings) -> SupportSettings:
        """Return the support settings of the job with those of the rule."""
        names = ("pitch_mm", "contact_spacing_mm")
        given = {name: value for name in names if (value := getattr(self, name)) is not None}
        return replace(job, **given)

    def _sets(self, name: str) -> bool:
        """Tell whether the rule gives a setting that differs from that of the job."""
        value = getattr(self, name)
        return name not in _CONDITIONS and value is not None and value is not True and value != {}
