"""Labels on parts: each copy with its own text, inside its wall, and verified as it is."""

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.solids import mesh_of
from tests.shared.supported import box

import amprep
from amprep.errors import InputError, JobError
from amprep.model import Part, Region
from amprep.pipeline.labelling.apply import labelled
from amprep.stl import write_stl

BLOCK = Part("block", mesh_of(box((30, 15, 8), (0, 0, 0))), 3600.0, quantity=3)
BALL = Part("ball", mesh_of(Manifold.sphere(10.0, 64)), 4180.0)


@pytest.fixture
def write(tmp_path):
    """Label parts by the rows of a list."""

    def make(parts, *rows):
        file = tmp_path / "labels.csv"
        file.write_text("\n".join(["part,copy,text,kind,face,depth_mm", *rows]) + "\n")
        return labelled(parts, file)

    return make


def test_a_text_for_all_copies_leaves_them_one_part(write):
    (made,) = write([BLOCK], "block,,V1,,,0.4")
    assert (made.name, made.quantity) == ("block", 3)
    assert 0.0 < 3600.0 - made.volume_mm3 < 12.0
    assert made.volume_mm3 == pytest.approx(made.mesh.signed_volume)
    assert "the SHA-256 of the part is that with its label" in made.notes[-1]


def test_copies_with_their_own_texts_become_parts_at_their_own_places(write):
    places = replace(BLOCK, fixed=np.array([[0.0, 0.0, 0.0], [50.0, 0.0, 0.0]]))
    made = write([places, BALL], "bl*,,S-{copy}/{copies},,,", "block,2,X,raised,top,0.6")
    assert [each.quantity for each in made] == [1, 1, 1, 1]
    assert len({each.mesh.digest for each in made}) == 4
    assert [None if each.fixed is None else each.fixed.tolist() for each in made[:3]] == [
        [[0.0, 0.0, 0.0]],
        [[50.0, 0.0, 0.0]],
        None,
    ]
    assert [each.mesh.bounds[1][2] for each in made[:3]] == pytest.approx([8.0, 8.6, 8.0])
    assert [len(each.notes) for each in made] == [1, 2, 1, 0]


@pytest.mark.parametrize(
    ("row", "error", "words"),
    [
        ("blok,,A,,,", JobError, r"row 2: no part is called 'blok' \(did you mean 'block'\?\)"),
        ("block,4,A,,,", JobError, "block has 3 copies, no copy 4"),
        (
            "ball,,A,,,",
            InputError,
            "no face of ball holds 'A' of .* mm: no flat face looks up or to the side",
        ),
        ("block,,ABCDEFGHIJ,,,", InputError, "the flat faces that look up or to the side are too small"),
        ("block,,A,,front,5", InputError, "no face of block holds .*"),
    ],
)
def test_labels_that_no_part_can_have_are_refused_by_name(write, row, error, words):
    thin = replace(BLOCK, mesh=mesh_of(box((30, 5.2, 8), (0, 0, 0))))
    with pytest.raises(error, match=words):
        write([thin if "front" in row else BLOCK, BALL], row)


def test_a_part_with_painted_triangles_is_refused(write):
    painted = replace(BLOCK, regions=(Region("blocker", "p", np.array([1], np.int32)),))
    with pytest.raises(InputError, match="block has painted triangles"):
        write([painted], "block,,A,,,")


def test_a_labelled_build_holds_every_promise_also_against_its_job(tmp_path):
    write_stl(BLOCK.mesh, tmp_path / "block.stl")
    (tmp_path / "labels.csv").write_text("part,text,kind\nblock,N-{copy},\nblock,UP,raised\n")
    job = 'printer = "EOS M290"\nlabels = "labels.csv"\ninputs = ["block.stl:2"]\n'
    job += '[packing]\nstrategy = "extreme-points"\nlift_mm = 0.0\n'
    job += "[supports]\nenabled = false\n"
    (tmp_path / "job.toml").write_text(job)
    loaded = amprep.load(tmp_path / "job.toml")
    assert [len(each.notes) for each in loaded.parts] == [2, 2]
    (build,) = amprep.pack(loaded).builds
    assert [each.label for each in build.parts] == ["block", "block-2"]
    file = amprep.write(amprep.emit_cells(amprep.plan_supports(build)), tmp_path / "job.build-1.3mf")
    assert amprep.verify(file, job=tmp_path / "job.toml").ok
