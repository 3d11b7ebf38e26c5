"""What noise of the drive and counts of the encoder would leave of a right model."""

import numpy as np
import pytest

from workbench.definition import find
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record
from workbench.residual.noise_floor import TOLD, fitted, noise_rms, refuted

DT, BAND, COUNT = 1e-3, 50.0, 1e-6
NOISE, LEVEL = 0.1, 30.0  # N, of the drive and of friction
RESTS = 0.5  # s, of every one and a half


def moves_with_rests() -> tuple[Record, np.ndarray]:
    """Return moves to and fro with rests between, and where (n,) the axis moves. At rest it trembles by a count."""
    t = DT * np.arange(12_000)
    period, run = 1.5, 1.5 - RESTS
    k, s = np.divmod(t, period)
    s = np.clip(s / run, 0.0, 1.0)
    way = np.where(k % 2 == 0, 1.0, -1.0)
    q = 0.05 * np.where(k % 2 == 0, 1.0 - np.cos(np.pi * s), 1.0 + np.cos(np.pi * s)) / 2.0
    a = way * 0.025 * (np.pi / run) ** 2 * np.cos(np.pi * s) * (s < 1.0)
    rng = np.random.default_rng(1)
    drive = a + NOISE * rng.standard_normal(t.size)
    trembling = np.round(0.7 * np.sin(2 * np.pi * 4.0 * t)) * (s >= 1.0)  # counts
    read = COUNT * (np.round(q / COUNT) + trembling)
    record = Record("moves", IDENTIFICATION, t, {"force": drive, "position": read}, resolution={"position": COUNT})
    return record, s < 1.0


def test_white_noise_of_the_drive_is_read_above_the_band():
    record, _ = moves_with_rests()
    (inverse,) = inverse_dynamics([record], BAND)
    inside = inverse.motion.filter(NOISE * np.random.default_rng(2).standard_normal(record.time.size))
    found = noise_rms([inverse], Plant(ONE_MASS, rotary=False) + find("inertia")(inertia=1.0))["moves"]
    assert found == pytest.approx(np.std(inside), rel=0.1)


def test_friction_that_flickers_within_a_count_at_a_rest_that_does_not_count_is_no_noise():
    record, moves = moves_with_rests()
    (everywhere,) = inverse_dynamics([record], BAND)
    moving = InverseDynamics(everywhere.motion, counts=np.tile(moves, (2, 1)))
    friction = find("presliding_hysteresis")(h0=LEVEL, x0=COUNT / 3.0)
    steep = Plant(ONE_MASS, rotary=False) + find("inertia")(inertia=1.0) + friction
    assert noise_rms([moving], steep)["moves"] < 0.1 * noise_rms([everywhere], steep)["moves"]


@pytest.mark.parametrize(
    ("left", "floor"),
    [
        ((0.02, 0.02), (0.02, 0.02)),  # what is left is above it
        ((0.015, 0.016), (0.015, 0.016)),  # a fifth too high; of identification within the tenth that is no alarm
        ((0.005, 0.016), (0.016 * TOLD, 0.016)),  # identification alone has less yet: that is an alarm
        ((0.005, 0.02), (0.02, 0.02)),  # as before: nothing that was not fitted says so
        ((0.001, 0.001), (0.02, 0.02)),  # so little is left by what has seen the drive
        ((0.015, float("nan")), (0.02, 0.02)),
    ],
)
def test_a_floor_is_no_higher_than_what_a_record_shows_that_was_not_fitted(left, floor):
    found = refuted(
        {IDENTIFICATION: 0.02, VALIDATION: 0.02}, dict(zip((IDENTIFICATION, VALIDATION), left, strict=True))
    )
    expected = dict(zip((IDENTIFICATION, VALIDATION), floor, strict=True))
    assert found == pytest.approx(expected)


@pytest.mark.parametrize(("values", "floor"), [(0.003, 0.0176), (0.03, 0.02)])
def test_a_floor_is_no_higher_than_what_few_values_leave_of_many_samples(values, floor):
    """A worm's table left 0.88 of what its counts were read to make, and an alarm stood on its first page."""
    found = refuted({IDENTIFICATION: 0.02, VALIDATION: 0.02}, {IDENTIFICATION: 0.0176, VALIDATION: 0.03}, values)
    assert found == pytest.approx({IDENTIFICATION: floor, VALIDATION: floor})


def test_what_few_values_are_goes_with_the_band_and_the_time_of_the_identification_records():
    record, _ = moves_with_rests()
    (seen,) = inverse_dynamics([record], BAND)
    m = seen.motion
    kept = (m.keep.stop - m.keep.start) * m.dt
    assert fitted(10, [seen]) == pytest.approx(10 / (2.0 * BAND * kept))
    assert fitted(10, []) == 1.0
