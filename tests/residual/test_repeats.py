"""What does not repeat: the noise on a motion that comes again, and nothing of what comes again with it."""

from pathlib import Path

import numpy as np
import pytest

from workbench.motion import Motion, motion
from workbench.record import IDENTIFICATION, Record, Source
from workbench.residual.repeats import between, repeats

DT, PERIOD, TURNS = 2e-3, 2.0, 8
T = DT * np.arange(int(TURNS * PERIOD / DT))


def moved(harmonic: float = 0.0) -> Motion:
    """A position that comes again every two seconds."""
    angle = 2 * np.pi * T / PERIOD
    q = 0.1 * np.sin(angle) + harmonic * np.sin(2 * angle)
    source = Source(Path("made"), "", "made", {})
    return motion(Record("made", IDENTIFICATION, T, {"position": q, "force": 0 * q}, {}, source), 40.0)


def noise(size: float, seed: int) -> np.ndarray:
    return size * np.random.default_rng(seed).normal(size=T.size)


def test_the_noise_is_found_whatever_comes_again_with_the_motion():
    m = moved()
    again = 5.0 * m.q / 0.1 + 3.0 * np.sign(m.v) * (np.abs(m.v) > 0.02) + m.v**2
    found = repeats(m, again + noise(0.2, 1))
    assert found.rms == pytest.approx(0.2, rel=0.06) and found.robust == pytest.approx(0.2, rel=0.06)
    assert found.share > 0.99


def test_what_comes_again_alone_leaves_next_to_nothing():
    m = moved()
    assert repeats(m, 5.0 * m.q / 0.1).rms < 0.01


def test_a_few_outliers_move_the_rms_and_not_the_robust_value():
    m, r = moved(), noise(0.2, 2)
    r[np.random.default_rng(8).random(T.size) < 0.01] += 10.0
    found = repeats(m, r)
    assert found.rms > 0.8 and found.robust == pytest.approx(0.2, rel=0.1)


def test_a_motion_that_never_comes_again_is_said_to_tell_nothing():
    source = Source(Path("made"), "", "made", {})
    record = Record("made", IDENTIFICATION, T, {"position": 0.1 * T, "force": 0 * T}, {}, source)
    found = repeats(motion(record, 40.0), noise(1.0, 3), apart=20.0)
    assert np.isnan(found.rms) and found.share == 0.0 and found.pairs == 0


def test_what_differs_between_records_is_told_whole():
    """An offset on another day is no noise, and whoever knows one day alone is left with it."""
    one, other = moved(), moved()
    first, second = noise(0.1, 4), noise(0.1, 5) + 0.5
    assert repeats(other, second).rms == pytest.approx(0.1, rel=0.06)
    assert between(one, first, other, second).rms == pytest.approx(np.sqrt(0.5**2 + 2 * 0.1**2), rel=0.03)


def test_states_that_the_other_record_did_not_meet_do_not_count():
    assert between(moved(), noise(0.1, 6), moved(0.05), noise(0.1, 7)).share < 0.3
