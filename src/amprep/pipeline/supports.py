"""Plans the supports of a build: needs, grid, red squares, routing, groups (thesis 3.2)."""

from amprep.pipeline.support_layout import SupportLayout

__all__ = ["SupportLayout"]
