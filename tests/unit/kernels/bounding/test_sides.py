"""Components on both sides of a plane are those of the graph of the edges."""

import networkx as nx
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.convex_solids import SOLIDS, part_of
from tests.shared.examples import examples

from amprep.geometry.bounding.convex.cells import edges_of
from amprep.kernels.bounding.sides import label_sides


@given(st.sampled_from(sorted(SOLIDS)), st.integers(0, 10**6))
@examples(40)
def test_components_and_sections_are_those_of_the_graph(name, seed):
    vertices, triangles = part_of(SOLIDS[name]()).mesh.arrays
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=3) if seed % 2 else np.eye(3)[seed % 3]
    height = vertices @ normal - vertices[seed % len(vertices)] @ normal
    edges = edges_of(triangles)
    label, owner = np.empty(len(vertices), np.int64), np.empty(2 * len(edges), np.int64)
    section = np.empty((2 * len(edges), 3))
    count = label_sides(vertices, edges, height, label, section, owner)
    below = height < 0.0
    graph = nx.Graph()
    graph.add_nodes_from(range(len(vertices)))
    graph.add_edges_from(edges[below[edges[:, 0]] == below[edges[:, 1]]])
    components = list(nx.connected_components(graph))
    assert len(set(label.tolist())) == len(components)
    assert all(set(label[list(component)]) == {min(component)} for component in components)
    crossing = edges[below[edges[:, 0]] != below[edges[:, 1]]]
    assert count == 2 * len(crossing)
    assert sorted(owner[:count].tolist()) == sorted(label[crossing].ravel().tolist())
    scale = np.abs(vertices).max()
    assert np.allclose(section[:count] @ normal, vertices[seed % len(vertices)] @ normal, atol=1e-9 * scale)
