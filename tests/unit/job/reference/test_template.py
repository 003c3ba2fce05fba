"""A new job file is a job file; with every comment mark removed that stands before a default, it is the same job."""

import re

from tests.shared.builds import box_mesh

from amprep.job import load_job
from amprep.job.reference.page import key_texts
from amprep.job.reference.template import template
from amprep.stl import write_stl


def test_what_is_stated_is_set_and_everything_else_is_the_default(tmp_path):
    write_stl(box_mesh((0, 0, 0), (1, 1, 1)), tmp_path / "a.stl")
    text = template(
        "job.toml", ["a.stl:2"], {"printer": "prusa-mk4", "cells.strategy": "prism", "target": None}
    )
    for name, lines in (
        ("plain", text),
        ("opened", re.sub(r"^# (\w+ = \S)", r"\1", text, flags=re.MULTILINE)),
    ):
        (tmp_path / f"{name}.toml").write_text(lines.partition("\n# [[part]]")[0], encoding="utf-8")
    plain, opened = load_job(tmp_path / "plain.toml"), load_job(tmp_path / "opened.toml")
    assert (plain.printer.name, plain.cells.strategy, plain.inputs[0].quantity) == ("Prusa MK4", "prism", 2)
    assert "packing" in opened.table
    assert len(opened.table["supports"]) > 15
    assert (opened.packing, opened.cells, opened.seed, opened.target) == (
        plain.packing, plain.cells, plain.seed, plain.target,
    )  # fmt: skip
    assert opened.supports == plain.supports


def test_every_key_of_the_tables_is_there_with_its_meaning():
    text = template("job.toml", ["a.stl"], {})
    for section in ("packing", "supports", "cells", "reading"):
        for key in key_texts()[section]:
            assert re.search(rf"^# {key} =", text, re.MULTILINE), key
