"""Builds on their way to supports: planned, and supported."""

from dataclasses import dataclass

from amprep.measures.removability import Removal
from amprep.model import Build, PlacedPart
from amprep.model.summary import Summarised
from amprep.overhangs.of_part import PartOverhangs
from amprep.pipeline.packing import PackedBuild
from amprep.pipeline.passes import PlannedPass, TakenRegions
from amprep.pipeline.supporting.copies import EqualCopies
from amprep.supports.plan import SupportLayout


@dataclass(frozen=True, eq=False, repr=False)
class SupportedBuild(Summarised):
    """A build with its supports.

    Attributes
    ----------
    build
        Parts, supports, unsupported regions, and the rules they were made under.
    layouts
        Layouts of the supports, one for each pass of planning; empty when the job has no supports. Their parts are
        those that were planned.
    overhangs
        The overhangs of each part; empty when the job has no supports.
    advice
        Settings to try where something stays unsupported, one sentence each.
    removal
        Figures on the removal of each support body.
    rules
        Numbers of the ``[[rule]]`` entries that take a region, from 1; 0 if one is left to the settings of the job.
    copies
        Which parts have the supports that were planned for another one; None where each was planned by itself.
    """

    build: Build
    layouts: tuple[SupportLayout, ...] = ()
    overhangs: tuple[PartOverhangs, ...] = ()
    advice: tuple[str, ...] = ()
    removal: tuple[Removal, ...] = ()
    rules: frozenset[int] = frozenset()
    copies: EqualCopies | None = None

    def __str__(self) -> str:
        """Summary in one line."""
        build = self.build
        open_regions = sum(not region.minor for region in build.unsupported)
        return (
            f"{build.settings.build_id}: {len(build.parts)} parts, {len(build.supports)} supports, "
            f"{open_regions} unsupported regions"
        )


@dataclass(frozen=True, eq=False, repr=False)
class PlannedBuild(Summarised):
    """A build with the layout of its supports, before edges are replaced by cells.

    Attributes
    ----------
    build
        The placed parts with their job.
    passes
        The passes of planning, each with its settings and its layout; the first has the settings of the job. Empty
        when the job has no supports.
    taken
        The overhangs of the planned parts, and the rules that take them; None when the job has no supports.
    copies
        Which parts get the supports that are planned for another one; None where each is planned by itself.
    """

    build: PackedBuild
    passes: tuple[PlannedPass, ...] = ()
    taken: TakenRegions | None = None
    copies: EqualCopies | None = None

    @property
    def parts(self) -> tuple[PlacedPart, ...]:
        """The parts for which supports are planned."""
        return self.build.parts if self.copies is None else self.copies.planned_parts

    @property
    def layout(self) -> SupportLayout | None:
        """Layout of the first pass; None when the job has no supports."""
        return self.passes[0].layout if self.passes else None

    @property
    def layouts(self) -> tuple[SupportLayout, ...]:
        """Layouts of all passes."""
        return tuple(each.layout for each in self.passes)

    @property
    def pitch_mm(self) -> float:
        """Horizontal size of a voxel of the support grid of the first pass; 1 when the job has no supports."""
        return self.passes[0].pitch_mm if self.passes else 1.0

    def __str__(self) -> str:
        """Summary in one line."""
        if not self.passes:
            return f"{self.build.build_id}: no supports"
        connected = sum(int(layout.connected.sum()) for layout in self.layouts)
        pitches = ", ".join(f"{pitch:g}" for pitch in dict.fromkeys(each.pitch_mm for each in self.passes))
        count = sum(len(each.red.square) for each in self.layouts)
        return f"{self.build.build_id}: {connected} of {count} demand squares connected, pitch {pitches} mm"
