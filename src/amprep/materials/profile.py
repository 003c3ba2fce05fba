"""The keys of a material profile."""

from dataclasses import dataclass, fields
from typing import Any

from amprep.model.supports.rules import OverhangJudgement, OverhangRules, SectionRules
from amprep.validation import require_bounds


@dataclass(frozen=True)
class MaterialProfile(OverhangRules, SectionRules):
    """The defaults that a material gives to a job; every key of ``[supports]`` takes precedence.

    Attributes
    ----------
    name, aliases
        Name in job files, and other names of the material.
    based_on
        Name of the profile from which keys are taken that this one does not state.
    density_g_cm3
        Density of the solid material; None if the profile is for several materials.
    recoating_s
        Time (s) for one layer apart from the scanning.
    scan_mm2_s
        Area (mm2) that is scanned in a second.
    heating_h, cooling_h
        Hours before the first and after the last layer.
    hour_price, powder_price_kg
        Price of an hour of the machine, and of a kilogram of powder, in any currency; None if unknown.
    source
        Public sources of the figures.
    """

    rules: OverhangJudgement = "limits"
    name: str = ""
    aliases: tuple[str, ...] = ()
    based_on: str = ""
    density_g_cm3: float | None = None
    recoating_s: float = 10.0
    scan_mm2_s: float = 60.0
    heating_h: float = 0.0
    cooling_h: float = 0.0
    hour_price: float | None = None
    powder_price_kg: float | None = None
    source: str = ""

    def __post_init__(self) -> None:
        OverhangRules.__post_init__(self)
        SectionRules.__post_init__(self)
        self.require_noncritical()
        require_bounds(self, "density_g_cm3", "scan_mm2_s", above=0)
        require_bounds(self, "recoating_s", "hour_price", "powder_price_kg", at_least=0)
        require_bounds(self, "heating_h", "cooling_h", at_least=0, at_most=1000)

    @property
    def support_defaults(self) -> dict[str, Any]:
        """The defaults of the job's section ``[supports]``."""
        names = [field.name for each in (OverhangRules, SectionRules) for field in fields(each)]
        return {name: getattr(self, name) for name in names}
