"""The entries of a job for single parts change the parts they name and no others."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.optional import present

from amprep.errors import JobError
from amprep.job import apply_part_settings, load_job
from amprep.model import Mesh, Overrides, Part
from amprep.model.part import Appearance, Region
from amprep.model.rotations import quarter_turns


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


PAINTED = Appearance("#00FF00FF", triangle_colours=np.full((12, 3), 0xFF0000FF))


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        ("colour = '#FF0001'", r"\[\[rule\]\] 1: no part has the colour or the region '#FF0001' .*'#ff0000'"),
        ("colour = 'handel'", r"no part has the colour or the region 'handel' \(did you mean 'handle'\?\)"),
        ("colour = '#FF0000'\npart = 'plain'", r"'#FF0000' \(no part has colours or regions\)"),
    ],
)
def test_a_rule_with_a_colour_that_no_part_has_is_an_error_with_the_nearest(job_file, rule, message):
    painted = replace(part("lid", "a.stl"), appearance=PAINTED, regions=(Region("blocker", "handle"),))
    parts = [painted, part("plain", "b.stl")]
    with pytest.raises(JobError, match=message):
        apply_part_settings(parts, load_job(job_file(f"[[rule]]\nsupport = false\n{rule}")))


@pytest.mark.parametrize("colour", ["#ff0000", "#FF0000", "#00ff00", "handle"])
def test_a_rule_may_name_every_colour_and_region_of_a_part(job_file, colour):
    painted = replace(part("lid", "a.stl"), appearance=PAINTED, regions=(Region("blocker", "handle"),))
    text = f"[[rule]]\nsupport = false\ncolour = '{colour}'"
    assert apply_part_settings([painted], load_job(job_file(text))) == [painted]
