"""A batch on a Dask cluster loses no job and does none twice, also when workers are killed."""

import os
import signal
import time
from pathlib import Path

import pytest

from amprep.batch.cluster import ClusterQueue
from amprep.batch.find import find_jobs
from amprep.batch.records import JobOutcome
from amprep.errors import AmprepError

distributed = pytest.importorskip("distributed")


def test_a_scheduler_that_is_not_there_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("amprep.batch.cluster._CONNECT_S", 0.2)
    with pytest.raises(AmprepError, match="no scheduler answers"):
        ClusterQueue("tcp://127.0.0.1:1", again=False)


def test_no_job_is_lost_or_done_twice_when_a_worker_is_killed(tmp_path: Path) -> None:
    for number in range(3):
        (tmp_path / f"{number}.toml").write_text(f'inputs = ["{number}.stl"]')
    jobs = find_jobs([tmp_path], tmp_path / "out", ())
    found: list[JobOutcome] = []
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, processes=True
    ) as cluster:
        queue = ClusterQueue(cluster.scheduler_address, again=False)
        for job in jobs:
            queue.add(job)
        kills = 0
        while queue.left:
            found += queue.outcomes(0.2)
            if kills < 1 and queue.running:
                victim = list(cluster.workers.values())[kills % 2]
                os.kill(victim.pid, signal.SIGKILL)
                kills += 1
                time.sleep(1.0)
        queue.end()
    assert sorted(each.name for each in found) == [str(number) for number in range(3)]
    assert {each.state for each in found} == {"refused"}
    assert all("no such file" in each.message for each in found)
