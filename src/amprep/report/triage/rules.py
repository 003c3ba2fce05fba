"""State the rules that a build was judged by in one line."""

from amprep.model import BuildSettings
from amprep.model.supports.rules import SupportRules
from amprep.report.record import RunRecord


def rules_of(record: RunRecord) -> list[str]:
    """Return a line with the rules of the supports of a run; none if its job has no supports."""
    supported = [entry.build.settings for entry in record.builds if entry.build.settings.supported]
    return [rules_words(settings, record.material, not record.by_default) for settings in supported[:1]]


def rules_words(settings: BuildSettings, material: str, distances: bool = True) -> str:
    """Return material, limits, territory and distances, for example ``material metal: ledge 1, bridge 2, bore 8 mm``.

    Parameters
    ----------
    settings
        The rules of the build.
    material
        Name of the material profile; empty if it is not known.
    distances
        Whether lift and distance are stated; they never are if both are 0.
    """
    rules = settings.rules
    words = [f"material {material}: {_limits(rules)}" if material else _limits(rules), _territory(rules)]
    if distances and (settings.lift, settings.clearance) != (0.0, 0.0):
        words.append(f"lift {settings.lift:g} mm, part distance {settings.clearance:g} mm")
    return "; ".join(words)


def _limits(rules: SupportRules) -> str:
    angle = f"{rules.overhang_angle_deg:g} degrees"
    if not rules.has_limits:
        return f"rules of the thesis, {angle}"
    noncritical = (
        f", not critical up to {rules.noncritical_angle_deg:g}" if rules.noncritical_angle_deg else ""
    )
    sizes = f"ledge {rules.ledge_mm:g}, bridge {rules.bridge_mm:g}, bore {rules.bore_mm:g} mm"
    return f"{sizes}, {angle}{noncritical}"


def _territory(rules: SupportRules) -> str:
    if rules.territory == "shared":
        return "territory shared"
    return f"territory own with a margin of {rules.territory_margin_mm:g} mm"
