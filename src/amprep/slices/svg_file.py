"""Draw a layer as SVG, in millimetres, as seen from above."""

from collections.abc import Sequence
from xml.sax.saxutils import escape

import numpy as np

from amprep.geometry.slicing.layers import LayerContours
from amprep.geometry.slicing.text import groups_text
from amprep.slices.bodies import Layer, SliceBody

_STYLE = (
    "<style>path{fill-rule:evenodd;stroke-width:.05}.part{fill:#4a6fa5;stroke:#2b4a78}"
    ".support{fill:#d9a441;stroke:#9a6b10}.line{fill:none}</style>\n"
)
_DECIMALS = 4


def layer_svg(layer: Layer, bodies: Sequence[SliceBody], plate: tuple[float, float]) -> bytes:
    """Return a layer as SVG: one path for each body, with its name as title.

    Parameters
    ----------
    layer
        The layer.
    bodies
        The bodies of the build.
    plate
        Width and depth of the plate, mm.
    """
    width, depth = plate
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{depth:g}mm" '
        f'viewBox="0 {-depth:g} {width:g} {depth:g}" data-layer="{layer.number + 1}" data-top="{layer.top_mm:.4f}">\n'
    )
    frame = f'<rect y="{-depth:g}" width="{width:g}" height="{depth:g}" fill="none" stroke="#999" stroke-width=".2"/>\n'
    paths = [_path(bodies[body], contours, own) for body, contours, own in layer.contours]
    return b"".join([(head + _STYLE + frame).encode(), *paths, b"</svg>\n"])


def _path(body: SliceBody, contours: LayerContours, own: range) -> bytes:
    """Return the path of one body; the y axis of SVG leads down."""
    role = "support" if body.is_support else "part"
    text = [f'<path class="{role}{" line" if contours.is_open else ""}" d="'.encode()]
    points = contours.points[contours.first[own.start] : contours.first[own.stop]] * (1.0, -1.0)
    text.append(
        groups_text(
            np.empty((len(own), 0), np.int64),
            (b"M", b"" if contours.is_open else b"Z"),
            np.rint(points * 10**_DECIMALS).astype(np.int64),
            contours.first[own.start : own.stop + 1] - contours.first[own.start],
            (b" ", b" ", b""),
            _DECIMALS,
        )
    )
    text.append(f'"><title>{escape(_printable(body.name))}</title></path>\n'.encode())
    return b"".join(text)


def _printable(name: str) -> str:
    return "".join(each if each.isprintable() else "_" for each in name)
