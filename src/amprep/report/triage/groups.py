"""Group findings by class, part and kind, so that hundreds of regions of one thread are one row."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from amprep.model.counting import counted
from amprep.report.triage.classes import TRIAGES, Triage
from amprep.report.triage.findings import Finding
from amprep.report.triage.region_words import regions_in_words

PLURALS = {
    "unplaced copy": "unplaced copies",
    "locked parts": "groups of locked parts",
    "powder pocket": "pockets of powder that cannot leave",
}
"""Kind -> plural, where it is not the kind with an s."""
SINGULARS = {
    "locked parts": "group of locked parts",
    "powder pocket": "pocket of powder that cannot leave",
}
"""Kind -> singular, where it is not the kind."""


@dataclass(frozen=True, eq=False)
class FindingGroup:
    """Findings of one class, one part of the job and one kind, the largest first.

    Attributes
    ----------
    findings
        At least one.
    """

    triage: Triage
    part: str
    kind: str
    findings: tuple[Finding, ...]

    @property
    def words(self) -> str:
        """What the group consists of, for example ``12 bores 3.0 to 4.2 mm, limit 8 mm``."""
        regions = [each.overhang.region for each in self.findings if each.overhang is not None]
        if len(regions) == len(self.findings):
            return regions_in_words(regions)
        if len(self.findings) == 1 and self.kind != "violation":
            return self.findings[0].words
        count = counted(
            len(self.findings), SINGULARS.get(self.kind, self.kind), PLURALS.get(self.kind, f"{self.kind}s")
        )
        if self.kind == "violation":
            return f"{count}: {', '.join(dict.fromkeys(each.words.split(':')[0] for each in self.findings))}"
        volume = sum(each.volume_mm3 for each in self.findings)
        return f"{count}, {volume:.1f} mm³ in total" if volume else count


def grouped(findings: Iterable[Finding]) -> list[FindingGroup]:
    """Return the groups of findings: by class, then the group with the largest finding first."""
    members: dict[tuple[Triage, str, str], list[Finding]] = {}
    for each in findings:
        members.setdefault((each.triage, each.part, each.kind), []).append(each)
    groups = [
        FindingGroup(*key, tuple(sorted(found, key=_by_size, reverse=True))) for key, found in members.items()
    ]
    groups.sort(key=lambda group: _by_size(group.findings[0]), reverse=True)
    return sorted(groups, key=lambda group: TRIAGES.index(group.triage))


def count_by_triage(findings: Iterable[Finding]) -> dict[Triage, int]:
    """Return the number of findings of each class, the most urgent class first."""
    counts = dict.fromkeys(TRIAGES, 0)
    for each in findings:
        counts[each.triage] += 1
    return counts


def counts_in_words(counts: dict[Triage, int], most: Sequence[Triage] = TRIAGES) -> str:
    """Return for example ``3 must fix, 12 worth a check``, with the chosen classes."""
    return ", ".join(f"{counts[each]} {each}" for each in most)


def _by_size(finding: Finding) -> tuple[bool, bool, float, float]:
    """Return the sorting key of a finding: other findings first, then starts in the air, then by size and area."""
    if finding.overhang is None:
        return (True, False, 0.0, finding.volume_mm3)
    region = finding.overhang.region
    return (False, region.starts_in_air, region.size_mm, region.measure)
