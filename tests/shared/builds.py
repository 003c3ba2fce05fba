"""Builds small enough to know by heart."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from amprep.model import (
    Appearance,
    Build,
    BuildSettings,
    BuildVolume,
    Mesh,
    Orientations,
    Overrides,
    Part,
    PlacedPart,
    Region,
    SupportBody,
    Target,
    Unsupported,
)

QUARTER_TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
MakeBuild = Callable[..., Build]


def box_mesh(corner: tuple[float, float, float], size: tuple[float, float, float]) -> Mesh:
    """Return a box of eight vertices and twelve triangles."""
    import manifold3d

    box = manifold3d.Manifold.cube(size).translate(corner).to_mesh()
    return Mesh(box.vert_properties[:, :3], box.tri_verts)


def placement(rotation: np.ndarray, *translation: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, translation
    return matrix


@pytest.fixture(scope="session")
def make_build() -> MakeBuild:
    """Return a maker of builds: two copies of `plate & <tray>` and one turned `bar`, 3 mm above the plate.

    The first plate stands on a post of its own; the other post holds the bar, and with `share` the second
    plate as well, of which an overhang is listed as unsupported. With `surface` the first post is a wall of
    two triangles.
    """

    def make(target: Target = "generic", *, share: bool = False, surface: bool = False) -> Build:
        plate, bar = _plate(), _bar()
        parts = (
            PlacedPart("plate & <tray>", plate, placement(np.eye(3), 10.123456, 20.0, 3.0)),
            PlacedPart("bar", bar, placement(QUARTER_TURN, 80.1, 60.333333, 3.0), bar.orientations),
            PlacedPart(
                "plate & <tray>-2",
                plate,
                placement(np.eye(3), 123.4567891, 150.0, 3.0),
                Orientations("about-z"),
            ),
        )
        wall = Mesh([[12, 22, 0], [18, 22, 0], [12, 22, 3], [18, 22, 3]], [[0, 1, 2], [2, 1, 3]])
        post = wall if surface else box_mesh((12.0, 22.0, 0.0), (2.0, 2.0, 3.0))
        supports = (
            SupportBody("support 1 of plate", post, (0,), surface),
            SupportBody("support 2", box_mesh((76, 62, 0), (2, 2, 3.3)), (1, 2) if share else (1,)),
        )
        region = Unsupported(
            2, "overhang 1 of plate-2", "face", "enclosed", 12.5, [[1.25, 2, 3], [4, 5, 6]], 0.7
        )
        space = BuildVolume((250, 210, 220), "box", [[0, 0, 0]], [[5, 5, 5]])
        settings = BuildSettings("job.build-1", space, target, printer="MK4", clearance=0.5, lift=3.0)
        return Build(settings, parts, supports, (region,))

    return make


def _plate() -> Part:
    mesh = box_mesh((0, 0, 0), (20, 20, 2))
    colours = np.arange(36, dtype=np.uint32).reshape(12, 3) % 5 * 0x01020300 + 0xFF
    return Part(
        "plate & <tray>",
        mesh,
        800.0,
        quantity=2,
        regions=(
            Region("blocker", "rim", np.array([1, 3], np.int32)),
            Region("enforcer", "core", None, mesh),
        ),
        overrides=Overrides(overhang_angle_deg=30.0, supports=True),
        appearance=Appearance("#FF8000FF", "Ti64", colours),
        boxes=np.array([[0.0, 0, 0, 20, 20, 2]]),
        part_number="PN-7",
        source="plate.stl",
        notes=("turned inside out",),
        metadata={
            ("", "Designer"): "Ada",
            ("", "not a standard name"): "kept",
            ("http://example.com/shop", "order"): 'hä "4711"',
            ("http://schemas.amprep.dev/3mf/2026/11", "quantity"): "2",
        },
    )


def _bar() -> Part:
    turns = Orientations("list", np.stack([np.eye(3), QUARTER_TURN]))
    return replace(Part("bar", box_mesh((0.1, 0.2, 0.3), (7, 8, 9)), 504.0), value=3.0, orientations=turns)
