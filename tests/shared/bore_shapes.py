"""Made shapes with bores of other sections, pockets and shelves, whose overhangs are known by construction."""

import manifold3d
import numpy as np
from tests.shared.overhang_shapes import (
    FLAT,
    PLATE,
    Overhang,
    Shape,
    Solid,
    arc_points,
    block,
    bore,
    box,
    opening,
    prism,
)


def profile_bore(profile):
    """A block with a horizontal bore of the profile, in x and z about its axis."""
    return block() - prism([(x, 15 + z) for x, z in profile], 60).translate((0, -30, 0))


def polygon(diameter, sides, *, flat_above):
    """The corners of a regular polygon in a circle."""
    angle = np.pi / 2 + 2 * np.pi * (np.arange(sides) + (0.5 if flat_above else 0.0)) / sides
    return list(diameter / 2 * np.column_stack([np.cos(angle), np.sin(angle)]))


def octagon(across_flats):
    """A bore of eight sides, with a flat above."""
    return profile_bore(polygon(across_flats / np.cos(np.pi / 8), 8, flat_above=True))


def dodecagon(diameter):
    """A bore of twelve sides, with a corner above."""
    return profile_bore(polygon(diameter, 12, flat_above=False))


def taper(narrow, wide, length=12.0):
    """A block with an opening that becomes wider from one end to the other."""
    outline = [
        (-narrow / 2, -1e-3),
        (narrow / 2, -1e-3),
        (wide / 2, length + 1e-3),
        (-wide / 2, length + 1e-3),
    ]
    gap = manifold3d.CrossSection([np.array(outline)])
    return box((40, length, 20), (-20, 0, 0)) - Solid.extrude(gap, 13).translate((0, 0, -1))


def steep_bore(diameter, tilt_deg):
    """A thick wall with a steep bore."""
    hole = Solid.cylinder(60, diameter / 2, diameter / 2, 36, True).rotate((0, 90 - tilt_deg, 0))
    return box((10, 30, 30), (-5, -15, 0)) - hole.translate((0, 0, 15))


def teardrop(diameter, roof_deg, flat=0.0):
    """A round bore with a roof of two planes, cut off by a flat of the width given."""
    radius, slope = diameter / 2, np.radians(roof_deg)
    top = radius / np.cos(slope) - flat / 2 * np.tan(slope)
    roof = [(flat / 2, top), (-flat / 2, top)] if flat else [(0.0, top)]
    return profile_bore([*arc_points((0, 0), radius, 90 + roof_deg, 450 - roof_deg, 64), *roof])


def pointed_arch(width, spring=8):
    """An opening under two arcs around the feet of one another."""
    right = arc_points((-width / 2, spring), width, 0, 60, 40)
    return opening([*right, *arc_points((width / 2, spring), width, 120, 180, 40)[1:]])


def pocket_below(outline, depth=8):
    """A pocket from below with the outline given."""
    return block() - Solid.extrude(outline, depth + 1).translate((0, 0, -1))


def hexagon(across_flats):
    return manifold3d.CrossSection([polygon(across_flats / np.cos(np.pi / 6), 6, flat_above=True)])


def slot(width, length):
    return manifold3d.CrossSection.square((width, length), True)


def shelf(outline):
    """A wall with a shelf of the outline in plan; the wall ends at x = 0."""
    section = manifold3d.CrossSection([np.asarray(outline, float)])
    return box((8, 40, 24), (-8, -20, 0)) + Solid.extrude(section, 6).translate((0, 0, 12))


def stepped_bore(narrow, wide):
    """A bore that is wider in one half of the block."""
    holes = [(narrow, 60, 0), (wide, 20, 15)]
    solid = block()
    for diameter, length, x in holes:
        hole = Solid.cylinder(length, diameter / 2, diameter / 2, 64, True).rotate((0, 90, 0))
        solid -= hole.translate((x, 0, 15))
    return solid


def _shapes():
    """Yield all shapes."""
    for across in (4.0, 6.0, 9.6, 12.0):
        width = across * np.tan(np.pi / 8)
        yield f"octagonal bore of {across}", lambda across=across: octagon(across), [("bridge", width)]
    yield "pointed octagon", lambda: profile_bore(polygon(9, 8, flat_above=False)), [("bore", 9.0)]
    yield "hexagonal bore", lambda: profile_bore(polygon(6, 6, flat_above=True)), [("bridge", 3.0)]
    yield "twelve sides", lambda: profile_bore(polygon(8.5, 12, flat_above=True)), [("bore", 8.5)]
    yield "diamond", lambda: profile_bore(polygon(6, 4, flat_above=False)), []
    yield "teardrop of 45 degrees", lambda: teardrop(8, 45), []
    yield "teardrop of 40 degrees", lambda: teardrop(8, 40), [("bore", 8.0)]
    yield "teardrop with a flat", lambda: teardrop(9, 46, 2.2), [("bridge", 2.2)]
    yield "teardrop with a wide flat", lambda: teardrop(14, 46, 4.6), [("bridge", 4.6)]
    for tilt in (10, 25):
        yield f"bore tilted by {tilt}", lambda tilt=tilt: bore(6.2, 36, tilt, 11), [("bore", 6.2)]
    side = 3.1 * (np.sin(np.radians(40)) - np.sin(np.radians(20)))
    edges = [("edge", side, False, True)] * 2
    yield "steep bore", lambda: steep_bore(6.2, 40), [("bore", 6.2), *edges]
    yield "twelve sides with a corner above", lambda: dodecagon(6.5), [("bore", 6.5)]
    for wide in (3.4, 5.0):
        yield f"bridge that widens to {wide}", lambda wide=wide: taper(wide - 1.4, wide), [("bridge", wide)]
    yield "stepped bore", lambda: stepped_bore(4.4, 8.8), [("bore", 4.4), ("bore", 8.8)]
    yield "pointed arch", lambda: pointed_arch(5), [("bore", 2 * (5 * FLAT - 2.5) / FLAT)]
    cross = slot(3, 20) + slot(20, 3)
    yield "pocket like a cross", lambda: pocket_below(cross), [("bridge", 3 * np.sqrt(2))]
    yield "hexagonal pocket", lambda: pocket_below(hexagon(5.5)), [("bridge", 5.5)]
    hole = Solid.cylinder(90, 1.5, 1.5, 48, True)
    rim = 2.75 - 1.5 * np.cos(np.radians(30))
    yield "trap of a nut", lambda: pocket_below(hexagon(5.5)) - hole, [("ledge", rim)]
    triangle = [(-1, -5), (0, -5), (3, 0), (0, 5), (-1, 5)]
    yield "shelf like a triangle", lambda: shelf(triangle), [("ledge", 3.0)]
    half = [(-1, -2.5), *arc_points((0, 0), 2.5, -90, 90, 40), (-1, 2.5)]
    yield "shelf like half a circle", lambda: shelf(half), [("ledge", 2.5)]
    inner = PLATE * np.tan(np.radians(50))
    sink = Solid.cylinder(2.5 / np.tan(np.radians(50)), 4, 1.5, 96) + Solid.cylinder(90, 1.5, 1.5, 96, True)
    yield "countersink of 100 degrees", lambda: block() - sink, [("ledge", 2.5 - inner)]


SHAPES = tuple(Shape(name, make, tuple(Overhang(*each) for each in found)) for name, make, found in _shapes())
