"""The job file: what it may say, what it gets when it says nothing, and how it is told off."""

from pathlib import Path

import numpy as np
import pytest
from tests.shared.optional import present

from amprep.errors import JobError
from amprep.job import apply_part_settings, apply_sets, find_printer, job_from_inputs, load_job, override
from amprep.model import Mesh, Overrides, Part
from amprep.model.rotations import quarter_turns


@pytest.fixture
def job_file(tmp_path):
    """Write a job file called bracket.toml and return its path."""

    def write(text, inputs='inputs = ["a.stl"]\n'):
        path = tmp_path / "bracket.toml"
        path.write_text(inputs + text, encoding="utf-8")
        return path

    return write


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


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("sed = 1", r"unknown key 'sed' \(did you mean 'seed'\?\)"),
        ("pitch_mm = 1", r"unknown key 'pitch_mm' \(did you mean 'supports.pitch_mm'\?\)"),
        ("[packing]\nclearence_mm = 1", r"\[packing\]: unknown key 'clearence_mm' \(did you mean 'clear"),
        ("seed = 1.0", "seed: expected a whole number, got 1.0"),
        ("seed = -1", r"seed must be between 0 and 2\*\*63 - 1, got -1"),
        ('seed = "x"', "seed: expected a whole number, got the text 'x'"),
        ('target = "curra"', "target: expected one of 'generic', 'prusaslicer', 'cura', got"),
        ("packing = 3", r"\[packing\]: expected a table, got 3"),
        ('[packing]\nstacking = "no"', r"\[packing\]: stacking: expected true or false, got the text 'no'"),
        ("[packing]\nclearance_mm = -1", r"\[packing\]: clearance_mm must be at least 0, got -1"),
        ("[packing]\nclearance_mm = inf", "clearance_mm: expected a number, got inf"),
        ("[packing]\ntime_limit_s = 0", "time_limit_s must be above 0, got 0"),
        ('[packing]\nobjective = "speed"', "objective: expected one of 'fill', 'builds', 'height'"),
        ("[supports]\noverhang_angle_deg = 90", "overhang_angle_deg must be between 0 and 89, got 90"),
        ("[supports]\nstrut_angle_deg = 9", "strut_angle_deg must be between 10 and 80, got 9"),
        ("[supports]\npitch_mm = 0", "pitch_mm must be above 0, got 0"),
        ("[supports]\nedge_capacity = -1", "edge_capacity must be between 0 and 1000000, got -1"),
        ("[supports]\nvertical_cost = 0", "vertical_cost must be between 1 and 10000, got 0"),
        ("[supports]\ngap_mm = -1", "gap_mm must be at least 0"),
        ('[supports]\noverhang_angle_deg = "x"', "overhang_angle_deg: expected a number, got the text 'x'"),
        ("[cells]\noverlap_mm = -0.1", "overlap_mm must be at least 0, got -0.1"),
        ('[cells]\nstrategy = "cell.stl"', r"\[cells\]: strategy: no file at .*cell\.stl"),
        ("[reading]\nreaders = {stl = 'mesh'}", "readers must map suffixes such as"),
        ("[reading]\nparams = {mesh = 1}", "params must hold one table per reader"),
        ('printer = "EOS M29"', r"printer: no printer is called 'EOS M29' \(did you mean 'EOS M290'\?\)"),
        ("printer = 3", "printer: expected a text, got 3"),
        ("part = 3", "part: expected a list"),
        ("part = [3]", r"\[\[part\]\] 1: expected a table, got 3"),
        (
            "[[part]]\nquantity = 2",
            r"\[\[part\]\] 1: a \[\[part\]\] entry must have a file or a name, got neither",
        ),
        (
            '[[part]]\nname = "a"\nquantity = 0',
            r"\[\[part\]\] 1: quantity must be between 1 and 1000000, got 0",
        ),
        ('[[part]]\nname = "a"\nvalue = -1', "value must be between 0 and 1000000000000000, got -1"),
        ('[[part]]\nname = "a"\nrotations = "y90"', r"rotations: expected one of none, z90"),
        ('[[part]]\nname = "a"\nrotations = "z361"', "the step must be between 1 and 360 degrees, got 361"),
        ('[[part]]\nname = "a"\nrotations = [[[1,0,0],[0,1,0],[0,0,2]]]', "is not a rotation matrix"),
        ('[[part]]\nname = "a"\nboxes = [[0,0,0,1,1]]', "boxes: expected a list, each a list of a number"),
        ('[[part]]\nname = "a"\nboxes = [[0,0,0,1,1,0]]', r"a box must be \[x0, y0, z0, x1, y1, z1\]"),
        ('[[part]]\nname = "a"\nboxes = []', "boxes must have at least one box"),
        ('[[part]]\nfile = "a\\u0000"', "file must be a path"),
        ("rule = 3", "rule: expected a list"),
        ("[[rule]]\nsupport = 1", r"\[\[rule\]\] 1: support: expected a truth value|true or false"),
        (
            "[[rule]]\nkind = 'hole'\nsupport = false",
            r"\[\[rule\]\] 1: kind: expected one of 'face', 'ledge'",
        ),
        ("[[rule]]\nkind = []\nsupport = false", "kind must name at least one kind"),
        (
            "[[rule]]\nangle = [9, 3]\nsupport = false",
            r"angle must be \[least, greatest\] or \[least\], at least 0",
        ),
        ("[[rule]]\nsize = []\nsupport = false", r"size must be \[least, greatest\] or \[least\]"),
        (
            "[[rule]]\ncolour = '#12'\nsupport = false",
            "colour must be '#RRGGBB' or the name of a region, got '#12'",
        ),
        (
            "[[rule]]\nkind = 'edge'",
            r"\[\[rule\]\] 1: a \[\[rule\]\] entry must have a setting beside its cond",
        ),
        (
            "[[rule]]\nsupport = false\npitch_mm = 1.0",
            "with support = false must have no other settings, got pitch_mm",
        ),
        (
            "[[rule]]\nneck_mm = 9\nconnector = 'teeth'",
            r"\[\[rule\]\] 1: neck_mm must be below the tip width",
        ),
        ("[[rule]]\npitch_mm = 0", r"\[\[rule\]\] 1: pitch_mm must be above 0, got 0"),
        ("[[rule]]\ncell = 'own.toml'", r"\[\[rule\]\] 1: cell: no file at "),
        ("[[rule]]\nsuport = false", r"\[\[rule\]\] 1: unknown key 'suport' \(did you mean 'support'"),
        ('[[part]]\nname = "a"\n[[part]]\nnane = "b"', r"\[\[part\]\] 2: unknown key 'nane' \(did"),
    ],
)
def test_a_mistake_names_the_file_the_key_what_was_expected_and_what_came(job_file, text, message):
    path = job_file(text)
    with pytest.raises(JobError, match=message) as caught:
        load_job(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("inputs = []", "nothing to print"),
        ("", "nothing to print"),
        ('inputs = "a.stl"', "inputs: expected a list, each a text, got the text 'a.stl'"),
        ("inputs = [3]", "inputs: expected a list, each a text"),
        ('inputs = ["a.stl:0"]', "'.*a.stl:0': quantity must be between 1 and 1000000, got 0"),
        ('inputs = ["a.stl:99999999999999999999999999"]', "quantity must be between 1 and 1000000"),
        ('inputs = ["\\u0000"]', "expected the path of a file or folder"),
        ("seed = ", "not a TOML file"),
        ("a = " + "[" * 9999, "not a TOML file"),
    ],
)
def test_a_job_without_inputs_or_without_sense_is_refused(job_file, text, message):
    with pytest.raises(JobError, match=message):
        load_job(job_file(text, inputs=""))


