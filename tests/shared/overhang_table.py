"""The table of made shapes with the overhangs that each has."""

import numpy as np
from tests.shared.overhang_shapes import (
    FLAT,
    PLATE,
    Overhang,
    Shape,
    alcove,
    arch,
    ball,
    bar,
    blind_bore,
    bore,
    bridge,
    cavity,
    chamfered,
    chamfered_opening,
    corner_shelf,
    counterbore,
    countersink,
    cove,
    dome,
    dovetail_below,
    dovetail_beside,
    engraved,
    four_legs,
    frustum,
    gable_opening,
    grooved_pin,
    hanging_block,
    keel,
    keel_section,
    ledge,
    lying_cylinder,
    plate_contact,
    pocket,
    round_pocket,
    round_section,
    rounded_edge,
    rounded_opening,
    segmental_arch,
    sloping_bridge,
    square_section,
    t_slot_below,
    t_slot_beside,
    table,
    tilted_block,
    v_groove,
)


def _shapes():
    """Yield all shapes."""
    for length in (0.2, 0.5, 0.9, 1.0, 1.1, 2.0, 2.1, 3.0, 6.0):
        yield f"ledge of {length}", lambda length=length: ledge(length), [("ledge", length)]
    yield "ledge that rises outwards", lambda: ledge(1.8, 25), [("ledge", 1.8)]
    yield "ledge that comes down outwards", lambda: ledge(1.8, -25), [("ledge", 1.8, True)]
    yield "ledge that comes down by half a layer", lambda: ledge(1.8, -0.6), [("ledge", 1.8)]
    for span in (1.0, 1.9, 2.1, 3.9, 4.0, 4.1, 5.0, 10.0):
        yield f"bridge of {span}", lambda span=span: bridge(span), [("bridge", span)]
    yield "sloping bridge", lambda: sloping_bridge(3.8, 25), [("bridge", 3.8)]
    for diameter in (2.0, 3.9, 5.9, 7.9, 8.1, 9.9, 10.1, 12.0, 20.0):
        yield f"bore of {diameter}", lambda diameter=diameter: bore(diameter), [("bore", diameter)]
    for sides in (12, 16, 20, 24, 32, 128):
        yield f"bore of {sides} sides", lambda sides=sides: bore(3.9, sides), [("bore", 3.9)]
        yield (
            f"bore of {sides} sides, flat above",
            lambda sides=sides: bore(7.0, sides, phase_deg=180 / sides),
            [("bore", 7.0)],
        )
    yield "tilted bore", lambda: bore(3.9, 48, 20), [("bore", 3.9)]
    yield "bore tilted and turned", lambda: bore(9.0, 48, 30, 17), [("bore", 9.0)]
    yield "turned bore", lambda: bore(5.0, 40, 0, 33), [("bore", 5.0)]
    yield "blind bore", lambda: blind_bore(3.9, 12), [("bore", 3.9)]
    yield "narrow alcove", lambda: alcove(3.0, 5.0), [("bridge", 3.0)]
    yield "shallow alcove", lambda: alcove(8.0, 1.5), [("ledge", 1.5)]
    yield "square pocket", lambda: pocket(3.9, 3.9), [("bridge", 3.9)]
    yield "long pocket", lambda: pocket(3.0, 14.0), [("bridge", 3.0)]
    yield "round pocket", lambda: round_pocket(3.8), [("bridge", 3.8)]
    yield "counterbore", lambda: counterbore(8.0, 5.0), [("ledge", 1.5)]
    yield "wide counterbore", lambda: counterbore(14.0, 5.0), [("ledge", 4.5)]
    yield "countersink of 82 degrees", lambda: countersink(82, 10, 4), []
    yield "countersink of 90 degrees", lambda: countersink(90, 10, 4), []
    inner = PLATE * np.tan(np.radians(60))
    yield "countersink of 120 degrees", lambda: countersink(120, 7, 4), [("ledge", 1.5 - inner)]
    yield "corner shelf", lambda: corner_shelf(1.8, 3.0), [("ledge", 1.8)]
    yield "large corner shelf", lambda: corner_shelf(5.0, 6.0), [("ledge", 5.0)]
    yield "dovetail groove below", lambda: dovetail_below(2, 3.8, 2.5), [("bridge", 3.8)]
    yield "dovetail groove beside", lambda: dovetail_beside(1.7, 30), [("ledge", 1.7, True)]
    yield "T-slot below", lambda: t_slot_below(2, 6, 3), [("bridge", 6.0)]
    yield "T-slot beside", lambda: t_slot_beside(3.5, 2.0), [("bridge", 3.5), ("flat", 0.0, True)]
    yield "hanging block", lambda: hanging_block(8, 6), [("bridge", 5.0), ("flat", 0.0, True)]
    yield "chamfer of 45 degrees", lambda: chamfered(45, 4), []
    yield "chamfer of 30 degrees", lambda: chamfered(30, 3), [("ledge", 3 - PLATE / np.tan(np.radians(30)))]
    yield "rounded edge", lambda: rounded_edge(2.0, 48), [("ledge", 2 * FLAT - plate_contact(2.0))]
    yield "cove", lambda: cove(2.0, 0.5, 48), [("ledge", 2 * FLAT + 0.5)]
    yield "arch", lambda: arch(8.2), [("bore", 8.2)]
    yield "flat arch", lambda: segmental_arch(6, 0.3), [("bridge", 6.0)]
    yield "opening with rounded corners", lambda: rounded_opening(6, 1), [("bridge", 4 + 2 * FLAT)]
    yield "rounded opening", lambda: rounded_opening(5, 2), [("bore", (1 + 4 * FLAT) / FLAT)]
    yield "gable of 30 degrees", lambda: gable_opening(4, 30), [("bore", 4 / FLAT)]
    yield "gable of 50 degrees", lambda: gable_opening(4, 50), []
    yield "chamfered opening", lambda: chamfered_opening(6, 1.5), [("bridge", 3.0)]
    yield "table on a pin", lambda: table(20, 4), [("ledge", 10 * np.sqrt(2) - 2)]
    yield "table on four legs", lambda: four_legs(20, 3), [("bridge", 14 * np.sqrt(2))]
    start = PLATE / np.tan(np.radians(30))
    yield "cone", lambda: frustum(6, 10, 30), [("ledge", 2 - start)]
    yield "ball on the plate", lambda: ball(10), [("ledge", 5 * FLAT - plate_contact(5.0))]
    yield "ball in the air", lambda: ball(10, 3), [("flat", 0.0, True)]
    side = 5 * FLAT - plate_contact(5.0)
    yield "lying cylinder", lambda: lying_cylinder(10), [("ledge", side)] * 2
    yield "cavity", lambda: cavity(5), [("bore", 5.0)]
    yield "dome", lambda: dome(9), [("bore", 9.0)]
    yield "square bar", lambda: bar(8, square_section(3)), [("bridge", 8.0)]
    yield "round bar", lambda: bar(6, round_section(3)), [("bridge", 6.0)]
    yield "knife edge between walls", lambda: bar(3.5, keel_section(4, 60)), [("edge", 3.5)]
    yield "long knife edge between walls", lambda: bar(9, keel_section(4, 60)), [("edge", 9.0)]
    yield "knife edge of an arm", lambda: keel(1.7, 60), [("edge", 1.7, False, True)]
    lift = 12 * np.cos(np.radians(30)) - PLATE / np.tan(np.radians(30))
    yield "tilted block", lambda: tilted_block(12, 30), [("ledge", lift)]
    yield "engraved letter", lambda: engraved(0.45, 3), [("ledge", 0.45)] * 3
    yield "rib", lambda: ledge(5, width=0.6), [("ledge", 5.0)]
    yield "V-groove", lambda: v_groove(1.6, 30), [("ledge", 1.6)]
    yield "V-groove of 90 degrees", lambda: v_groove(3, 45), []
    yield "rings", lambda: grooved_pin(10, 0.8, 30), [("ledge", 0.8)] * 3


SHAPES = tuple(Shape(name, make, tuple(Overhang(*each) for each in found)) for name, make, found in _shapes())
