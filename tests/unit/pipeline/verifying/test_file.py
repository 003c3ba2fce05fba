"""A build file is verified against its job, its printer, its report and its seal, whatever it states itself."""

import json
from dataclasses import replace

import pytest
from tests.shared.solids import mesh_of
from tests.shared.supported import box

import amprep
from amprep.errors import InputError
from amprep.stl import write_stl
from amprep.threemf import read_build, write_build

JOB = """
printer = "EOS M290"
{job}
[supports]
enabled = false
[packing]
strategy = "extreme-points"
{packing}
[[part]]
file = "bar.stl"
quantity = 2
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A job of two bars without supports, and its folder of results."""
    folder = tmp_path_factory.mktemp("ordered")
    write_stl(mesh_of(box((20, 10, 5), (0, 0, 0)) + box((5, 5, 9), (0, 0, 0))), folder / "bar.stl")
    (folder / "job.toml").write_text(JOB.format(job="", packing=""))
    amprep.run(folder / "job.toml", output=folder / "out")
    return folder


def build_file(folder):
    return folder / "out" / "job.build-1.3mf"


def verified(folder, file=None, **against):
    found = amprep.verify(file or build_file(folder), **against)
    return {each.promise: each.message for each in found.violations}


@pytest.fixture
def changed(made, tmp_path):
    """Return a maker of files of the build with other records."""

    def make(change):
        build = read_build(build_file(made))
        write_build(change(build), tmp_path / "job.build-1.3mf")
        return tmp_path / "job.build-1.3mf"

    return make


def test_a_build_is_as_its_job_its_printer_and_its_report_say(made):
    against = {"job": made / "job.toml", "printer": "EOS M290", "report": made / "out" / "job.report.json"}
    assert verified(made, **against) == {}


def test_a_job_that_orders_more_clearance_is_not_met(made, tmp_path):
    (tmp_path / "bar.stl").write_bytes((made / "bar.stl").read_bytes())
    (tmp_path / "wide.toml").write_text(JOB.format(job="", packing="clearance_mm = 30"))
    found = verified(made, job=tmp_path / "wide.toml")
    assert found["as ordered"] == "clearance_mm 5 (ordered: 30)"
    assert "clearance" in found  # the distance itself is judged by the job as well


def test_a_record_that_was_made_weaker_is_judged_by_the_job(made, changed):
    file = changed(
        lambda build: replace(
            build, settings=replace(build.settings, clearance=0.0, lift=0.0, overlap=5.0, supported=False)
        )
    )
    assert verified(made, file) == {}
    assert "overlap_mm 5 (ordered: 0.1)" in str(amprep.verify(file, job=made / "job.toml"))
    assert any("clearance_mm 0 (usual: 5)" in words for words in amprep.verify(file).weaker)


def test_a_part_that_is_not_ordered_is_named(made, changed):
    def other(build):
        first = build.parts[0]
        mesh = mesh_of(box((20, 10, 5), (0, 0, 0)))
        return replace(build, parts=(replace(first, part=replace(first.part, mesh=mesh)), *build.parts[1:]))

    assert (
        "no part of job.toml has its geometry"
        in verified(made, changed(other), job=made / "job.toml").values()
    )


def test_more_copies_than_ordered_are_found(made, tmp_path):
    (tmp_path / "bar.stl").write_bytes((made / "bar.stl").read_bytes())
    (tmp_path / "one.toml").write_text(JOB.format(job="", packing="").replace("quantity = 2", "quantity = 1"))
    assert verified(made, job=tmp_path / "one.toml") == {"as ordered": "2 copies in the build, 1 ordered"}


def test_a_smaller_printer_refuses_the_build(made):
    found = verified(made, printer="TruPrint 1000")
    assert "ordered cylinder" in found["as ordered"]


def test_a_file_that_the_report_does_not_know_is_found(made, changed):
    file = changed(lambda build: replace(build, settings=replace(build.settings, lift=2.5)))
    assert (
        "not the one in job.report.json"
        in verified(made, file, report=made / "out" / "job.report.json")["as reported"]
    )


def test_a_seal_is_judged_where_there_is_one(made, changed, tmp_path):
    from amprep.sealing.seal import seal_file

    key = tmp_path / "key"
    key.write_text("a secret of some length")
    file = changed(lambda build: build)
    assert verified(made, file) == {}
    assert "expected the seal" in verified(made, file, key=key)["sealed"]
    seal_file(file, key)
    assert amprep.verify(file, key=key).extent["sealed"] == "sealed with hmac-sha256, checked with the key"
    file.write_bytes(file.read_bytes() + b"\0")
    assert "changed after" in verified(made, file)["sealed"]


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"builds": 3}', '{"builds": [3]}', "[" * 100000])
def test_what_is_no_report_is_refused(made, tmp_path, text):
    (tmp_path / "r.json").write_text(text)
    with pytest.raises(InputError, match=r"not a report of amprep|expected NAME\.report\.json"):
        amprep.verify(build_file(made), report=tmp_path / "r.json")


def test_a_build_in_memory_has_no_order(made):
    with pytest.raises(InputError, match="apply to a build file"):
        amprep.verify(read_build(build_file(made)), printer="EOS M290")


def test_the_report_states_the_digest_of_the_file(made):
    import hashlib

    (entry,) = json.loads((made / "out" / "job.report.json").read_text(encoding="utf-8"))["builds"]
    assert entry["sha256"] == hashlib.sha256(build_file(made).read_bytes()).hexdigest()
