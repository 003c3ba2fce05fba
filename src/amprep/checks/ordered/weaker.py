"""Find the settings of a build by which its judges are more lenient than by other settings."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from amprep.model.build import Build, BuildSettings
from amprep.model.part import Orientations, Overrides

_STRICT_ABOVE = ("clearance", "lift")
_STRICT_BELOW = ("overlap", "reach")
_RULES_STRICT_ABOVE = ("overhang_angle_deg", "least_wall_mm", "least_contact_mm2", "gap_mm")
_RULES_STRICT_BELOW = ("plate_mm", "layer_mm", "min_area_mm2", "min_length_mm")
_LIMITS_STRICT_BELOW = ("ledge_mm", "bridge_mm", "bore_mm")
_NO_LIMIT_AT_ZERO = ("leg_ratio", "contact_spacing_mm")
_DRIFT = ("drift_ratio", "drift_mm")
_SIZES_STRICT_BELOW = ("tip_width_mm", "tip_height_mm", "base_margin_mm", "base_height_mm")

_ROUNDING = 1e-9
"""Relative difference of numbers that counts as none."""


@dataclass(frozen=True)
class Weaker:
    """A setting that is more lenient than it should be.

    Attributes
    ----------
    setting
        Its name, as in job files; for a setting of a part with the label of the part.
    value, expected
        What it is, and what it should be.
    """

    setting: str
    value: Any
    expected: Any

    def words(self, expected: str) -> str:
        """Return the setting in words; `expected` names what it should be: ``clearance_mm 2 (usual: 5)``."""
        return f"{self.setting} {_shown(self.value)} ({expected}: {_shown(self.expected)})"


def most_lenient(build: Build) -> BuildSettings:
    """Return the settings of a build with the largest reach and the largest sizes of its supports."""
    settings, reach, sizes = build.settings, build.settings.reach, build.settings.sizes
    for body in build.supports:
        reach, sizes = max(reach, settings.reach_of(body)), sizes.enlarged(settings.sizes_of(body))
    return replace(settings, reach=reach, sizes=sizes)


def weaker_settings(found: BuildSettings, expected: BuildSettings) -> list[Weaker]:
    """Return the settings of a build by which it is judged more leniently than by the expected ones.

    Sizes of tips and bases count, because supports may be thinner in tips, and wider in bases.
    """
    pairs = [*_above(found, expected, _STRICT_ABOVE), *_below(found, expected, _STRICT_BELOW)]
    pairs += _below(found.sizes, expected.sizes, _SIZES_STRICT_BELOW)
    own, usual = found.rules, expected.rules
    pairs += _above(own, usual, _RULES_STRICT_ABOVE)
    pairs += _below(own, usual, _RULES_STRICT_BELOW)
    pairs += _limited(own, usual, _NO_LIMIT_AT_ZERO)
    if own.has_limits:  # without limits, the part carries nothing itself
        limits = (
            _below(own, usual, _LIMITS_STRICT_BELOW) if usual.has_limits else [("rules", "limits", "thesis")]
        )
        pairs += limits
    if usual.territory == "own":
        pairs += _territory(own, usual)
    if own.grounding != usual.grounding and own.grounding == "anywhere":
        pairs.append(("grounding", own.grounding, usual.grounding))
    if expected.supported and not found.supported:
        pairs.append(("enabled", False, True))
    names = {"clearance": "clearance_mm", "lift": "lift_mm", "overlap": "overlap_mm", "reach": "reach_mm"}
    return [Weaker(names.get(name, name), value, usual_value) for name, value, usual_value in pairs]


def weaker_part(label: str, found: Overrides, expected: Overrides, usual: BuildSettings) -> list[Weaker]:
    """Return the settings of a part that are more lenient than expected.

    Parameters
    ----------
    label
        Label of the part.
    found, expected
        Its own settings, and those that it should have.
    usual
        The settings that the build should have, which hold where the part has none of its own.
    """
    of_build = {
        "overhang_angle_deg": usual.rules.overhang_angle_deg,
        "lift_mm": usual.lift,
        "clearance_mm": usual.clearance,
        "territory_margin_mm": usual.rules.territory_margin_mm,
    }
    due = {
        name: value if (own := getattr(expected, name)) is None else own for name, value in of_build.items()
    }
    stated = {name: value for name in of_build if (value := getattr(found, name)) is not None}
    result = []
    for name, value in stated.items():  # those of the build are judged with the build
        more = value - due[name]
        if more > _ROUNDING if name == "territory_margin_mm" else more < -_ROUNDING:
            result.append(Weaker(f"{label}: {name}", value, due[name]))
    if found.supports is False and expected.supports is not False:
        result.append(Weaker(f"{label}: supports", False, True))
    return result


def weaker_orientations(label: str, found: Orientations, expected: Orientations) -> list[Weaker]:
    """Return the freedom of a part if it is larger than expected; lists of rotations are not compared."""
    rank = {"list": 0, "about-z": 1, "free": 2}
    if rank[found.freedom] <= rank[expected.freedom]:
        return []
    return [Weaker(f"{label}: rotations", found.freedom, expected.freedom)]


def _above(own: Any, usual: Any, names: tuple[str, ...]) -> list[tuple[str, Any, Any]]:
    """Return the settings that are smaller than expected, where a larger one is stricter."""
    return [pair for pair in _pairs(own, usual, names) if pair[1] < pair[2] - _ROUNDING * abs(pair[2])]


def _below(own: Any, usual: Any, names: tuple[str, ...]) -> list[tuple[str, Any, Any]]:
    """Return the settings that are larger than expected, where a smaller one is stricter."""
    return [pair for pair in _pairs(own, usual, names) if pair[1] > pair[2] + _ROUNDING * abs(pair[2])]


def _limited(own: Any, usual: Any, names: tuple[str, ...]) -> list[tuple[str, Any, Any]]:
    """Return the settings that are larger than expected, or 0 for no limit where one is expected."""
    return [
        pair
        for pair in _pairs(own, usual, names)
        if pair[2] > 0.0 and (pair[1] == 0.0 or pair[1] > pair[2] * (1.0 + _ROUNDING))
    ]


def _territory(own: Any, usual: Any) -> list[tuple[str, Any, Any]]:
    if own.territory != "own":
        return [("territory", own.territory, "own")]
    return [*_below(own, usual, ("territory_margin_mm",)), *_limited(own, usual, _DRIFT)]


def _pairs(own: Any, usual: Any, names: tuple[str, ...]) -> Iterator[tuple[str, Any, Any]]:
    return ((name, getattr(own, name), getattr(usual, name)) for name in names)


def _shown(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
