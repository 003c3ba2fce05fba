"""`amprep batch`: many jobs from the command line."""

from tests.e2e.test_support import plate_3mf

FAST = (
    "--printer",
    "EOS M290",
    "--set",
    "packing.strategy=extreme-points",
    "--set",
    "supports.enabled=false",
)


def test_a_batch_writes_the_bytes_of_single_runs_once(amprep, tmp_path):
    (tmp_path / "jobs").mkdir()
    plate_3mf(tmp_path / "jobs" / "plate.3mf", (0, 0, 0))
    (tmp_path / "jobs" / "wrong.toml").write_text('inputs = ["plate.3mf"]\nprinte = "x"\n')
    alone = amprep("run", tmp_path / "jobs" / "plate.3mf", "-o", tmp_path / "alone", *FAST)
    assert alone.code == 0, alone.err
    out = tmp_path / "out"
    first = amprep("batch", tmp_path / "jobs", "-o", out, "--json", *FAST)
    assert first.code == 1
    assert {each["name"]: each["state"] for each in first.json["jobs"]} == {
        "plate": "done",
        "wrong": "refused",
    }
    assert "did you mean 'printer'?" in first.json["jobs"][1]["message"]
    name = "plate.build-1.3mf"
    assert (out / "plate" / name).read_bytes() == (tmp_path / "alone" / name).read_bytes()
    (tmp_path / "jobs" / "wrong.toml").unlink()
    second = amprep("batch", tmp_path / "jobs", "-o", out, "--json", *FAST)
    assert second.code == 0
    assert [each["earlier"] for each in second.json["jobs"]] == [True]
    assert (out / "batch.html").is_file()


def test_a_batch_without_jobs_or_a_scheduler_is_refused_in_one_line(amprep, tmp_path):
    empty = amprep("batch", tmp_path)
    assert (empty.code, empty.err.count("\n")) == (2, 1)
    assert "no job to run" in empty.err
    missing = amprep("watch", tmp_path / "missing")
    assert (missing.code, missing.err.count("\n")) == (2, 1)
