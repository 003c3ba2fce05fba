"""Overhangs that are known are those that a search finds, at every position with the same rotation and height."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.layouts import box, placed

from amprep import workers
from amprep.model import Stop
from amprep.model.supports.rules import SupportRules
from amprep.overhangs.known import KnownOverhangs
from amprep.overhangs.of_part import overhangs_of

TABLE = box((20, 20, 3), (0, 0, 10)) + box((6, 6, 10), (7, 7, 0))
LIMITS = SupportRules(rules="limits", ledge_mm=2.0, bridge_mm=4.0, bore_mm=10.0)


def at(position, turn=None):
    (part,) = placed(TABLE)
    matrix = np.eye(4)
    matrix[:3, 3] = position
    if turn is not None:
        matrix[:3, :3] = turn
    return replace(part, part=PART, matrix=matrix)


PART = placed(TABLE)[0].part


def counted(monkeypatch):
    """A list with one entry for each search."""
    calls = []

    def search(part, rules):
        calls.append(part)
        return overhangs_of(part, rules)

    monkeypatch.setattr("amprep.overhangs.known.overhangs_of", search)
    return calls


@pytest.mark.parametrize("rules", [SupportRules(), LIMITS], ids=["thesis", "limits"])
def test_overhangs_of_a_copy_are_those_of_the_first_one_moved(rules, monkeypatch):
    known, calls = KnownOverhangs(rules), counted(monkeypatch)
    known.of(at((1.0, 2.0, 3.0)))
    found, searched = known.of(at((41.5, 7.25, 3.0))), overhangs_of(at((41.5, 7.25, 3.0)), rules)
    assert len(calls) == 1
    assert np.allclose(found.mesh.vertices, searched.mesh.vertices)
    assert (found.mesh.triangles == searched.mesh.triangles).all()
    assert (found.overhangs.faces == searched.overhangs.faces).all()
    for one, other in zip(found.overhangs.regions, searched.overhangs.regions, strict=True):
        assert one._replace(centre=None) == other._replace(centre=None)
        assert np.allclose(one.centre, other.centre)


def test_another_height_rotation_or_setting_is_searched_again(monkeypatch):
    known, calls = KnownOverhangs(LIMITS), counted(monkeypatch)
    none = replace(PART, overrides=replace(PART.overrides, supports=False))
    for each in (at((0, 0, 3)), at((0, 0, 4)), at((0, 0, 3), np.diag([1, -1, -1.0]))):
        known.of(each)
    assert len(known.of(replace(at((0, 0, 3)), part=none)).overhangs.faces) == 0
    assert len(calls) == 4


def test_several_processes_find_the_same_overhangs_once_for_each_orientation(monkeypatch):
    monkeypatch.setattr(workers, "_WORTH_IT", 0.0)
    parts = [
        at((0, 0, 3)),
        at((0, 0, 4)),
        at((9, 9, 3)),
        at((0, 0, 5)),
        at((0, 0, 3), np.diag([1, -1, -1.0])),
    ]
    known = KnownOverhangs(LIMITS)
    with workers.allowed(3):
        known.find(parts, Stop())
    calls = counted(monkeypatch)
    for part in parts:
        found, searched = known.of(part), overhangs_of(part, LIMITS)
        assert np.allclose(found.mesh.vertices, searched.mesh.vertices)
        assert found.overhangs.faces.tobytes() == searched.overhangs.faces.tobytes()
        assert len(found.overhangs.regions) == len(searched.overhangs.regions)
    assert calls == []
    assert not known.of(parts[0]).mesh.vertices.flags.writeable  # else kernels would be compiled again


def test_what_is_not_found_before_an_end_is_found_when_it_is_asked_for(monkeypatch):
    known = KnownOverhangs(LIMITS)
    known.find([at((0, 0, 3))], Stop.after(0.0))
    calls = counted(monkeypatch)
    assert len(known.of(at((0, 0, 3))).overhangs.faces)
    assert len(calls) == 1
