"""Small cells, requests and blocks of copies that several tests use."""

from itertools import product

import numpy as np

from amprep.geometry.cells.tiling import Tiles, tile
from amprep.host import Host, Listed
from amprep.model import (
    CellRequest,
    GraphCell,
    Grid,
    MeshCell,
    Role,
    Stop,
    SupportEdges,
    silent,
)
from amprep.testing.problems import box_mesh

PIN = GraphCell([[0.5, 0.5, 0], [0.5, 0.5, 1]], [[0, 1]], 0.4)
POST = MeshCell(box_mesh(np.array([0.25, 0.25, 0.0]), np.array([0.75, 0.75, 1.0])))
FRAME = Grid(np.zeros(3), 2.0, 2.0, (9, 9, 9))
PITCH = 2.0


def request(plane, direction=0, role=Role.TRUNK, load=1):
    """Edges side by side, two squares apart."""
    count = len(plane)
    columns = (plane, 1, 2 * np.arange(count), direction, load, load, 0, 0)
    edges = SupportEdges(*(np.broadcast_to(each, count) for each in columns))
    return CellRequest(FRAME, edges, np.broadcast_to(role, count))


def emitted(offer, asked, **table):
    """Answer of an offer with the parameters of a table."""
    host = Host.load(plugins_enabled=False)
    listed = Listed("cell", offer, "test")
    return host.call(listed, asked, params=host.params(listed, table), stop=Stop(), progress=silent)


def sheared(dx=0, dy=0, step=PITCH):
    """Linear part of the map of an edge to mm."""
    linear = np.diag([PITCH, PITCH, step])
    linear[:2, 2] = -dx * PITCH, -dy * PITCH
    return linear


def tiled(arrays, linear, count=2):
    """Closed meshes of a block of copies."""
    place = np.array(list(product(range(count), repeat=3)))
    matrix = np.concatenate([np.tile(linear, (len(place), 1, 1)), (place @ linear.T)[:, :, None]], axis=2)
    return list(tile([arrays], Tiles(np.zeros(len(place), np.int64), place, matrix)))
