"""A mistake in a job file is refused in one line that says what was expected."""

import pytest

from amprep.errors import JobError
from amprep.job import load_job


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
        ("[cells]\noverlap_mm = 50", "overlap_mm must be at most 5.0, got 50"),
        ("[supports]\nreach_mm = 1e-4", "reach_mm must be between 0.05 and 10000.0, got 0.0001"),
        ("[packing]\nlift_mm = 1e9", "lift_mm must be at most 10000.0, got 1000000000.0"),
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
        ("[[rule]]\nkind = 'bor'\nsupport = false", r"got the text 'bor' \(did you mean 'bore'\?\)"),
        ("[[rule]]\nkind = ['edge', 'tipp']\nsupport = false", r"\(did you mean 'tip'\?\)"),
        ("[[rule]]\nangle = 3\nsupport = false", r"angle: expected \[least, greatest\] or \[least\], got 3"),
        (
            "[rule]\nsupport = false",
            r"rule: expected entries \[\[rule\]\], got one table; write \[\[rule\]\]",
        ),
        ("[part]\nname = 'a'", r"part: expected entries \[\[part\]\], got one table; write \[\[part\]\]"),
        (
            "supports.rules = 'thesis'\n[[rule]]\nkind = 'bore'\nsupport = false",
            r"\[\[rule\]\] 1: with rules = 'thesis' kind must be one of 'face', 'edge', 'tip', got 'bore'",
        ),
        (
            "supports.rules = 'thesis'\n[[rule]]\nsize = [1]\nsupport = false",
            "size must be left out with rules = 'thesis'",
        ),
        (
            "[[rule]]\nkind = 'face'\nsupport = false",
            "with rules = 'limits' kind must be one of 'ledge', .*got 'face'",
        ),
        (
            "supports.overhang_angle_deg = 45\nsupports.noncritical_angle_deg = 30",
            "noncritical_angle_deg must be 0 or at least overhang_angle_deg = 45, got 30",
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
    with pytest.raises(JobError, match="at most 4 MiB"):
        load_job(path)


def test_the_plural_of_an_entry_suggests_the_entry(tmp_path):
    path = tmp_path / "job.toml"
    path.write_text('[[rules]]\nkind = "bore"\nsupport = false\n')
    with pytest.raises(JobError, match=r"unknown key 'rules' \(did you mean 'rule'\?\)"):
        load_job(path)
