"""`amprep verify` finds what is wrong in a build file, whichever entry of the package was changed."""

import pytest
from tests.shared.faults import FAULTS
from tests.shared.planted import (
    BEAMS,
    DIALECTS,
    as_before,
    bracket_build,
    write_entries,
    write_package,
)
from tests.shared.wrong_builds import WRONG_BUILDS


@pytest.fixture(scope="session")
def written(tmp_path_factory):
    """Entries of the unchanged build file of each dialect."""
    folder = tmp_path_factory.mktemp("written")
    return {each: write_entries(bracket_build(each), folder / f"{each}.3mf") for each in DIALECTS}


def verdict(amprep, entries, folder):
    outcome = amprep("verify", write_package(entries, folder / "build.3mf"), "--json")
    broken = [] if outcome.code == 2 else [each["promise"] for each in outcome.json["violations"]]
    return outcome, broken


@pytest.mark.parametrize("dialect", DIALECTS)
def test_an_unchanged_file_breaks_no_promise(amprep, written, tmp_path, dialect):
    outcome, broken = verdict(amprep, written[dialect], tmp_path)
    assert (outcome.code, broken) == (0, [])
    judged = outcome.json["limits_judged"]
    of_file = (
        "printed as planned",
        "support unchanged",
        "part unchanged",
        "record unchanged",
        "distance to other parts",
    )
    assert [each for each in of_file if judged[each].startswith("not judged")] == []


@pytest.mark.parametrize(
    ("planted", "dialect"),
    [
        pytest.param(planted, dialect, id=f"{dialect}: {planted.name}")
        for planted in FAULTS
        for dialect in planted.dialects
    ],
)
def test_a_planted_fault_is_found(amprep, written, tmp_path, planted, dialect):
    changed = planted.fault(written[dialect])
    assert changed != written[dialect]
    outcome, broken = verdict(amprep, changed, tmp_path)
    if planted.promise is None:
        assert outcome.code == 2
        assert len(outcome.err.strip().splitlines()) == 1
    else:
        assert outcome.code == 1
        assert planted.promise in broken


@pytest.mark.parametrize(
    ("wrong", "dialect"),
    [
        pytest.param(wrong, dialect, id=f"{dialect}: {wrong.name}")
        for wrong in WRONG_BUILDS
        for dialect in wrong.dialects
    ],
)
def test_a_wrong_build_is_found_although_its_file_records_it(amprep, tmp_path, wrong, dialect):
    entries = write_entries(wrong.change(bracket_build(dialect)), tmp_path / "wrong.3mf")
    outcome, broken = verdict(amprep, entries, tmp_path)
    assert outcome.code == 1
    assert wrong.promise in broken


@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_file_of_an_earlier_version_is_accepted_and_says_what_is_not_judged(
    amprep, written, tmp_path, dialect
):
    outcome, broken = verdict(amprep, as_before(written[dialect]), tmp_path)
    assert (outcome.code, broken) == (0, [])
    for promise in ("support unchanged", "record unchanged"):
        assert outcome.json["limits_judged"][promise].startswith("not judged: an earlier version")


def test_there_are_faults_enough_in_every_dialect():
    counts = {each: sum(each in planted.dialects for planted in FAULTS) for each in DIALECTS}
    assert sum(counts.values()) >= 60
    assert min(counts.values()) >= 12
    assert any(planted.dialects == BEAMS for planted in FAULTS)
