"""Draw the height profile of a build: height to the right, area of the cross-section upwards."""

from amprep.report.record import BuildRecord

WIDTH, HEIGHT = 640.0, 200.0
"""Size of the drawing, in its own units."""


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
    chart = (
        f'<svg class="profile" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" preserveAspectRatio="none" role="img">'
        f"<title>Area of the cross-section from {profile.low:.1f} to {entry.height_mm:.1f} mm; dashed: the mean</title>"
        f'<path d="M0 {HEIGHT:g}{points}V{HEIGHT:g}Z"/>'
        f'<line x1="0" x2="{WIDTH:g}" y1="{mean:.1f}" y2="{mean:.1f}"/></svg>'
    )
    top = profile.low + profile.spacing * len(profile.areas)
    figures = (
        f"Build {number}, from left to right z = {profile.low:.1f} to {top:.1f} mm: mean {profile.mean / 100:.1f} cm², "
        f"largest {profile.largest:.2f} times the mean, variation {100 * profile.variation:.0f} %, "
        f"largest jump within {profile.spacing:.2g} mm {profile.largest_jump:.2f} times the mean"
    )
    return f"<p>{figures}.</p>\n{chart}\n"
