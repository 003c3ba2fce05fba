"""Judge the settings of the slicer by what it printed: supports of its own, and the height of layers."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats
from amprep.checks.gcode.found import SlicedBody, SlicedObject, SlicedPlate
from amprep.checks.gcode.sections import line_points
from amprep.checks.violation import Violation
from amprep.geometry.meshes.containment import inside
from amprep.model.build import Build
from amprep.model.mesh import join_meshes

OWN_SUPPORTS, LAYER_HEIGHT = "no supports of the slicer", "layer height"
_SLACK = 1.05
"""Layers may be so many times as thick as planned, for rounding."""
_STRAY_MM = 20.0
"""Length (mm) of lines of supports beside those of the build that may be a rest of rounding."""
_BESIDE = 1.2
"""Distance (mm) from the supports of a build up to which lines of supports belong to them: Cura joins supports that are
nearer to each other than 2 mm."""
_MOST_BESIDE = 0.1
"""Greatest fraction of the lines of supports that may lie farther away."""


def check_own_supports(
    printed: Sequence[tuple[str, SlicedObject]], build: Build, origin: Floats
) -> list[Violation]:
    """Return the objects, each with its label, to which the slicer added supports.

    Cura prints the supports of a build as supports; there, lines count that lie beside all supports of the build.
    """
    found = []
    for label, each in printed:
        supports = each.supports
        length = supports.length
        if build.settings.target == "cura" and build.supports:
            fraction = _fraction_beside(supports, build, origin)
            length *= fraction if fraction > _MOST_BESIDE else 0.0
        if length > _STRAY_MM:
            message = f"the slicer added {length / 1000.0:.2f} m of supports of its own"
            found.append(Violation(OWN_SUPPORTS, label, message))
    return found


def own_supports_words(plate: SlicedPlate) -> str:
    """Return what was judged; it begins with "not judged" if the file does not say what its lines are."""
    if not plate.features:
        return "not judged: the G-code does not say what its lines are"
    return "by the features that the G-code states"


def check_layer_height(printed: Sequence[tuple[str, SlicedObject]], build: Build) -> list[Violation]:
    """Return where layers are thicker than the supports of the build were planned for."""
    limit, words = planned_layer(build)
    thickest = max((each.body.thickest for _, each in printed), default=0.0)
    if not limit or thickest <= _SLACK * limit:
        return []
    message = f"layers are up to {thickest:.3g} mm thick, {words}"
    return [Violation(LAYER_HEIGHT, build.settings.build_id, message)]


def planned_layer(build: Build) -> tuple[float, str]:
    """Return the greatest thickness of layers (mm) for which supports were planned, in words too; 0 for none."""
    rules = build.settings.rules
    if not build.settings.supported:
        return 0.0, "not judged: the build has no supports"
    step = build.settings.sizes.square_mm * float(np.tan(np.radians(rules.strut_angle_deg)))
    limits = [(step, f"a step of the supports is {step:.3g} mm")] if step > 0 else []
    if rules.has_limits:
        limits.append(
            (rules.layer_mm, f"the supports were planned for layers of at most {rules.layer_mm:.3g} mm")
        )
    return min(limits, default=(0.0, "not judged: the build file states neither layers nor steps"))


def _fraction_beside(supports: SlicedBody, build: Build, origin: Floats) -> float:
    """Return the fraction of the recorded lines of supports that lie beside all supports of the build."""
    from scipy.spatial import cKDTree

    mesh = join_meshes([each.mesh for each in build.supports])
    pieces = [
        np.column_stack([points, np.full(len(points), layer.z - layer.thickness / 2.0)])
        for layer in supports.samples
        for points in [line_points(layer.lines)[0] - origin]
    ]
    if not pieces:
        return 1.0
    points = np.concatenate(pieces)
    beside = ~inside(points, mesh.vertices, mesh.triangles)
    if beside.any() and not beside.all():
        near = cKDTree(points[~beside]).query(points[beside], distance_upper_bound=_BESIDE)[0] <= _BESIDE
        beside[beside] = ~near
    return float(beside.mean())
