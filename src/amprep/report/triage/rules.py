"""State the rules that a build was judged by in one line."""

from amprep.model import BuildSettings
from amprep.model.supports.rules import LARGEST_LIMIT, SupportRules
from amprep.report.record import RunRecord


def rules_of(record: RunRecord) -> list[str]:
    """Return a line with the rules of the supports of a run; none if its job has no supports."""
    supported = [entry.build.settings for entry in record.builds if entry.build.settings.supported]
    return [rules_words(settings, record.material, not record.by_default) for settings in supported[:1]]


def rules_words(settings: BuildSettings, material: str, distances: bool = True) -> str:
    """Return material, limits, territory and distances in words.

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
        return f"rules of the thesis: all faces flatter than {angle} need support"
    noncritical = (
        f" ({rules.overhang_angle_deg:g} to {rules.noncritical_angle_deg:g} degrees not critical)"
        if rules.noncritical_angle_deg
        else ""
    )
    kinds = {"ledges": rules.ledge_mm, "bridges": rules.bridge_mm, "bores": rules.bore_mm}
    sizes = ", ".join(f"{kind} {_size(size)}" for kind, size in kinds.items())
    return f"faces flatter than {angle} need support{noncritical}, but not {sizes}"


def _size(limit_mm: float) -> str:
    return "of any size" if limit_mm >= LARGEST_LIMIT else f"up to {limit_mm:g} mm"


def _territory(rules: SupportRules) -> str:
    if rules.territory == "shared":
        return "supports may stand anywhere on the plate"
    return f"supports stay within {rules.territory_margin_mm:g} mm of the shadow of their part"