def test_a_file_that_is_no_text_is_refused(tmp_path):
    path = tmp_path / "x.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(JobError, match=r"x\.toml: not a TOML file"):
        load_job(path)
    with pytest.raises(JobError, match="expected a job file, got a folder"):
        load_job(tmp_path)
    with pytest.raises(JobError, match="expected a job file, found nothing"):
        load_job(tmp_path / "y.toml")
    path.write_bytes(b"#" * 5_000_000)
    with pytest.raises(JobError, match="at most 4194304 bytes"):
        load_job(path)


def test_inputs_may_carry_a_quantity(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("odd:7").touch()
    job = job_from_inputs(["parts/a.stl:3", "b.stl", "odd:7", "odd:7:2", "c:/d.stl"])
    found = [(spec.path.as_posix(), spec.quantity) for spec in job.inputs]
    assert found == [("parts/a.stl", 3), ("b.stl", None), ("odd:7", None), ("odd:7", 2), ("c:/d.stl", None)]
    assert (job.name, job.folder) == ("a", None)
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
    ("text", "section", "key", "value"),
    [
        ("supports.pitch_mm=0.8", "supports", "pitch_mm", 0.8),
        ("supports.enabled = false", "supports", "enabled", False),
        ("cells.strategy=prism", "cells", "strategy", "prism"),
        ('cells.strategy="prism"', "cells", "strategy", "prism"),
        ("packing.params={effort = 2}", "packing", "params", {"effort": 2}),
        ("packing.params.effort=2", "packing", "params", {"kept": 1, "effort": 2}),
    ],
)
def test_set_changes_one_key_and_keeps_the_others(job_file, text, section, key, value):
    job = load_job(job_file("[packing]\nclearance_mm = 3\nparams.kept = 1"))
    changed = apply_sets(job, [text])
    found = getattr(getattr(changed, section), key)
    assert found == value or (key == "params" and set(value.items()) <= set(found.items()))
    assert changed.packing.clearance_mm == 3
    assert job.packing.params == {"kept": 1}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("pitch", "--set: expected key=value"),
        ("=3", "--set: expected key=value"),
        ("a=1\nb=2", "--set: expected key=value"),
        ("supports.pitch_mm=0,8", "expected a TOML value"),
        (
            "supports.pitchmm=1",
            r"with --set: \[supports\]: unknown key 'pitchmm' \(did you mean 'pitch_mm'\?\)",
        ),
        ("supports.enabled=True", "expected true or false, got the text 'True'"),
        ("part.name=2", "entries of a list cannot be set"),
        ("a..b=2", "expected a TOML value"),
    ],
)
def test_a_wrong_set_says_what_was_expected(job_file, text, message):
    with pytest.raises(JobError, match=message):
        apply_sets(load_job(job_file("[[part]]\nname = 'a'")), [text])


