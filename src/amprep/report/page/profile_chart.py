"""Draw the height profile of a build: height to the right, area of the cross-section upwards."""

from amprep.report.record import BuildRecord

WIDTH, HEIGHT = 640.0, 200.0
"""Size of the area of the chart between its axes, in the units of the drawing."""

LEFT, RIGHT, ABOVE, BELOW = 56.0, 24.0, 24.0, 44.0
"""Room for the labels around that area."""


def profile_chart(number: int, entry: BuildRecord) -> str:
    """Return the chart of a build with its figures; empty for a build without parts."""
    profile = entry.profile
    most = float(profile.areas.max(initial=0.0))
    if most <= 0.0:
        return ""
    step = WIDTH / len(profile.areas)
    points = "".join(
        f"V{HEIGHT * (1.0 - area / most):.1f}H{step * (index + 1):.1f}"
        for index, area in enumerate(profile.areas.tolist())
    )
    mean = HEIGHT * (1.0 - profile.mean / most)
    top = profile.low + profile.spacing * len(profile.areas)
    box = f"{-LEFT:g} {-ABOVE:g} {LEFT + WIDTH + RIGHT:g} {ABOVE + HEIGHT + BELOW:g}"
    chart = (
        f'<svg class="profile" viewBox="{box}" role="img">'
        f"<title>Area of the cross-section from {profile.low:.1f} to {top:.1f} mm; dashed: the mean</title>"
        f'<path d="M0 {HEIGHT:g}{points}V{HEIGHT:g}Z"/>'
        f'<line x1="0" x2="{WIDTH:g}" y1="{mean:.1f}" y2="{mean:.1f}"/>'
        f"{_heights(profile.low, top)}{_areas(most)}</svg>"
    )
    figures = (
        f"Build {number}: mean area {profile.mean / 100:.1f} cm² (dashed), coefficient of variation "
        f"{100 * profile.variation:.0f} %; the largest area is {profile.largest:.2f} times the mean, the largest jump "
        f"within {profile.spacing:.2g} mm {profile.largest_jump:.2f} times the mean"
    )
    return f"<p>{figures}.</p>\n{chart}\n"


def _heights(low: float, top: float) -> str:
    """Return the labels of the axis of heights."""
    ends = "".join(
        _label(WIDTH * at, HEIGHT + 18.0, f"{round(low + (top - low) * at, 1) + 0.0:.1f}", "middle")
        for at in (0.0, 0.5, 1.0)
    )
    return ends + _label(WIDTH / 2.0, HEIGHT + 38.0, "height z, mm", "middle")


def _areas(most: float) -> str:
    """Return the labels of the axis of areas up to the greatest one, mm2."""
    ends = "".join(
        _label(-8.0, HEIGHT * (1.0 - at) + 4.0, f"{most * at / 100:.4g}", "end") for at in (0.0, 0.5, 1.0)
    )
    return ends + _label(-LEFT, -12.0, "area, cm²", "start")


def _label(x: float, y: float, text: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text}</text>'
