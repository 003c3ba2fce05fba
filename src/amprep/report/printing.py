"""State what a build takes: use of the plate, mass, layers and hours."""

from collections.abc import Iterable, Sequence
from typing import Any

from amprep.measures.printing.estimate import PrintingEstimate
from amprep.model.counting import counted

GRAMS_IN_KG = 1000.0

HOW_TO_GET_MASS = "no density: choose an alloy by --material"
"""What to do where the mass is unknown."""


def printing_words(estimates: Sequence[PrintingEstimate]) -> str:
    """Return what the builds of a run take in one line; empty without builds."""
    if not estimates:
        return ""
    layers = sum(each.layers for each in estimates)
    recoating, scanning, thermal = (
        sum(hours)
        for hours in zip(
            *((e.recoating_h, e.scanning_h, e.heating_h + e.cooling_h) for e in estimates), strict=True
        )
    )
    use = sum(each.plate_use for each in estimates) / len(estimates)
    return (
        f"{'mean ' if len(estimates) > 1 else ''}plate use {100 * use:.1f} %, {_masses(estimates)}, "
        f"{counted(layers, 'layer')}, about {hours_words(recoating + scanning + thermal)} "
        f"(recoating {hours_words(recoating)}, "
        f"scanning {hours_words(scanning)}"
        f"{f', heating and cooling {hours_words(thermal)}' if thermal else ''}){_cost_words(estimates)}"
    )


def total_cost(estimates: Iterable[PrintingEstimate]) -> float | None:
    """Return the cost of all builds; None if that of one is unknown."""
    costs = [each.cost for each in estimates]
    known = [cost for cost in costs if cost is not None]
    return sum(known) if len(known) == len(costs) else None


def _cost_words(estimates: Sequence[PrintingEstimate]) -> str:
    total = total_cost(estimates)
    return "" if total is None else f", cost {total:,.2f}"


def total_mass_g(estimates: Iterable[PrintingEstimate]) -> float | None:
    """Return the mass of all builds; None if that of one is unknown."""
    masses = [each.mass_g for each in estimates]
    known = [mass for mass in masses if mass is not None]
    return sum(known) if len(known) == len(masses) else None


def mass_words(grams: float | None) -> tuple[str, str]:
    """Return a mass as number and unit; ``unknown`` without a unit if it is not known."""
    if grams is None:
        return "unknown", ""
    return (f"{grams:.1f}", "g") if grams < GRAMS_IN_KG else (f"{grams / GRAMS_IN_KG:.2f}", "kg")


def hours_words(hours: float) -> str:
    """Return a duration in hours, or in minutes below one hour."""
    return f"{hours:.1f} h" if hours >= 1.0 else f"{60.0 * hours:.0f} min"


def printing_json(estimate: PrintingEstimate) -> dict[str, Any]:
    """Return the estimate for a build."""
    return {
        "plate_use": estimate.plate_use,
        "parts_g": estimate.parts_g,
        "supports_g": estimate.supports_g,
        "layers": estimate.layers,
        "recoating_h": estimate.recoating_h,
        "scanning_h": estimate.scanning_h,
        "heating_h": estimate.heating_h,
        "cooling_h": estimate.cooling_h,
        "hours": estimate.hours,
        "cost": estimate.cost,
    }


def _masses(estimates: Sequence[PrintingEstimate]) -> str:
    """Return the mass of parts and supports, or that the density of the material is unknown."""
    total = total_mass_g(estimates)
    if total is None:
        return f"mass unknown ({HOW_TO_GET_MASS})"
    supports = sum(each.supports_g or 0.0 for each in estimates)
    return f"mass {' '.join(mass_words(total))} (supports {' '.join(mass_words(supports))})"
