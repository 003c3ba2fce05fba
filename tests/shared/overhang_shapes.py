"""Made shapes whose overhangs are known by construction: kind, size, and whether the part starts in the air.

All shapes stand on the plate. Sizes follow from the dimensions that the shape is made of, never from the program.
"""

from collections.abc import Callable
from typing import NamedTuple

import manifold3d
import numpy as np

Solid = manifold3d.Manifold

FLAT = float(np.sin(np.radians(45)))
"""Width of the part of a circle that is flatter than 45 degrees, as a fraction of its diameter."""

PLATE = 0.06
"""Height up to which the shapes are on the plate in the tests."""


class Overhang(NamedTuple):
    """An overhang region: what it is, its size in mm, and whether the part starts in the air there.

    A knife edge that the part holds at one end is limited like a ledge, else like a bridge.
    """

    kind: str
    size: float
    starts: bool = False
    at_one_end: bool = False


class Shape(NamedTuple):
    """A solid on the plate with the overhangs that it has."""

    name: str
    make: Callable[[], manifold3d.Manifold]
    overhangs: tuple[Overhang, ...]


def box(size, corner=(0, 0, 0)):
    return Solid.cube(size).translate(corner)


def rod(diameter, length, sides=64):
    """A cylinder along x, in the middle of the coordinates; one of its sides is on top."""
    return Solid.cylinder(length, diameter / 2, diameter / 2, sides, True).rotate((0, 90, 0))


def prism(profile, length):
    """A prism along y from 0 with the profile given counter-clockwise in x and z."""
    section = manifold3d.CrossSection([np.asarray(profile, float)])
    return Solid.extrude(section, length).rotate((90, 0, 0)).translate((0, length, 0))


def block(side=30.0):
    return box((side, side, side), (-side / 2, -side / 2, 0))


def ledge(length, slope_deg=0.0, width=12.0):
    """A post with a shelf; its underside rises outwards at the angle given."""
    rise = length * np.tan(np.radians(slope_deg))
    shelf = [(-1, 15), (0, 15), (length, 15 + rise), (length, 24), (-1, 24)]
    return box((10, width, 24), (-10, 0, 0)) + prism(shelf, width)


def bridge(span, width=12.0):
    """A block with a rectangular opening."""
    return box((span + 12, width, 20), (-6, 0, 0)) - box((span, width + 2, 12), (0, -1, -1))


def sloping_bridge(span, slope_deg):
    """Two walls with a bar between them that rises from one to the other."""
    rise = span * np.tan(np.radians(slope_deg))
    walls = box((6, 10, 30), (-6, 0, 0)) + box((6, 10, 30), (span, 0, 0))
    return walls + prism(
        [(-1, 10), (0, 10), (span, 10 + rise), (span + 1, 10 + rise), (span + 1, 30), (-1, 30)], 10
    )


def bore(diameter, sides=64, tilt_deg=0.0, turn_deg=0.0, phase_deg=0.0):
    """A block with a bore through it, horizontal or tilted."""
    hole = Solid.cylinder(90, diameter / 2, diameter / 2, sides, True).rotate((0, 0, phase_deg))
    return block() - hole.rotate((0, 90 - tilt_deg, turn_deg)).translate((0, 0, 15))


def blind_bore(diameter, depth, sides=48):
    return block() - rod(diameter, 2 * depth, sides).translate((15, 0, 15))


def alcove(width, depth):
    """A recess in a wall with a flat ceiling: open in front and below."""
    return box((30, 20, 20), (-15, 0, 0)) - box((width, depth + 1, 12), (-width / 2, -1, -1))


def pocket(width, length):
    """A rectangular pocket from below."""
    return block() - box((width, length, 10), (-width / 2, -length / 2, -1))


def round_pocket(diameter, sides=96):
    return block() - Solid.cylinder(10, diameter / 2, diameter / 2, sides).translate((0, 0, -1))


def counterbore(diameter, hole, sides=96):
    """A counterbore from below with a hole through the block."""
    return round_pocket(diameter, sides) - Solid.cylinder(90, hole / 2, hole / 2, sides, True)


def countersink(angle_deg, wide, narrow, sides=96):
    """A countersink from below with a hole through the block."""
    depth = (wide - narrow) / 2 / np.tan(np.radians(angle_deg / 2))
    return (
        block()
        - Solid.cylinder(depth, wide / 2, narrow / 2, sides)
        - Solid.cylinder(90, narrow / 2, narrow / 2, sides, True)
    )


