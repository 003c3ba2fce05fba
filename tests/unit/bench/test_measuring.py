"""What a computation takes is told apart from its result."""

import time

from amprep.bench.measuring import measured


def test_waiting_takes_time_on_the_clock_but_no_time_of_threads():
    def wait():
        time.sleep(0.2)
        return "done"

    result, spent = measured(wait)
    assert result == "done"
    assert spent.seconds >= 0.2
    assert spent.process_seconds < 0.1
    assert spent.memory_mb is None or spent.memory_mb > 1
