"""How the removal of parts is said in the terminal, on the page and in JSON."""

import numpy as np
import pytest

from amprep.geometry.removal.order import RemovalOrder, RemovalStep
from amprep.model import Build, BuildSettings, BuildVolume, Part, PlacedPart
from amprep.report.record import BuildRecord
from amprep.report.removal_order import (
    hindrances_of,
    motions_in_words,
    removal_order_json,
    removal_rows,
    removal_summary,
    waiting_parts,
)
from amprep.testing.problems import box_mesh

UP = (((0.0, 0.0, 1.0), np.inf),)


@pytest.fixture
def entry():
    mesh = box_mesh([0, 0, 0], [1, 1, 1])
    parts = tuple(
        PlacedPart(name, Part(name, mesh, 1.0), np.eye(4)) for name in ("lid", "pot", "hook", "ring")
    )
    order = RemovalOrder(
        (
            RemovalStep((0,), UP, after=()),
            RemovalStep((2, 3), UP),
            RemovalStep((1,), UP, after=(0,)),
        ),
        locked=((2, 3),),
    )
    return BuildRecord(Build(BuildSettings("b", BuildVolume(np.ones(3))), parts), removal_order=order)


def test_the_terminal_names_locked_parts(entry):
    (line,) = hindrances_of(entry)
    assert line.startswith("hook and ring are locked into each other")


def test_parts_that_wait_for_others_are_named(entry):
    assert waiting_parts(entry) == ["pot can be lifted off only after lid"]


def test_rows_say_what_leaves_together_and_after_which_parts(entry):
    assert removal_rows(entry) == [
        ("lid", "upwards", ""),
        ("hook and ring", "upwards", ""),
        ("pot", "upwards", "lid"),
    ]
    assert removal_summary(entry) == "1 group of parts locked into each other"


def test_motions_are_said_with_their_lengths():
    path = (((0.0, -1.0, 0.0), 4.5), ((0.6, 0.0, 0.8), np.inf))
    assert motions_in_words(path) == "4.5 mm along -y, then along +x and upwards"


def test_json_names_parts(entry):
    found = removal_order_json(entry)
    assert found["locked"] == [["hook", "ring"]]
    assert [step["parts"] for step in found["steps"]] == [["lid"], ["hook", "ring"], ["pot"]]
    assert [step["after"] for step in found["steps"]] == [[], None, ["lid"]]