def corner_shelf(along_x, along_y):
    """A shelf in the inner corner of two walls."""
    walls = box((20, 5, 20), (-5, -5, 0)) + box((5, 20, 20), (-5, -5, 0))
    return walls + box((along_x + 1, along_y + 1, 6), (-1, -1, 14))


def dovetail_below(mouth, wide, depth):
    """A dovetail groove in the underside: its ceiling is wider than its mouth."""
    return block() - prism(
        [
            (-mouth / 2, -1),
            (mouth / 2, -1),
            (mouth / 2, 0),
            (wide / 2, depth),
            (-wide / 2, depth),
            (-mouth / 2, 0),
        ],
        60,
    ).translate((0, -30, 0))


def dovetail_beside(depth, angle_deg):
    """A dovetail groove in a side wall: its roof comes down towards the mouth at the angle given."""
    drop = depth * np.tan(np.radians(angle_deg))
    groove = [(15 - depth, 10 - drop), (15, 10), (16, 10), (16, 16), (15, 16), (15 - depth, 16 + drop)]
    return block() - prism(groove, 60).translate((0, -30, 0))


def t_slot_below(mouth, wide, depth):
    """A T-slot in the underside."""
    return block() - box((mouth, 60, 4), (-mouth / 2, -30, -1)) - box((wide, 60, depth), (-wide / 2, -30, 3))


def t_slot_beside(inner, lip):
    """A T-slot in a side wall: behind the lips, that are `lip` thick, it is `inner` deep."""
    slot = box((inner, 60, 10), (15 - lip - inner, -30, 10)) + box((lip + 2, 60, 4), (15 - lip - 1, -30, 13))
    return block() - slot


def hanging_block(reach, drop):
    """A post with an arm from whose end a block hangs down."""
    arm = box((10 + reach, 6, 6), (-10, 0, 20))
    return box((10, 6, 26), (-10, 0, 0)) + arm + box((3, 6, drop + 1), (reach - 3, 0, 20 - drop))


def chamfered(angle_deg, width):
    """A block whose lower edge along y is chamfered at an angle to the plate."""
    rise = width * np.tan(np.radians(angle_deg))
    return prism([(-10, 0), (0, 0), (width, rise), (width, 25), (-10, 25)], 20)


def rounded_edge(radius, steps=24):
    """A block whose lower edge along y is rounded."""
    angles = np.radians(np.linspace(0, 90, steps + 1))
    arc = [(radius * np.sin(a), radius * (1 - np.cos(a))) for a in angles]
    return prism([(-10, 0), *arc, (radius, 25), (-10, 25)], 20)


def cove(radius, more, steps=24):
    """A ledge on a cove: a concave quarter circle between wall and ceiling."""
    angles = np.radians(np.linspace(0, 90, steps + 1))
    arc = [(radius * (1 - np.cos(a)), 10 + radius * np.sin(a)) for a in angles]
    return prism([(-10, 0), (0, 0), *arc, (radius + more, 10 + radius), (radius + more, 25), (-10, 25)], 20)


def opening(profile):
    """A block with an opening of the profile, counter-clockwise in x and z from its feet at z = 0."""
    low = [(profile[0][0], -1.0), (profile[-1][0], -1.0)]
    return block() - prism([low[1], *reversed([*profile]), low[0]][::-1], 60).translate((0, -30, 0))


def arc_points(centre, radius, start_deg, end_deg, steps=32):
    angles = np.radians(np.linspace(start_deg, end_deg, steps + 1))
    return [(centre[0] + radius * np.cos(a), centre[1] + radius * np.sin(a)) for a in angles]


def arch(diameter, spring=6.0):
    """A semicircular arch."""
    return opening(arc_points((0, spring), diameter / 2, 0, 180))


def segmental_arch(chord, rise, spring=8.0):
    """A flat arch."""
    radius = (chord**2 / 4 + rise**2) / (2 * rise)
    half = float(np.degrees(np.arcsin(chord / 2 / radius)))
    return opening(arc_points((0, spring + rise - radius), radius, 90 - half, 90 + half))


def rounded_opening(width, radius):
    """A rectangular opening with rounded upper corners."""
    right = arc_points((width / 2 - radius, 8), radius, 0, 90, 16)
    left = arc_points((radius - width / 2, 8), radius, 90, 180, 16)
    return opening([*right, *left])


def gable_opening(width, angle_deg):
    """An opening with a roof of two planes."""
    return opening([(width / 2, 8), (0, 8 + width / 2 * np.tan(np.radians(angle_deg))), (-width / 2, 8)])


