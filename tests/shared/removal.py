"""Bodies that can be taken apart, or not, made with manifold3d."""

import numpy as np
from manifold3d import CrossSection, Manifold
from tests.shared.solids import arrays

from amprep.geometry.removal.blocking import Blocking
from amprep.geometry.removal.bodies import CollisionShape, movable_body
from amprep.geometry.removal.order import DIRECTIONS


def box(low, high):
    size = np.subtract(high, low).tolist()
    return Manifold.cube(size).translate(list(low))


def ring(centre, axis, radius=10.0, thickness=2.0):
    """A torus about the axis x, y or z."""
    circle = [
        (radius + thickness * np.cos(a), thickness * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 17)[:-1]
    ]
    torus = Manifold.revolve(CrossSection([circle]), 32)
    turned = torus.rotate({"z": [0, 0, 0], "x": [0, 90, 0], "y": [90, 0, 0]}[axis])
    return turned.translate(list(centre))


def cup(height):
    """A conical cup with its opening upwards, whose bottom is at a height; cups 3 mm apart do not touch."""
    outside, inside = Manifold.cylinder(20, 5, 15, 32), Manifold.cylinder(20, 5, 15, 32).translate([0, 0, 2])
    return (outside - inside).translate([0, 0, height])


def drawer_case():
    """A case that is open towards +x only, with 1 mm around a drawer."""
    return box((0, 0, 0), (30, 20, 12)) - box((2, 2, 2), (40, 18, 10))


DRAWER = box((3, 3, 3), (29, 17, 9))


def hook_in_ring():
    """A ring in the plane x = 0, and a closed hook through it."""
    return [ring((0, 0, 0), "x"), ring((0, 10, 0), "z")]


def bayonet():
    """A plate with a T-slot open at one end, and a T-bolt in it: lifted in the slot or moved along it to leave."""
    case = box((0, 0, 0), (40, 30, 20)) - box((5, 5, 5), (35, 25, 12)) - box((5, 12, 12), (35, 18, 30))
    case -= box((24, 5, 12), (35, 25, 30))
    bolt = box((7, 7, 6), (15, 23, 11)) + box((9, 13, 11), (13, 17, 26))
    return [case, bolt]


def blocking_of(solids, directions=DIRECTIONS):
    shapes = [CollisionShape(*arrays(solid)) for solid in solids]
    return Blocking([movable_body([(shape, np.eye(4))]) for shape in shapes], directions)
