"""Overhangs and connectors are the same however finely the planes of a part are triangulated."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.layouts import box, placed

from amprep.geometry.meshes.decimation import merge_coplanar
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model import Part, Region
from amprep.model.supports.rules import SupportRules
from amprep.overhangs.of_part import MANY_TRIANGLES, overhangs_of

TABLE = box((30, 20, 3), (0, 0, 12)) + box((6, 6, 12), (2, 7, 0)) + box((3, 20, 5), (27, 0, 7))
FINE = TABLE.refine_to_length(0.9)
LIMITS = SupportRules(rules="limits", ledge_mm=2.0, bridge_mm=4.0, bore_mm=10.0)


def needed(found):
    """Regions, and the volume between the faces that need support and the plate."""
    corners = found.mesh.vertices[found.mesh.triangles[found.overhangs.faces]]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] / 2
    return found.overhangs.regions, float((-cross * corners[:, :, 2].mean(axis=1)).sum())


@pytest.mark.parametrize("rules", [SupportRules(), LIMITS], ids=["thesis", "limits"])
def test_a_finer_triangulation_has_the_overhangs_of_a_plain_one(rules):
    (plain,), (fine,) = placed(TABLE), placed(FINE)
    assert len(fine.mesh.triangles) > MANY_TRIANGLES
    (regions, space), (finer, finer_space) = (needed(overhangs_of(each, rules)) for each in (plain, fine))
    assert len(overhangs_of(fine, rules).mesh.triangles) < len(fine.mesh.triangles) / 2
    assert finer_space == pytest.approx(space, rel=1e-9 if rules is not LIMITS else 0.02)
    assert [(each.kind, each.starts_in_air) for each in finer] == [
        (each.kind, each.starts_in_air) for each in regions
    ]


def test_triangles_of_marked_regions_keep_their_numbers():
    (fine,) = placed(FINE)
    down = np.flatnonzero((fine.mesh.vertices[fine.mesh.triangles][:, :, 2] == 12.0).all(axis=1))
    part: Part = replace(fine.part, regions=(Region("blocker", "off", down.astype(np.int32)),))
    found = overhangs_of(replace(fine, part=part), SupportRules())
    heights = found.mesh.vertices[found.mesh.triangles[found.overhangs.faces]][:, :, 2]
    assert len(heights)
    assert (heights == 7.0).all()


def test_merging_changes_no_solid_and_leaves_curved_faces_alone():
    from manifold3d import Manifold

    for solid in (FINE, Manifold.sphere(5.0, 64) + Manifold.cube((20, 3, 3)).refine_to_length(0.5)):
        mesh = solid.to_mesh64()
        found = merge_coplanar(mesh.vert_properties[:, :3], mesh.tri_verts.astype(np.int64))
        assert found is not None
        merged = as_manifold(*found)
        assert merged.num_tri() < solid.num_tri()
        assert merged.volume() == pytest.approx(solid.volume(), rel=1e-12)
        assert (merged - solid).volume() == pytest.approx(0.0, abs=1e-6)
        assert (solid - merged).volume() == pytest.approx(0.0, abs=1e-6)


def test_a_surface_is_not_merged():
    assert merge_coplanar(np.eye(3), np.array([[0, 1, 2]])) is None
