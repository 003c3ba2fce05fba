"""What is changed after the packer, and the notes on it."""

import numpy as np
import pytest
from tests.shared.removal import hook_in_ring
from tests.shared.solids import mesh_of

from amprep.job import PackingSettings
from amprep.model import BuildVolume, Item, Packing, PackingProblem, Part, Placement, Solid, Stop
from amprep.pipeline.packing.adjusting import adjusted

MESHES = [mesh_of(solid) for solid in hook_in_ring()]
PARTS = [Part(name, mesh, 1.0) for name, mesh in zip(("hook", "ring"), MESHES, strict=True)]
PROBLEM = PackingProblem(
    tuple(Item(k, 0, Solid(mesh), 1.0) for k, mesh in enumerate(MESHES)),
    BuildVolume(np.full(3, 60.0)),
    "height",
)
PACKING = Packing((tuple(Placement(k, np.eye(3), np.full(3, 13.0)) for k in range(2)),))


def test_a_packing_is_returned_as_it_is_unless_the_job_asks_for_more():
    packing, notes = adjusted(PROBLEM, PACKING, PARTS, PackingSettings(stacking=True), Stop())
    assert packing is PACKING
    assert notes == ()


def test_notes_name_the_parts_that_moved_and_the_gain():
    settings = PackingSettings(stacking=True, interlocking="forbid", even_layers=True)
    packing, notes = adjusted(PROBLEM, PACKING, PARTS, settings, Stop())
    assert notes[0] == "1 locked part placed elsewhere or unplaced, because interlocking is forbidden: hook"
    assert len(notes) > 1
    assert all("variation of the cross-sections" in note for note in notes[1:])
    assert packing is not PACKING


def test_layers_without_stacking_are_refused():
    with pytest.raises(ValueError, match="even_layers = true must come with stacking = true"):
        PackingSettings(stacking=False, even_layers=True)
