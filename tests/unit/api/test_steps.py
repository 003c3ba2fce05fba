"""The public API: steps give the same build as a whole run; settings are checked like those of a job file."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from tests.shared.optional import present

import amprep
from amprep.errors import AmprepError, InputError, JobError, PluginError
from amprep.model import Mesh, Part, Stop
from amprep.testing.problems import box_mesh

FIXTURES = Path(__file__).parents[3] / "fixtures"
TABLE = FIXTURES / "table.stl"
COARSE = {"pitch_mm": 4, "reach_mm": 5}


def test_importing_amprep_imports_nothing_heavy():
    code = "import sys; before = set(sys.modules); import amprep; print(*set(sys.modules) - before)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.split(".")[0] for name in done.stdout.split()}
    heavy = {
        "numpy",
        "scipy",
        "numba",
        "trimesh",
        "manifold3d",
        "lib3mf",
        "lxml",
        "networkx",
        "typer",
        "rich",
    }
    assert "amprep" in loaded
    assert loaded & (heavy | {"pluggy", "PIL", "pulp"}) == set()


def test_every_public_name_exists_and_is_documented():
    for name in amprep.__all__:
        assert name == "__version__" or getattr(amprep, name).__doc__, name
    assert set(amprep.__all__) == set(dir(amprep))
    with pytest.raises(AttributeError, match="nothing"):
        amprep.nothing  # noqa: B018


def test_the_steps_give_the_same_build_job_as_a_whole_run(tmp_path):
    settings = {"supports.pitch_mm": 4, "supports.reach_mm": 5, "cells.strategy": "prism"}
    record = amprep.run(f"{TABLE}:2", output=tmp_path / "run", settings=settings)
    packed = amprep.pack(amprep.load(f"{TABLE}:2"))
    planned = amprep.plan_supports(packed.builds[0], pitch_mm=4, reach_mm=5, cell="prism")
    supported = amprep.emit_cells(planned)
    path = amprep.write(supported, tmp_path / "steps" / "table.build-1.3mf")
    assert record.builds[0].file == path.name
    assert path.read_bytes() == (tmp_path / "run" / path.name).read_bytes()
    assert amprep.verify(path).ok
    assert amprep.verify(supported).ok


def test_parts_are_filled_with_cells_and_the_files_are_named_after_the_output_file(tmp_path):
    cube = tmp_path / "cube.stl"
    trimesh.creation.box((16, 16, 16)).export(cube)
    settings = {"cells.strategy": "strut", "cells.density_g_cm3": 4.0}
    record = amprep.fill_parts(cube, output=tmp_path / "out" / "light.3mf", shell_mm=2, settings=settings)
    assert record.files == ("light.3mf", "light.png", "light.report.json")
    assert {path.name for path in (tmp_path / "out").iterdir()} == set(record.files)
    (part,) = record.parts
    assert part.mass_g(part.volume_mm3) == pytest.approx(0.004 * part.filled.mesh.signed_volume)
    assert part.volume_mm3 < part.part.volume_mm3
    assert record.faults == 0


def test_a_build_that_breaks_a_promise_is_not_ok():
    packed = amprep.pack(amprep.load(TABLE))
    supported = amprep.emit_cells(amprep.plan_supports(packed.builds[0], enabled=False))
    claims_supports = replace(supported.build, settings=replace(supported.build.settings, supported=True))
    found = amprep.verify(claims_supports)
    assert not found.ok
    assert "overhang" in str(found)


def test_parts_stay_at_the_positions_in_their_files_without_packing(tmp_path):
    parts = amprep.load(TABLE, printer={"size_mm": [200, 200, 200]})
    mesh = parts.parts[0].mesh
    inside = Mesh(mesh.vertices - mesh.bounds[0] + 20.0 * np.array([1, 1, 0]), mesh.triangles)
    planned = amprep.plan_supports(amprep.load(inside), **COARSE)
    supported = amprep.emit_cells(planned, cell="prism", base="raft")
    assert supported.build.parts[0].mesh.bounds[0].tolist() == pytest.approx([20, 20, 0])
    assert supported.build.settings.clearance == 0.0
    assert supported.build.supports


def test_geometry_in_memory_is_repaired_named_and_counted():
    box = box_mesh(np.zeros(3), np.array([10.0, 20, 30]))
    inside_out = Mesh(box.vertices, box.triangles[:, ::-1])
    parts = amprep.load(box, Part("box", inside_out, 0.0, quantity=3), TABLE)
    assert {part.name: part.quantity for part in parts.parts} == {"mesh": 1, "box": 3, "table": 1}
    assert all(part.volume_mm3 > 0 for part in parts.parts)
    assert str(parts).startswith("3 parts, 5 copies")


def test_settings_of_one_step_reach_the_following_steps():
    packed = amprep.pack(amprep.load(TABLE, seed=7), packer="auto", clearance_mm=4, lift_mm=3)
    assert packed.problem.clearance == 4
    supported = amprep.emit_cells(amprep.plan_supports(packed.builds[0], **COARSE), cell="prism")
    settings = supported.build.settings
    assert (settings.clearance, settings.lift) == (4, 3)
    assert supported.build.parts[0].mesh.bounds[0][2] == pytest.approx(3)


def test_the_parameters_of_a_packer_are_those_of_its_plugin():
    parts = amprep.load(TABLE)
    amprep.pack(parts, packer="sweep", params={"slicings": 1})
    with pytest.raises(JobError, match="parameters of packer 'sweep': unknown key 'slicing'"):
        amprep.pack(parts, packer="sweep", params={"slicing": 1})


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: amprep.load("no-such-file.stl"), InputError, "no such file"),
        (amprep.load, JobError, "nothing to print"),
        (lambda: amprep.load(TABLE, printer="EOS M29O"), JobError, "did you mean"),
        (lambda: amprep.load(TABLE, settings={"supports.pitch": 1}), JobError, "did you mean 'pitch_mm'"),
        (lambda: amprep.pack(amprep.load(TABLE), packer="atuo"), PluginError, "did you mean 'auto'"),
        (lambda: amprep.pack(amprep.load(TABLE), clearance=1), JobError, "did you mean 'clearance_mm'"),
        (lambda: amprep.pack(amprep.load(TABLE), clearance_mm=500), AmprepError, "none of the parts fits"),
        (
            lambda: amprep.pack(
                amprep.load(TABLE), packer="annealing", params={"start": "outside"}, time_limit_s=1e-6
            ),
            AmprepError,
            "more time",
        ),
        (lambda: amprep.write(None, "build.stl"), InputError, "must be a .3mf file"),
        (lambda: amprep.verify(TABLE), InputError, "table.stl"),
        (lambda: amprep.run("a.toml", "b.toml", output="out"), JobError, "must be the only input"),
    ],
)
def test_a_mistake_raises_an_error_of_amprep_that_says_what_to_do(call, error, message):
    with pytest.raises(error, match=message):
        call()


def test_progress_is_reported_as_fractions_with_the_stage(tmp_path):
    heard = []
    amprep.run(
        TABLE,
        output=tmp_path,
        dry_run=True,
        settings={"supports.pitch_mm": 4, "supports.reach_mm": 5, "cells.strategy": "prism"},
        progress=lambda fraction, message: heard.append((fraction, message)),
    )
    assert {message.partition(":")[0] for _, message in heard} >= {"read", "pack", "route", "cells", "verify"}
    assert all(0.0 <= fraction <= 1.0 for fraction, _ in heard)
    assert list(tmp_path.iterdir()) == []


def test_a_plan_without_time_leaves_every_square_unconnected_and_says_so():
    packed = amprep.pack(amprep.load(TABLE), lift_mm=0)
    planned = amprep.plan_supports(packed.builds[0], stop=Stop.after(0.0), cell="prism", **COARSE)
    assert (
        str(planned)
        == f"table.build-1: 0 of {len(present(planned.layout).red.square)} demand squares connected, pitch 4 mm"
    )
    supported = amprep.emit_cells(planned)
    assert "time limit" in {region.reason for region in supported.build.unsupported}


def test_a_record_shows_its_summary_and_not_what_it_holds():
    parts = amprep.load(f"{TABLE}:2")
    packed = amprep.pack(parts)
    assert repr(parts) == f"<LoadedParts: {parts}>"
    assert repr(packed) == f"<PackedParts: {packed}>"
    assert repr(packed.builds[0]) == f"<PackedBuild: {packed.builds[0]}>"
    mesh = parts.parts[0].mesh
    assert repr(mesh) == f"Mesh({len(mesh.vertices)} vertices, {len(mesh.triangles)} triangles)"
    assert "array" not in repr(mesh)


def test_messages_to_python_do_not_speak_of_a_command_line():
    with pytest.raises(JobError) as error:
        amprep.load(TABLE, settings={"packing.clearance": 1})
    assert "command line" not in str(error.value)
    assert str(error.value).startswith("Python: ")
