"""What a job file may say, and what the job gets when it says nothing."""

from pathlib import Path

import pytest

from amprep.errors import JobError
from amprep.job import find_printer, job_from_inputs, load_job, override


def test_a_job_that_says_nothing_but_its_input_gets_the_defaults_of_metal(job_file, tmp_path):
    job = load_job(job_file(""))
    assert (job.name, job.seed, job.target) == ("bracket", 0, "generic")
    assert [(spec.path, spec.quantity) for spec in job.inputs] == [(tmp_path / "a.stl", None)]
    assert job.printer.name == "EOS M290"
    assert job.printer_is_default
    assert (job.packing.strategy, job.packing.volumes, job.packing.objective) == (
        "auto",
        None,
        "builds",
    )
    assert (job.packing.stacking, job.supports.enabled) == (False, True)
    assert (job.supports.strategy, job.cells.strategy) == ("shortest-paths", "x-wall")


@pytest.mark.parametrize(
    ("printer", "stacking", "supported"),
    [("eos-m290", False, True), ("hp mjf 4200", True, False), ("Prusa MK4", False, True)],
)
def test_stacking_and_supports_follow_the_printers_technology_unless_the_job_says_otherwise(
    job_file, printer, stacking, supported
):
    job = load_job(job_file(f'printer = "{printer}"'))
    assert (job.packing.stacking, job.supports.enabled) == (stacking, supported)
    said = f'printer = "{printer}"\n[packing]\nstacking = {str(not stacking).lower()}\n'
    job = load_job(job_file(f"{said}[supports]\nenabled = {str(not supported).lower()}"))
    assert (job.packing.stacking, job.supports.enabled) == (not stacking, not supported)
    assert not job.printer_is_default


METAL_DISTANCES = "lift 3 mm and part distance 5 mm by default for metal powder beds"


@pytest.mark.parametrize(
    ("keys", "clearance", "lift", "words"),
    [
        ("", 5.0, 3.0, METAL_DISTANCES),
        ("printer = {size_mm = [60, 60, 60]}", 5.0, 3.0, METAL_DISTANCES),
        ("[packing]\nlift_mm = 0", 5.0, 0.0, "part distance 5 mm by default for metal powder beds"),
        ("[packing]\nclearance_mm = 5", 5.0, 3.0, "lift 3 mm by default for metal powder beds"),
        ("[packing]\nclearance_mm = 2\nlift_mm = 3", 2.0, 3.0, ""),
        ('printer = "Prusa MK4"', 2.0, 0.0, ""),
        ('printer = "EOS P 396"', 2.0, 0.0, ""),
    ],
)
def test_parts_are_lifted_and_farther_apart_on_metal_powder_beds_unless_the_job_says_otherwise(
    job_file, keys, clearance, lift, words
):
    job = load_job(job_file(keys))
    assert (job.packing.clearance_mm, job.packing.lift_mm) == (clearance, lift)
    assert job.default_distances == words


def test_another_printer_has_its_own_default_distances(job_file):
    job = load_job(job_file("[packing]\nlift_mm = 1"))
    assert job.distances_on(find_printer("EOS M290")) == (5.0, 1.0)
    assert job.distances_on(find_printer("Prusa MK4")) == (2.0, 1.0)
    changed = override(load_job(job_file("")), {"printer": "Prusa MK4"})
    assert (changed.packing.clearance_mm, changed.packing.lift_mm) == (2.0, 0.0)


@pytest.mark.parametrize(("overhang", "strut"), [(45, 45), (30, 30), (5, 10), (85, 80)])
def test_the_strut_angle_follows_the_overhang_angle_within_its_bounds(job_file, overhang, strut):
    assert (
        load_job(job_file(f"[supports]\noverhang_angle_deg = {overhang}")).supports.strut_angle_deg == strut
    )
    own = load_job(job_file(f"[supports]\noverhang_angle_deg = {overhang}\nstrut_angle_deg = 50"))
    assert own.supports.strut_angle_deg == 50


def test_every_section_is_read(job_file):
    job = load_job(
        job_file("""
        seed = 7
        target = "cura"
        [reading]
        readers = {".stl" = "mesh"}
        params.mesh.unit = "inch"
        [packing]
        objective = "fill"
        clearance_mm = 1
        params = {effort = 3}
        volume_params = {box = {margin = 1}}
        [supports]
        pitch_mm = 0.8
        share_between_parts = "allow"
        [cells]
        strategy = "prism"
        connector = "extend"
        """)
    )
    assert (job.seed, job.target) == (7, "cura")
    assert (job.reading.readers, job.reading.params) == ({".stl": "mesh"}, {"mesh": {"unit": "inch"}})
    assert (job.packing.objective, job.packing.clearance_mm) == ("fill", 1.0)
    assert (job.packing.params, job.packing.volume_params) == ({"effort": 3}, {"box": {"margin": 1}})
    assert (job.supports.pitch_mm, job.supports.share_between_parts) == (0.8, "allow")
    assert (job.cells.strategy, job.cells.connector, job.cells.file) == ("prism", "extend", None)


def test_inputs_may_carry_a_quantity(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("odd:7").touch()
    job = job_from_inputs(["parts/a.stl:3", "b.stl", "odd:7", "odd:7:2", "c:/d.stl"])
    found = [(spec.path.as_posix(), spec.quantity) for spec in job.inputs]
    assert found == [("parts/a.stl", 3), ("b.stl", None), ("odd:7", None), ("odd:7", 2), ("c:/d.stl", None)]
    assert (job.name, job.folder) == (tmp_path.name, None)
    with pytest.raises(JobError, match="nothing to print"):
        job_from_inputs([])


def test_a_part_with_a_file_that_no_input_covers_is_an_input(job_file, tmp_path):
    text = '[[part]]\nfile = "b.stl"\n[[part]]\nfile = "parts/c.stl"\n[[part]]\nfile = "./a.stl"'
    job = load_job(job_file(text, inputs='inputs = ["a.stl:2", "parts"]\n'))
    assert [spec.path for spec in job.inputs] == [tmp_path / "a.stl", tmp_path / "parts", tmp_path / "b.stl"]


def test_a_cell_may_be_a_file_beside_the_job(job_file, tmp_path):
    (tmp_path / "cell.stl").touch()
    job = load_job(job_file('[cells]\nstrategy = "cell.stl"'))
    assert job.cells.file == (tmp_path / "cell.stl").resolve()


@pytest.mark.parametrize(
    ("inputs", "name"),
    [
        (["parts/bracket.stl:4"], "bracket"),
        (["parts"], "parts"),
        (["parts/a.stl", "parts/b.stl"], "parts"),
        (["parts/x/a.stl", "parts/y/b.stl"], "parts"),
        (["parts/x/a.stl", "other/b.stl"], "here"),
    ],
)
def test_a_job_without_a_file_is_named_after_its_only_input_or_the_folder_of_all(
    tmp_path, monkeypatch, inputs, name
):
    (tmp_path / "here" / "parts").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here")
    job = job_from_inputs(inputs)
    assert job.name == name
    assert override(job, {"name": "tray 7"}).name == "tray 7"


def test_a_job_file_may_state_its_name(job_file):
    assert load_job(job_file('name = "tray 7"\n')).name == "tray 7"


@pytest.mark.parametrize("name", ["", " ", "a/b", "..", ".hidden", "a\\b", "a:b", "x" * 101, "a\nb"])
def test_a_name_that_no_file_may_have_is_refused(name):
    with pytest.raises(JobError, match="name must have 1 to 100 characters"):
        override(job_from_inputs(["a.stl"]), {"name": name})
