"""What neighbours in bench time say of a residual: levels that no noise has, and a payload."""

import numpy as np

from workbench.tracing.judge import STANDARD
from workbench.tracing.lines import Part
from workbench.tracing.neighbours import over_time, payload_over_time


def level_of(level, of_way: bool = False) -> float:
    """What a residual that is a level over bench time, or of_way a friction, beside white noise of a tenth of it, could be predicted to in rms."""
    dt = 5e-3
    t = np.arange(round(40.0 / dt)) * dt
    way = np.sign(np.sin(1.3 * t))
    r = level(t) * (way if of_way else 1.0) + 0.1 * np.random.default_rng(3).standard_normal(t.size)
    outside = np.random.default_rng(4).standard_normal((t.size, 10))
    part = Part(r, outside, np.ones(t.size, bool), way, t, dt, r, outside[:, 0], 50.0)
    return float(np.sqrt(over_time([part], STANDARD.burst)[0] / t.size))


def wandering(t: np.ndarray) -> np.ndarray:
    """First-order noise of 0.3 Hz."""
    rng, x, a = np.random.default_rng(5), np.zeros(t.size), np.exp(-2 * np.pi * 0.3 * (t[1] - t[0]))
    for i, e in enumerate(rng.standard_normal(t.size - 1)):
        x[i + 1] = a * x[i] + np.sqrt(1 - a * a) * e
    return x


def test_a_level_that_leaks_away_and_is_recharged_is_no_noise_and_one_that_wanders_is():
    ends = np.cumsum(np.random.default_rng(6).uniform(1.3, 2.9, 40))

    def recharged(t):
        k = np.searchsorted(ends, t)
        start = np.concatenate([[0.0], ends])[k]
        return 1.7 * ((t - start) / (ends[k] - start) - 0.5)

    assert level_of(recharged) > 0.2 and level_of(wandering) < 0.05


def test_a_brake_that_drags_in_short_spells_is_no_noise():
    rng = np.random.default_rng(7)
    turns = np.cumsum(rng.uniform(0.25, 1.1, 80))

    def spells(t):
        return np.where(np.searchsorted(turns, t) % 2 == 0, 0.5, -0.5)

    assert level_of(spells, of_way=True) > 0.2


def carried(payload, seed: int = 8) -> tuple[float, float]:
    """What neighbours say of moves of 0.4 s with dwells between, as a payload and else. payload(rng, moves, t): force and mass (t.size,), noise 0.1."""
    dt = 5e-3
    t = np.arange(round(60.0 / dt)) * dt
    move, phase = np.divmod(t, 0.7)
    a = np.where(phase < 0.4, np.sin(2.0 * np.pi * phase / 0.4), 0.0)
    outside = np.zeros((t.size, 10))
    outside[:, 2] = a
    rng = np.random.default_rng(seed)
    force, mass = payload(rng, move.astype(int), t)
    r = force + mass * a + 0.1 * rng.standard_normal(t.size)
    part = Part(r, outside, phase < 0.4, np.ones(t.size), t, dt, r, a, 50.0)
    return tuple(float(np.sqrt(x / t.size)) for x in (payload_over_time([part]), over_time([part], STANDARD.burst)[0]))


def test_a_piece_that_is_carried_in_some_moves_and_not_in_others_is_a_mass_and_its_weight():
    """Its weight hides its mass from neighbours that are asked for a mass alone."""

    def piece(rng, move, t):
        held = rng.integers(0, 2, move[-1] + 1)[move] - 0.5
        return 0.4 * held, 1.0 * held

    payload, else_ = carried(piece)
    assert payload > 0.25 and payload > 1.4 * else_


def test_a_force_that_wanders_and_noise_are_no_payload():
    for force in (lambda rng, move, t: (wandering(t), 0.0), lambda rng, move, t: (0.0, 0.0)):
        assert carried(force)[0] == 0.0
