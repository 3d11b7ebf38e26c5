"""Where friction turns along a measured motion."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from workbench.definition import find
from workbench.effects.direction import stop_direction
from workbench.identification.fit import identify
from workbench.inverse import dynamics
from workbench.inverse.dynamics import InverseDynamics
from workbench.inverse.turning import FULL, turned
from workbench.kernel.step import build
from workbench.motion import LowPass, motion
from workbench.plant import Plant
from workbench.record import Record

RATE, BAND = 1000.0, 50.0
COUNT = 1e-5


def seen(q: np.ndarray) -> np.ndarray:
    return np.round(q / COUNT) * COUNT


def stopped(q: np.ndarray) -> np.ndarray:
    """The direction of a stop operator two counts wide along a position."""
    dq = np.diff(q, prepend=q[:1])
    return build(stop_direction(2 * COUNT)).run({"dq": dq}, {"width": 2 * COUNT})[1]


def turns(direction: np.ndarray) -> np.ndarray:
    """Times in samples at which a direction turns: of each swing the mean of its way, as an area says it."""
    i = np.flatnonzero(direction[:-1] * direction[1:] < 0.0)
    return i + direction[i] / (direction[i] - direction[i + 1])


@pytest.mark.parametrize("hertz", [1.3, 3.7, 8.1])
def test_a_quantised_swing_turns_where_its_speed_passes_zero_and_not_some_counts_later(hertz):
    t = np.arange(4000) / RATE
    q = 3e-3 * np.sin(2 * np.pi * hertz * t)
    smooth, v = LowPass(2 * BAND, RATE, t.size).derivatives(seen(q), 2)
    late = stopped(seen(q))
    true = RATE * (np.arange(int(2 * 4.0 * hertz)) + 0.5) / (2 * hertz)
    inside = (true > 100) & (true < 3900)

    def away(direction):
        found = turns(direction)
        return np.array([np.min(np.abs(found - x)) for x in true[inside]])

    assert away(late).min() > 0.6
    assert np.median(away(turned(late, smooth, v, RATE / (2 * BAND)))) < 0.15 * np.median(away(late))


def test_the_sample_about_a_turn_has_the_mean_of_its_interval():
    v = np.array([1.0, 1.0, 0.3, -0.7, -1.0, -1.0, -1.0])
    x = np.array([1.0, 1.0, 1.0, 1.0, 0.2, -1.0, -1.0])
    result = turned(x, np.cumsum(v), v, 0.0)
    assert result == pytest.approx(
        [1.0, 1.0, 0.6, -1.0, -1.0, -1.0, -1.0]
    )  # at 2.3: 0.8 of the interval about 2 before it
    assert np.sum(result) == pytest.approx(2 * (2.3 + 0.5) - 7)


def test_what_moves_less_than_the_width_does_not_turn():
    v = np.tile([1.0, -1.0], 10)
    x = np.concatenate([np.ones(4), np.tile([0.5, 0.9], 8)])
    assert np.array_equal(turned(x, np.cumsum(v), v, 10.0), x)


@given(
    st.lists(st.floats(-3.0, 3.0), min_size=2, max_size=80), st.lists(st.floats(-1.0, 1.0), min_size=80, max_size=80)
)
@example([np.nextafter(-1.0, 0.0), 2.0], [0.0] * 80)  # one rounding below its width, it slides
def test_a_direction_stays_a_direction_and_a_mirrored_motion_has_the_mirrored_one(steps, speeds):
    x, v = np.clip(np.cumsum(steps), -1.0, 1.0), np.array(speeds[: len(steps)])
    result = turned(x, np.cumsum(v), v, 0.0)
    assert np.abs(result).max() <= 1.0
    assert np.array_equal(turned(-x, -np.cumsum(v), -v, 0.0), -result)
    slides = np.flatnonzero(np.abs(x) >= FULL)
    before = slides[0] if slides.size else x.size  # all of a motion that never slides
    assert np.array_equal(result[:before], x[:before])


def test_coulomb_friction_of_a_coarse_encoder_leaves_what_its_counts_leave_and_not_its_lateness(monkeypatch):
    t = np.arange(6000) / RATE
    q = 1e-3 * (1.0 + t) * np.sin(2 * np.pi * 1.7 * t)
    v = np.gradient(q, t)
    between = t[:, None] + np.linspace(-0.5, 0.5, 41) / RATE  # a drive's log holds the mean of its sample
    u = 0.002 * np.gradient(v, t) + 0.2 * np.sign(np.interp(between, t, v)).mean(axis=1)
    record = Record("r", "identification", t, {"torque": u, "position": seen(q)}, resolution={"position": COUNT})
    plant = Plant("one mass", (find("inertia")(inertia=0.001), find("coulomb_friction")(coulomb=0.1)))
    fit = identify(plant, [InverseDynamics(motion(record, BAND))])
    assert fit.plant["coulomb_friction"].parameters["coulomb"].value == pytest.approx(0.2, rel=5e-3)
    monkeypatch.setattr(dynamics, "turned", lambda direction, *_: direction)
    late = identify(plant, [InverseDynamics(motion(record, BAND))])
    assert fit.identification < 0.2 * late.identification