def test_defaults_follow_what_is_set_last(job_file):
    job = apply_sets(load_job(job_file("")), ["printer='HP MJF 4200'", "supports.overhang_angle_deg=30"])
    assert (job.packing.stacking, job.supports.enabled, job.supports.strut_angle_deg) == (True, False, 30)


def test_the_options_of_the_command_line_win(job_file):
    job = load_job(
        job_file("seed = 1\n[packing]\nparams = {effort = 3}\nclearance_mm = 1\n[cells]\nparams = {a = 1}")
    )
    changed = override(
        job,
        {
            "printer": "SLM 280 2.0",
            "packing.strategy": "rows",
            "supports.strategy": "own",
            "cells.strategy": "x-wall",
            "target": "cura",
            "seed": 9,
        },
    )
    assert (changed.printer.name, changed.target, changed.seed) == ("SLM 280 2.0", "cura", 9)
    assert (changed.packing.strategy, changed.supports.strategy, changed.cells.strategy) == (
        "rows",
        "own",
        "x-wall",
    )
    assert changed.packing.params == {}, "the job's parameters belong to the job's own packer"
    assert (changed.cells.params, changed.packing.clearance_mm) == ({"a": 1}, 1)
    assert override(job, {"packing.strategy": None}) is job
    assert override(job, {"packing.params": {"b": 2}}).packing.params == {"b": 2}
    with pytest.raises(JobError, match="target: expected one of"):
        override(job, {"target": "bambu"})
    with pytest.raises(JobError, match="no printer is called"):
        override(job, {"printer": "EOS"})


