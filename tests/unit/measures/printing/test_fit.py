"""The speed that is fitted to a log is the one by which the log was made."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.arrays import Floats
from amprep.measures.printing.fit import LEAST_LAYERS, fit_speed


def areas(count: int, seed: int = 0) -> Floats:
    """Areas of the layers of a build: smooth, with steps."""
    rng = np.random.default_rng(seed)
    z = np.linspace(0.0, 1.0, count)
    smooth = 3000.0 + 1500.0 * np.sin(7.0 * z)
    return np.asarray(smooth * np.where(z < rng.uniform(0.3, 0.6), 1.0, 0.4))


@given(st.floats(0.0, 30.0), st.floats(10.0, 500.0), st.integers(0, 99))
@examples(20)
def test_an_exact_log_gives_its_speed(recoating: float, speed: float, seed: int) -> None:
    area = areas(200, seed)
    found = fit_speed(recoating + area / speed, area)
    assert found.recoating_s == pytest.approx(recoating, abs=1e-6)
    assert found.scan_mm2_s == pytest.approx(speed, rel=1e-6)
    assert found.left_out == 0
    assert found.total_error < 1e-6
    assert found.worst_error < 1e-6


def test_noise_and_pauses_hardly_move_it() -> None:
    rng, area = np.random.default_rng(3), areas(900)
    seconds = 9.0 + area / 120.0 + rng.normal(0.0, 0.5, 900)
    seconds[rng.choice(900, 40, replace=False)] += rng.uniform(60.0, 7200.0, 40)
    found = fit_speed(seconds, area)
    assert found.recoating_s == pytest.approx(9.0, abs=0.2)
    assert found.scan_mm2_s == pytest.approx(120.0, rel=0.01)
    assert 35 <= found.left_out <= 45
    assert found.total_error < 0.01
    assert found.worst_error < 0.03


def test_the_error_is_that_of_layers_that_were_not_fitted() -> None:
    area = areas(300)
    bent = 8.0 + area / 100.0 + 1e-6 * area**2  # no line fits
    found = fit_speed(bent, area)
    trained = np.arange(300) % 3 == 0
    slope, base = np.polyfit(area[trained], bent[trained], 1)
    predicted = base + slope * area[~trained]
    expected = abs(predicted.sum() - bent[~trained].sum()) / bent[~trained].sum()
    assert found.left_out == 0
    assert found.total_error == pytest.approx(expected, rel=1e-6)
    assert found.worst_error > found.total_error


def test_a_log_that_cannot_tell_the_speed_is_refused() -> None:
    area = areas(200)
    with pytest.raises(ValueError, match="at least 30 layers, got 29"):
        fit_speed(area[: LEAST_LAYERS - 1], area[: LEAST_LAYERS - 1])
    with pytest.raises(ValueError, match="too much alike"):
        fit_speed(np.full(200, 10.0), np.full(200, 500.0))
    with pytest.raises(ValueError, match="do not take longer"):
        fit_speed(100.0 - area / 100.0, area)
