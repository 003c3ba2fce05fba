"""The colours of the meshes of a part become one appearance."""

import numpy as np
from tests.shared.optional import present

from amprep.threemf.read.colours import NO_COLOUR, MeshColours, appearance_of

RED, BLUE = 0xFF0000FF, 0x0000FFFF


def colours(*values, materials=()):
    return MeshColours(np.array([[value] * 3 for value in values]), frozenset(materials), incomplete=False)


def test_one_colour_everywhere_is_the_colour_of_the_part():
    found = appearance_of([colours(RED, RED, materials=["steel"]), colours(RED, materials=["steel"])])
    assert (found.colour, found.material, found.triangle_colours) == ("#FF0000FF", "steel", None)


def test_no_colour_anywhere_is_no_colour():
    assert appearance_of([colours(NO_COLOUR, NO_COLOUR)]).colour is None


def test_different_colours_are_kept_for_each_triangle_in_the_order_of_the_meshes():
    found = appearance_of([colours(RED, NO_COLOUR), colours(BLUE)])
    assert found.colour is None
    assert present(found.triangle_colours)[:, 0].tolist() == [RED, NO_COLOUR, BLUE]


def test_a_part_of_two_materials_has_no_material():
    assert (
        appearance_of([colours(RED, materials=["steel"]), colours(RED, materials=["brass"])]).material is None
    )
