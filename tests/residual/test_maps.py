"""Where a residual lives: maps against closed forms, windows that were put there, and noise in which there are none."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rig

from workbench.campaign import load
from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.carrying import load_errors
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, TWO_MASS, Geometry, Plant
from workbench.record import IDENTIFICATION, Record, Source
from workbench.residual.maps import (
    BINS,
    DIRECTION,
    STROKE,
    Coordinate,
    Pooled,
    binned,
    directions,
    maps,
    pooled,
)
from workbench.residual.residual_maps import angle_residual, drives, identifying, joint_stiffness
from workbench.residual.spectra import half, over_frequency, over_order
from workbench.residual.window import BACKWARD, DIRECTIONS, EITHER, FORWARD
from workbench.residual.windows import explained, likeliest, sentence, windows

RATE, BAND = 1000.0, 100.0
MASS = find("inertia")(inertia=1e-3)
PLANT = Plant(ONE_MASS, (MASS,), geometry=Geometry(gear_ratio=30.0))


def record(name: str, seed: int, **more: np.ndarray) -> Record:
    """A record that wanders over three radians both ways, in sweeps that never repeat."""
    t = np.arange(0, 12, 1 / RATE)
    phase = np.random.default_rng(seed).uniform(0, 6, 3)
    q = sum(
        a * np.sin(2 * np.pi * f * t + p) for a, f, p in zip((1.5, 0.6, 0.2), (0.31, 0.83, 2.3), phase, strict=True)
    )
    channels = {"torque": np.zeros(t.size), "position": q} | more
    units = dict.fromkeys(channels, "rad") | {"torque": "N*m"}
    return Record(name, IDENTIFICATION, t, channels, units, Source(Path(name), "0" * 64, "csv", {}), {"position": 1e-6})


@pytest.fixture(scope="module")
def inverses():
    return inverse_dynamics([record("one", 1), record("two", 2)], BAND)


@pytest.fixture(scope="module")
def pool(inverses):
    return pooled(inverses, PLANT, {n: np.sin(np.arange(12000) / 300) for n in ("one", "two")})


def of(pool: Pooled, name: str) -> Coordinate:
    return next(c for c in pool.coordinates if c.name == name)


def noise(pool: Pooled, seed: int = 5) -> np.ndarray:
    return np.random.default_rng(seed).normal(0.0, 1.0, pool.first.size)


# --- maps --------------------------------------------------------------------------------------------------------------


def test_every_coordinate_is_there_with_its_unit(pool):
    assert {c.name: c.unit for c in pool.coordinates} == {
        "position": "rad", "place in a turn": "rad", "place in a motor turn": "rad", "velocity": "rad/s",
        "acceleration": "rad/s^2", "load": "N*m", STROKE: "rad", DIRECTION: "1",
    }  # fmt: skip


def test_mean_and_rms_of_a_known_law_are_in_its_bins(pool):
    q = of(pool, "position")
    m = binned(q, 3.0 * q.values, pool)
    seen = m.count > 0
    width = np.diff(m.edges)[seen]
    assert np.all(np.abs(m.mean[seen] - 3.0 * m.centre[seen]) <= 1.5 * width + 1e-12)
    assert np.all(m.rms[seen] >= np.abs(m.mean[seen]) - 1e-12)
    assert m.count.sum() == q.values.size
    assert explained(maps(pool, q.values**3)[:3]) == pytest.approx(1.0, abs=0.01)


def test_the_ways_part_the_samples(pool):
    velocity = of(pool, "velocity")
    found = [binned(velocity, velocity.values, pool, way) for way in (EITHER, FORWARD, BACKWARD)]
    assert found[1].count.sum() + found[2].count.sum() == pytest.approx(found[0].count.sum(), rel=1e-3)
    forward = found[1].count[found[1].centre < -0.05].sum() / found[1].count.sum()
    assert forward < 0.01  # what moves forward has a positive velocity


def test_the_standard_error_is_that_of_independent_samples_where_each_is_a_visit():
    rng = np.random.default_rng(3)
    n = 400
    blank = Pooled(("x",), np.arange(n) == 0, np.ones(n), ())
    values = np.tile([0.5, 1.5], n // 2)  # every sample is in the other bin
    r = rng.normal(size=n)
    m = binned(Coordinate("x", "1", values, np.array([0.0, 1.0, 2.0])), r, blank)
    for k in (0, 1):
        assert m.error[k] == pytest.approx(np.std(r[k::2], ddof=1) / np.sqrt(n // 2))


def test_samples_of_one_visit_are_one_witness():
    """A hundred equal samples a visit: the error is that of the visits' means, not ten times less."""
    level = np.random.default_rng(4).normal(size=60)
    values, r = np.repeat(np.arange(60) % 2, 100) + 0.5, np.repeat(level, 100)
    blank = Pooled(("x",), np.arange(r.size) == 0, np.ones(r.size), ())
    m = binned(Coordinate("x", "1", values, np.array([0.0, 1.0, 2.0])), r, blank)
    assert m.error[0] == pytest.approx(np.std(level[::2], ddof=1) / np.sqrt(30))


def test_a_bin_visited_once_has_no_standard_error():
    blank = Pooled(("x",), np.arange(10) == 0, np.ones(10), ())
    m = binned(Coordinate("x", "1", np.linspace(0, 1, 10), np.array([0.0, 0.5, 1.0])), np.arange(10.0), blank)
    assert np.isnan(m.error).all() and np.isfinite(m.mean).all()


