"""The figures of a build that every report shows, measured on the original meshes."""

from math import pi

from amprep.model import Build, PlacedPart


def part_volume(placed: PlacedPart) -> float:
    """Return the volume of the placed part, mm3; overlapping shells count once."""
    return placed.part.volume_mm3 or abs(placed.part.mesh.signed_volume)


def build_height(build: Build) -> float:
    """Return the height of the highest point of parts and supports, mm; 0 for an empty build."""
    meshes = [placed.mesh for placed in build.parts] + [body.mesh for body in build.supports]
    return max((float(mesh.bounds[1][2]) for mesh in meshes if len(mesh.vertices)), default=0.0)


def build_density(build: Build) -> float:
    """Return the share of the space up to the build's height that parts fill: volume / (plate area x height).

    Supports do not count; forbidden zones are not taken off the plate.
    """
    x, y, _ = build.settings.space.size.tolist()
    plate = x * y if build.settings.space.shape == "box" else pi / 4 * x * x
    height = build_height(build)
    return sum(part_volume(placed) for placed in build.parts) / (plate * height) if height > 0 else 0.0


def support_volume(build: Build) -> float:
    """Return the volume of the solid supports, mm3; walls without thickness have none."""
    return sum(abs(body.mesh.signed_volume) for body in build.supports if not body.surface)
