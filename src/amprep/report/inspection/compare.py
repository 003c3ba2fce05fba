"""Compare volume makers over all parts of an inspection."""

from dataclasses import dataclass
from statistics import fmean

from amprep.report.inspection.record import InspectedVolume, InspectionRecord


@dataclass(frozen=True)
class MakerFigures:
    """Figures of a volume maker, or of a chain, over several parts.

    Attributes
    ----------
    ratio, greatest_ratio
        Mean and greatest ratio of the volume to that of the part; None if no part has one.
    seconds
        Mean processor time for a part.
    outside
        Number of volumes that do not contain their part.
    not_made
        Number of parts for which it made none.
    """

    makers: str
    ratio: float | None
    greatest_ratio: float | None
    seconds: float
    outside: int
    not_made: int


def compare_makers(record: InspectionRecord) -> list[MakerFigures]:
    """Return the figures of each maker, in the order in which they were tried."""
    by_makers: dict[str, list[InspectedVolume]] = {}
    for each in record.parts:
        for volume in each.volumes:
            by_makers.setdefault(volume.makers, []).append(volume)
    return [_figures(makers, volumes) for makers, volumes in by_makers.items()]


def _figures(makers: str, volumes: list[InspectedVolume]) -> MakerFigures:
    made = [volume for volume in volumes if volume.made is not None]
    ratios = [volume.ratio for volume in made if volume.ratio is not None]
    return MakerFigures(
        makers,
        fmean(ratios) if ratios else None,
        max(ratios, default=None),
        fmean([volume.seconds for volume in made]) if made else 0.0,
        sum(bool(volume.violations) for volume in made),
        len(volumes) - len(made),
    )