def test_stroke_is_counted_from_the_reversal():
    q = np.concatenate([np.linspace(0, 1, 101), np.linspace(1, 0.4, 61)[1:]])
    way, stroke = directions(q, 1e-4)
    assert way[50] == 1.0 and way[-1] == -1.0
    assert stroke[100] == pytest.approx(1.0, abs=1e-3) and stroke[-1] == pytest.approx(0.6, abs=0.02)


def test_an_axis_between_two_counts_does_not_reverse():
    q = 1e-3 * np.round(np.linspace(0, 20, 2001) + 0.4 * np.sin(np.arange(2001)))  # one count to and fro
    way, stroke = directions(q, 1e-3)
    assert set(way[200:]) == {1.0} and np.all(np.diff(stroke) >= 0)


# --- windows -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("way", [FORWARD, BACKWARD])
def test_a_window_of_position_and_direction_is_found(pool, way):
    q = of(pool, "position").values
    there = (q > 0.5) & (q < 0.9) & (pool.direction == way)
    found = likeliest([m for m in maps(pool, noise(pool) * np.where(there, 4.0, 1.0)) if m.coordinate == "position"])
    assert found.direction == way and found.stands_out
    reach = 0.1 * np.ptp(q)
    assert abs(found.low - 0.5) < reach and abs(found.high - 0.9) < reach
    assert found.times == pytest.approx(4.0, rel=0.15)
    said = f"times larger between {found.low:.3g} and {found.high:.3g} rad when moving {DIRECTIONS[way]}"
    assert sentence(found) == f"the residual is {found.times:.2g} {said}"


def test_noise_has_no_place_and_follows_nothing(pool):
    found = maps(pool, noise(pool))
    assert not any(p.stands_out for p in windows(found))
    for name in ("position", "velocity", STROKE):
        assert explained([m for m in found if m.coordinate == name]) < 0.01
    assert "about the same" in sentence(windows(found)[0])


def test_friction_in_one_window_and_one_direction_of_the_rig_is_found_there(tmp_path):
    truth = rig.campaign(tmp_path, 7, ("window_friction",), 2.0, short=True)
    campaign = load(tmp_path)
    inverses = identifying(inverse_dynamics(campaign.records, campaign.bandwidth))
    found = drives(inverses, identify(campaign.plant, inverses), None).before.windows[0]
    (low, high), (coordinate, _) = truth["where"][1][0], truth["where"]
    reach = 0.1 * max(np.ptp(p.motion.q) for p in inverses)
    assert found.coordinate == coordinate and found.direction == FORWARD and found.stands_out
    assert abs(found.low - low) < reach and abs(found.high - high) < reach


def test_larger_in_one_direction_is_said_so(pool):
    v = of(pool, "velocity").values
    (found,) = [p for p in windows(maps(pool, noise(pool) * np.where(v > 0, 3.0, 1.0))) if p.coordinate == DIRECTION]
    assert found.times == pytest.approx(3.0, rel=0.1) and sentence(found).endswith("times larger when moving forward")


# --- spectra -----------------------------------------------------------------------------------------------------------


def test_a_wave_over_position_is_a_line_at_its_order(inverses, pool):
    r = 0.3 * np.sin(9.0 * of(pool, "position").values + 1.0) + 0.05 * noise(pool)
    found = over_order(inverses, r, "rad")
    order, times = found.lines[0]
    assert order == pytest.approx(9.0, abs=0.25 * 2 * np.pi / np.ptp(of(pool, "position").values)) and times > 4.0
    assert found.at.size == found.amplitude.size and np.all(np.diff(found.at) > 0)


def test_power_over_frequency_is_the_residuals_own(inverses, pool):
    r = noise(pool)
    found = over_frequency(inverses, r)
    # white noise of rms 1 at 1 kHz: 1/500 a hertz
    inside = (found.at > 5) & (found.at < 100)
    assert np.mean(found.amplitude[inside] ** 2) == pytest.approx(2 / RATE, rel=0.05)


def test_half_of_the_power_is_where_it_was_put():
    at = np.linspace(0, 10, 101)
    assert half(at, np.where((at >= 4) & (at < 5), 1.0, 0.01)) == pytest.approx((4.0, 4.5), abs=0.25)


# --- the angle ---------------------------------------------------------------------------------------------------------


def test_of_two_masses_an_error_of_the_angle_shows_in_rad():
    """The load follows a joint whose deflection holds a wave that the model does not know."""
    k, inertia, size = 600.0, 2e-3, 2e-4
    q_l = record("x", 7).channels["position"]
    a_l = np.gradient(np.gradient(q_l, 1 / RATE), 1 / RATE)
    wave = size * np.sin(8.0 * q_l)
    r = record("x", 7, position=q_l + inertia * a_l / k + wave, load_position=q_l)
    joint = find("linear_stiffness")(at="joint", stiffness=k)
    plant = Plant(TWO_MASS, (MASS(at="motor"), MASS(at="load", inertia=inertia), joint))
    (p,) = inverse_dynamics([r], BAND)
    assert joint_stiffness([p], plant) == pytest.approx(k)
    found = angle_residual([p], plant)
    np.testing.assert_allclose(found, -wave[p.motion.keep], atol=0.05 * size)
    rms = lambda x: np.sqrt(np.mean(p.motion.filter(x)[p.motion.keep] ** 2))  # noqa: E731
    asked = rms(wave) / rms(inertia * a_l / k + wave)
    assert load_errors([p], plant) == {r.role: pytest.approx(asked, rel=0.02)}
    locked = replace(r, locked=True)
    assert load_errors(inverse_dynamics([locked], BAND), plant) == {}


def test_a_map_has_sixty_bins_at_most(pool):
    assert all(m.mean.size <= BINS for m in maps(pool, noise(pool)))
