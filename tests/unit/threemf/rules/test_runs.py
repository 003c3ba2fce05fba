"""Runs of plain vertices and triangles are checked as arrays, with the same findings as single elements."""

import numpy as np
import pytest
import trimesh

from amprep.threemf.names import CORE_NAMESPACE
from amprep.threemf.rules import broken
from amprep.threemf.rules.broken import BrokenRules
from amprep.threemf.rules.model_parts import check_model_parts
from amprep.threemf.rules.runs import take_runs

BALL = trimesh.creation.icosphere(4, 10.0)


def model(points=BALL.vertices, corners=BALL.faces, *, gap=""):
    """Return a model part of one mesh; `gap` stands inside every element and keeps runs from being found."""
    vertices = "".join(f'<vertex x="{x:f}" y="{y:f}" z="{z:f}"{gap}/>' for x, y, z in np.asarray(points))
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"{gap}/>' for a, b, c in np.asarray(corners))
    mesh = f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"
    inside = f'<resources><object id="1">{mesh}</object></resources><build><item objectid="1"/></build>'
    return f'<model xmlns="{CORE_NAMESPACE}">{inside}</model>'.encode()


def findings(content):
    found = BrokenRules()
    check_model_parts({"a.model": content}, "a.model", found)
    return [str(each) for each in found.listed()]


def test_nearly_all_of_a_mesh_is_taken_out_of_the_text():
    text, runs = take_runs(model())
    assert sum(run.length for run in runs.values()) == len(BALL.vertices) + len(BALL.faces)
    assert len(text) < 2000


@pytest.mark.parametrize("gap", ["", ' xmlns:v="v" v:a="1"'])
def test_runs_and_single_elements_give_the_same_findings(gap):
    corners = BALL.faces.copy()
    assert findings(model(gap=gap)) == []
    assert "point outwards" in findings(model(corners=corners[:, ::-1], gap=gap))[0]
    assert "3 do not" in findings(model(corners=corners[1:], gap=gap))[0]
    corners[2000, 1] = len(BALL.vertices)
    assert "triangle 2001" in findings(model(corners=corners, gap=gap))[0]


def test_a_run_in_a_comment_or_outside_of_a_mesh_is_no_geometry():
    run = '<vertex x="0" y="0" z="0"/>' * 5
    assert findings(model().replace(b"<resources>", f"<!-- {run} --><resources>".encode())) == []
    assert "may not contain a vertex" in findings(model().replace(b"<build>", f"<build>{run}".encode()))[0]


def test_the_number_of_findings_is_bounded(monkeypatch):
    monkeypatch.setattr(broken, "MOST_RULES", 3)
    found = BrokenRules()
    for number in range(100):
        found.add("rule", f"{number}", "here", touches_parts=number == 50)
    assert len(found.listed()) == 4
    assert found.listed()[0].touches_parts
