"""A file that lib3mf refuses is read by trimesh, with a note; anything else is refused in one line."""

import io
import zipfile
from pathlib import Path

import pytest

from amprep.errors import InputError
from amprep.threemf.package.open import Package, open_package
from amprep.threemf.read.fallback import read_by_trimesh

FIXTURES = Path(__file__).parents[4] / "fixtures"


def package_of(model: str) -> Package:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("3D/3dmodel.model", model)
    return Package(stream.getvalue(), b"", b"", frozenset(), ("repaired",), {})


def test_shapes_and_names_are_read_and_the_first_part_says_why():
    path = FIXTURES / "demo" / "demo.3mf"
    parts = read_by_trimesh(open_package(path), path, refusal="invalid attribute")
    assert len(parts) == 12
    assert parts[0].notes == (
        "lib3mf refuses this file (invalid attribute); read by trimesh: shapes and names only",
    )
    assert all(part.notes == () for part in parts[1:])
    assert max(part.mesh.bounds[1][2] for part in parts) == pytest.approx(71.0, abs=1.0)


@pytest.mark.parametrize("model", ["<model/>", "no XML at all"])
def test_a_file_that_trimesh_cannot_read_either_is_refused_with_both_reasons(model):
    with pytest.raises(
        InputError, match=r"a\.3mf: lib3mf refuses this file \(too old\), and trimesh"
    ) as caught:
        read_by_trimesh(package_of(model), Path("a.3mf"), refusal="too old")
    assert "\n" not in str(caught.value)