def chamfered_opening(width, chamfer):
    """An opening with a flat ceiling between two planes of 45 degrees."""
    half = width / 2
    return opening([(half, 8), (half - chamfer, 8 + chamfer), (chamfer - half, 8 + chamfer), (-half, 8)])


def table(side, pin, sides=64):
    """A square plate on a round pin in its middle."""
    return box((side, side, 4), (-side / 2, -side / 2, 16)) + Solid.cylinder(17, pin / 2, pin / 2, sides)


def four_legs(side, leg):
    """A square plate on legs at its corners."""
    legs = [box((leg, leg, 17), (x, y, 0)) for x in (0, side - leg) for y in (0, side - leg)]
    return Solid.batch_boolean([box((side, side, 4), (0, 0, 16)), *legs], manifold3d.OpType.Add)


def frustum(low, high, angle_deg, sides=96):
    """A cone that widens upwards from the plate at an angle to it."""
    height = (high - low) / 2 * np.tan(np.radians(angle_deg))
    return Solid.cylinder(height, low / 2, high / 2, sides) + Solid.cylinder(
        5, high / 2, high / 2, sides
    ).translate((0, 0, height))


def ball(diameter, lift=0.0, sides=320):
    return Solid.sphere(diameter / 2, sides).translate((0, 0, diameter / 2 + lift))


def lying_cylinder(diameter, length=15.0, sides=160):
    return rod(diameter, length, sides).translate((0, 0, diameter / 2))


def cavity(diameter, sides=64):
    return block() - Solid.sphere(diameter / 2, sides).translate((0, 0, 15))


def dome(diameter, sides=64):
    return block() - Solid.sphere(diameter / 2, sides)


def bar(span, section):
    """Two walls with a bar of the section given (around the x axis) between them."""
    walls = box((6, 16, 20), (-6, -8, 0)) + box((6, 16, 20), (span, -8, 0))
    return walls + section(span + 2).translate((-1, 0, 12))


def square_section(side):
    return lambda length: box((length, side, side), (0, -side / 2, -side / 2))


def round_section(diameter, sides=48):
    return lambda length: rod(diameter, length, sides).translate((length / 2, 0, 0))


def keel_section(width, angle_deg):
    """A triangle with its point downwards, whose sides are at an angle to the plate."""
    drop = width / 2 * np.tan(np.radians(angle_deg))
    profile = [(0, -drop), (width / 2, 0), (-width / 2, 0)]
    return lambda length: prism(profile, length).rotate((0, 0, -90)).translate((0, 0, 0))


def keel(length, angle_deg):
    """A post with an arm that has a knife edge below."""
    return box((10, 10, 20), (-10, -5, 0)) + keel_section(4, angle_deg)(length + 1).translate((-1, 0, 14))


def tilted_block(side, angle_deg):
    """A block that stands on one of its edges: a side is at the angle given to the plate."""
    turned = box((side, 12, 12), (0, -6, 0)).rotate((0, -angle_deg, 0))
    return turned.translate((0, 0, -turned.bounding_box()[2]))


def engraved(depth, stroke):
    """A wall with the letter H engraved."""
    bars = [(-6, 8, stroke, 12), (6 - stroke, 8, stroke, 12), (-6, 13, 12, 2)]
    letters = [box((w, depth + 1, h), (x, -15 - 1, z)) for x, z, w, h in bars]
    return block() - Solid.batch_boolean(letters, manifold3d.OpType.Add)


def v_groove(depth, angle_deg):
    """A horizontal V-shaped groove in a side wall; its faces are at an angle to the plate."""
    rise = depth * np.tan(np.radians(angle_deg))
    return block() - prism(
        [(15 - depth, 15), (16, 15 - rise * (depth + 1) / depth), (16, 15 + rise * (depth + 1) / depth)], 60
    ).translate((0, -30, 0))


def grooved_pin(diameter, depth, angle_deg, count=3):
    """An upright pin with rings whose undersides are at an angle to the plate."""
    rise = depth * np.tan(np.radians(angle_deg))
    parts = [Solid.cylinder(30, diameter / 2, diameter / 2, 96)]
    for number in range(count):
        z = 6.0 + 7.0 * number
        ring = Solid.cylinder(rise, diameter / 2, diameter / 2 + depth, 96).translate((0, 0, z))
        parts += [ring, Solid.cylinder(3, diameter / 2 + depth, diameter / 2, 96).translate((0, 0, z + rise))]
    return Solid.batch_boolean(parts, manifold3d.OpType.Add)


def plate_contact(radius):
    """Half of the width in which a cylinder or ball of the radius is on the plate."""
    return float(np.sqrt(2 * radius * PLATE - PLATE**2))
