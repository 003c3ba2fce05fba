"""Measure volumes, height and density of a build on the original meshes."""

from math import ceil, pi

from amprep.model import Build, PlacedPart

_ROUNDING = 1e-6
"""Fraction of a layer that rounding may add to the height of a build."""


def part_volume(placed: PlacedPart) -> float:
    """Return the volume of the placed part, mm3; overlapping shells count once."""
    return placed.part.volume_mm3 or abs(placed.part.mesh.signed_volume)


def build_height(build: Build) -> float:
    """Return the greatest height of parts and supports, mm; 0 for an empty build."""
    meshes = [placed.mesh for placed in build.parts] + [body.mesh for body in build.supports]
    return max((float(mesh.bounds[1][2]) for mesh in meshes if len(mesh.vertices)), default=0.0)


def layer_count(build: Build, thickness: float) -> int:
    """Return the number of layers of a thickness (mm) from the plate to the highest point of a build."""
    return max(ceil(build_height(build) / thickness - _ROUNDING), 0)


def build_density(build: Build) -> float:
    """Return the volume of the parts divided by plate area times build height.

    Supports do not count, and forbidden zones are not subtracted from the plate.
    """
    plate, height = plate_area(build), build_height(build)
    return sum(part_volume(placed) for placed in build.parts) / (plate * height) if height > 0 else 0.0


def plate_area(build: Build) -> float:
    """Return the area of the build plate, mm2; forbidden zones are not subtracted."""
    x, y, _ = build.settings.space.size.tolist()
    return float(x * y if build.settings.space.shape == "box" else pi / 4 * x * x)


def support_volume(build: Build) -> float:
    """Return the volume of the solid supports, mm3; walls without thickness have no volume."""
    return sum(abs(body.mesh.signed_volume) for body in build.supports if not body.surface)
