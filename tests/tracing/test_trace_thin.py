"""Records that a trace looks at: at a low rate, with all that counts in the band, and nothing folded into it."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, Record, Source
from workbench.tracing.decimation import LEAST, decimate, decimated, ratio

SOURCE = Source(Path("made"), "", "made", {})
BAND = 150.0


def record(rate: float, seconds: float = 4.0, start: float = 0.0) -> Record:
    t = start + np.arange(round(seconds * rate)) / rate
    position = np.sin(2 * np.pi * 3.0 * t) + 0.01 * np.sin(2 * np.pi * 90.0 * t) + 0.3 * t
    return Record("made", IDENTIFICATION, t, {"torque": np.cos(40.0 * t), "position": position}, {}, SOURCE, {})


@pytest.mark.parametrize("rate, kept", [(1000.0, Fraction(3, 5)), (2000.0, Fraction(3, 10)), (5000.0, Fraction(1, 8))])
def test_a_log_is_kept_at_the_least_ratio_that_holds_the_band(rate, kept):
    assert ratio(rate, BAND) == kept


@pytest.mark.parametrize("rate", [500.0, 599.0, 610.0, 777.0, 1234.5, 9999.0, 1e5])
def test_no_ratio_keeps_less_than_the_band_needs(rate):
    kept = float(ratio(rate, BAND)) * rate
    assert min(rate, LEAST * BAND) <= kept * (1 + 1e-12) and kept <= rate


def test_a_slow_log_is_kept_as_it_is():
    slow = record(500.0)
    assert decimated(slow, BAND) is slow


@pytest.mark.parametrize("rate", [1000.0, 2000.0, 4321.0])
def test_a_thinned_record_is_the_motion_read_at_another_time(rate):
    fine = record(rate, start=7.0)
    found = decimated(fine, BAND)
    t = found.time
    assert t[0] == 7.0 and t[-1] <= fine.time[-1] + 1e-12 and np.ptp(np.diff(t)) <= 1e-9
    exact = np.sin(2 * np.pi * 3.0 * t) + 0.01 * np.sin(2 * np.pi * 90.0 * t) + 0.3 * t
    inside = slice(60, -60)
    assert np.abs(found.channels["position"] - exact)[inside].max() <= 1e-5


def test_a_model_that_is_right_on_the_record_is_right_on_the_thinned_one():
    """Where the axis ends elsewhere than it began, the filters of a decimated record once rang through all of it."""
    t = np.arange(6000) / 1000.0
    w, move = 2 * np.pi * 20.0, 1.0 / (1.0 + np.exp(-20.0 * (t - 3.0)))
    speed = 20.0 * move * (1.0 - move)
    q, v = move + 0.01 * np.sin(w * t), speed + 0.01 * w * np.cos(w * t)
    a = 20.0 * speed * (1.0 - 2.0 * move) - 0.01 * w**2 * np.sin(w * t)
    made = Record("made", IDENTIFICATION, t, {"torque": 0.02 * a + 0.3 * v * np.abs(v), "position": q}, {}, SOURCE, {})
    plant = Plant(ONE_MASS) + find("inertia")(inertia=0.01) + find("nonlinear_viscous_friction")
    fit = identify(plant, decimate(inverse_dynamics([made], BAND)))
    assert fit.identification < 1e-4
    assert [e.value for e in fit.estimates] == pytest.approx([0.02, 0.3], rel=1e-4)


def dwelling() -> tuple[Plant, list]:
    """Moves of 0.5 s with as long a rest between, in which the drive ramps within what stiction holds."""
    t = np.arange(8000) / 1000.0
    moving = (t // 0.5) % 2 == 0
    w = 2 * np.pi * 2.0
    v = np.where(moving, (0.1 + np.sin(w * t) ** 2) * np.where(t // 1.0 % 2 == 0, 1.0, -1.0), 0.0)
    q = np.cumsum(v) / 1000.0
    friction = np.where(np.abs(v) > 0.0, np.sign(v), 0.0)
    ramp = np.where(moving, 0.0, 0.8 - 3.2 * (t % 0.5))
    drive = 0.3 * v + 0.5 * friction + 0.5 * ramp
    position = np.round(q / 1e-5) * 1e-5
    made = Record("made", IDENTIFICATION, t, {"torque": drive, "position": position}, {}, SOURCE, {"position": 1e-5})
    plant = Plant(ONE_MASS) + find("viscous_friction") + find("coulomb_friction")
    return plant, inverse_dynamics([made], BAND)


def test_what_stiction_holds_at_rest_does_not_bend_the_friction_that_is_fitted():
    plant, inverses = dwelling()
    told = {e.parameter: e.value for e in identify(plant, decimate(inverses, plant)).estimates}
    bent = {e.parameter: e.value for e in identify(plant, decimate(inverses)).estimates}
    for name, value in {"coulomb": 0.5, "viscous": 0.3}.items():  # the moments beside a rest still count
        assert abs(told[name] - value) < 0.4 * abs(bent[name] - value)


def test_rest_counts_where_friction_has_a_memory_or_is_none():
    plant, inverses = dwelling()
    assert decimate(inverses, plant)[0].counts is not None
    for other in (plant.without("coulomb_friction@axis"), plant + find("presliding_hysteresis")):
        assert decimate(inverses, other)[0].counts is None
