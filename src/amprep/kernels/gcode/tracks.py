"""Add extruded lines and arcs to the tracks of their objects."""

import math

from amprep.arrays import Floats
from amprep.kernels.gcode.records import (
    HALF_WIDTH,
    HEIGHT,
    INFILL,
    LOWER,
    MOST_CHORDS,
    OUTER_WALL,
    ROLE,
    SEGMENTS,
    SLOT,
    SUPPORT,
    Machine,
    Tracks,
    X,
    Y,
    Z,
)
from amprep.kernels.helper import helper

_SAME = 1e-4
"""Heights (mm) that differ by less are the same."""
_GAP = 1.5
"""A layer so many times as thick as the one below may be above a gap."""
_SAGITTA = 0.01
"""Distance (mm) of the chords of an arc from it."""


@helper
def extrude(machine: Machine, tracks: Tracks, segments: Floats, x: float, y: float) -> None:
    """Extrude a straight line from the present position to (x, y) at the present height."""
    at, modes = machine.at, machine.modes
    role = modes[ROLE]
    row = 2 * modes[SLOT] + (1 if role == SUPPORT else 0)
    tracks.length[row, role] += math.hypot(x - at[X], y - at[Y])
    if role > SUPPORT:
        return
    if abs(at[Z] - at[HEIGHT]) > _SAME:
        at[HEIGHT], at[LOWER] = at[Z], at[HEIGHT]
    _enter_layer(tracks, row, at[Z], at[LOWER])
    half = at[HALF_WIDTH]
    extent = tracks.extent[row]
    extent[0] = min(extent[0], x - half, at[X] - half)
    extent[1] = min(extent[1], y - half, at[Y] - half)
    extent[2] = min(extent[2], at[Z])
    extent[3] = max(extent[3], x + half, at[X] + half)
    extent[4] = max(extent[4], y + half, at[Y] + half)
    extent[5] = max(extent[5], at[Z])
    if tracks.counts[row, 2] and role != INFILL and modes[SEGMENTS] < len(segments):
        segment = segments[modes[SEGMENTS]]
        segment[0], segment[1], segment[2] = row, tracks.layer[row, 0], tracks.layer[row, 1]
        segment[3], segment[4], segment[5], segment[6] = at[X], at[Y], x, y
        segment[7], segment[8] = half, 1.0 if role == OUTER_WALL else 0.0
        modes[SEGMENTS] += 1


@helper
def _enter_layer(tracks: Tracks, row: int, z: float, lower: float) -> None:
    """Begin a layer if the height is above the highest layer of the row so far.

    Where an object ends and begins again farther up, the layers of others between tell how thick its layer is.
    """
    layer, counts = tracks.layer[row], tracks.counts[row]
    if z <= layer[0] + _SAME and counts[0] > 0:
        return
    thickness = z - layer[0] if counts[0] > 0 else z
    if counts[0] > 0 and thickness > _GAP * layer[1] and layer[0] <= lower < z:
        thickness = z - lower
    if counts[0] > 0:
        layer[2] = max(layer[2], thickness)
    layer[0], layer[1] = z, thickness
    counts[0] += 1
    counts[2] = 0
    while counts[1] < len(tracks.heights) and tracks.heights[counts[1]] <= z:
        counts[1] += 1
        counts[2] = 1


@helper
def extrude_arc(
    machine: Machine,
    tracks: Tracks,
    segments: Floats,
    centre_x: float,
    centre_y: float,
    x: float,
    y: float,
    clockwise: bool,
) -> None:
    """Extrude the chords of an arc around a centre to (x, y) at the present height; the end may be the start."""
    at = machine.at
    radius = math.hypot(at[X] - centre_x, at[Y] - centre_y)
    begin = math.atan2(at[Y] - centre_y, at[X] - centre_x)
    sweep = math.atan2(y - centre_y, x - centre_x) - begin
    if clockwise and sweep >= -1e-9:
        sweep -= 2.0 * math.pi
    if not clockwise and sweep <= 1e-9:
        sweep += 2.0 * math.pi
    step = 2.0 * math.acos(max(1.0 - _SAGITTA / max(radius, _SAGITTA), 0.0))
    chords = min(max(math.ceil(abs(sweep) / max(step, 1e-6)), 1), MOST_CHORDS)
    for k in range(1, chords + 1):
        turn = begin + sweep * k / chords
        to_x = x if k == chords else centre_x + radius * math.cos(turn)
        to_y = y if k == chords else centre_y + radius * math.sin(turn)
        extrude(machine, tracks, segments, to_x, to_y)
        at[X], at[Y] = to_x, to_y