def test_a_path_on_the_command_line_starts_at_the_current_folder(job_file, tmp_path, monkeypatch):
    here = tmp_path / "elsewhere"
    here.mkdir()
    (here / "mine.toml").write_text("size_mm = [10, 20, 30]")
    (here / "cell.stl").touch()
    monkeypatch.chdir(here)
    job = override(load_job(job_file("")), {"printer": "mine.toml", "cells.strategy": "cell.stl"})
    assert job.printer.space.size.tolist() == [10, 20, 30]
    assert job.cells.file == (here / "cell.stl").resolve()


def part(name, source="", **fields):
    return Part(name, Mesh(np.eye(3), [[0, 1, 2]]), 5.0, source=source, **fields)


def test_part_entries_change_the_parts_they_name_and_no_others(job_file, tmp_path):
    text = """
    [[part]]
    file = "a.stl"
    quantity = 4
    rotations = "z90"
    [[part]]
    name = "lid"
    value = 0
    supports = false
    boxes = [[0, 0, 0, 1, 1, 1], [1, 0, 0, 2, 1, 1]]
    overhang_angle_deg = 30
    """
    parts = [
        part("base", str(tmp_path / "a.stl")),
        part("lid", str(tmp_path / "a.stl")),
        part("c", quantity=2),
    ]
    base, lid, other = apply_part_settings(parts, load_job(job_file(text)))
    assert (base.quantity, lid.quantity, other) == (4, 4, parts[2])
    assert np.array_equal(base.orientations.matrices, quarter_turns())
    assert (base.value, lid.value, lid.fill_value) == (None, 0, 0)
    assert present(lid.boxes).tolist() == [[0, 0, 0, 1, 1, 1], [1, 0, 0, 2, 1, 1]]
    assert (lid.overrides.supports, lid.overrides.overhang_angle_deg) == (False, 30)


def test_what_a_part_entry_does_not_say_stays_as_it_was_read(job_file):
    read = part("lid", quantity=3, value=2.0, overrides=Overrides(supports=False, overhang_angle_deg=20))
    (kept,) = apply_part_settings([read], load_job(job_file("[[part]]\nname = 'lid'")))
    assert (kept.quantity, kept.value, kept.overrides.supports, kept.overrides.overhang_angle_deg) == (
        3,
        2,
        False,
        20,
    )


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ('name = "lidd"', r"\[\[part\]\] 1: no part is called 'lidd' \(did you mean 'lid'\?\)"),
        ('file = "b.stl"', r"\[\[part\]\] 1: no part comes from 'b.stl' \(did you mean 'a.stl'\?\)"),
        ('file = "a.stl"\nname = "base"', r"no part is called 'base'"),
    ],
)
def test_a_part_entry_that_names_no_part_is_an_error_with_the_nearest(job_file, tmp_path, entry, message):
    with pytest.raises(JobError, match=message):
        apply_part_settings([part("lid", str(tmp_path / "a.stl"))], load_job(job_file(f"[[part]]\n{entry}")))


def test_the_plural_of_an_entry_suggests_the_entry(tmp_path):
    path = tmp_path / "job.toml"
    path.write_text('[[rules]]\nkind = "bore"\nsupport = false\n')
    with pytest.raises(JobError, match=r"unknown key 'rules' \(did you mean 'rule'\?\)"):
        load_job(path)
