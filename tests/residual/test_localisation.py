"""Where a residual lives, on residuals whose place is known by construction."""

from types import SimpleNamespace

import numpy as np
import pytest

from workbench.residual.change_points import with_change_points
from workbench.residual.localisation import change_windows, localise
from workbench.residual.samples import Samples, relative_rms
from workbench.residual.window import local

N, NOISE = 6000, 0.1


def samples(rng) -> Samples:
    """An axis that sweeps to and fro at three speeds, 1 ms a sample."""
    t = 1e-3 * np.arange(N)
    speed = np.repeat([1.0, 3.0, 8.0], N // 3)
    phase = np.cumsum(speed) * 1e-3
    v = speed * np.cos(phase)
    return Samples(np.sin(phase), v, np.sign(v), t, np.ones(N, bool), np.full(N, NOISE))


class Linear:
    """A model that is linear in its columns, as Deviations are."""

    def __init__(self, columns: np.ndarray):
        self.columns = columns / np.linalg.norm(columns, axis=0)

    def without(self, residual, out):
        d = np.linalg.lstsq(self.columns[~out], residual[~out], rcond=None)[0]
        return residual - self.columns @ d


def residual_of(what: np.ndarray, known: Samples, rng) -> tuple[np.ndarray, Linear]:
    """What a model of viscous and dry friction, gravity and a constant leaves of a force: it smears it over the record."""
    model = Linear(np.stack([known.v, np.sign(known.v), known.q, np.ones(N)], axis=1))
    force = what + NOISE * rng.standard_normal(N)
    return model.without(force, np.zeros(N, bool)), model


def place_of(pair, known):
    return localise(pair[0], known, pair[1])


@pytest.mark.parametrize("seed", range(3))
def test_friction_in_one_window_and_one_way_is_found_however_the_fit_smears_it(seed):
    rng = np.random.default_rng(seed)
    known = samples(rng)
    inside = (known.q > -0.3) & (known.q < 0.25) & (known.v > 0)
    found = place_of(residual_of(2.0 * inside, known, rng), known)
    assert (found.coordinate, found.direction) == ("position", 1) and local(found)
    assert found.spans[0] == pytest.approx((-0.3, 0.25), abs=0.05)
    assert found.outside == pytest.approx(1.0, abs=0.1)  # nothing but noise outside


def test_a_rattle_at_some_speeds_is_found_there():
    rng = np.random.default_rng(4)
    known = samples(rng)
    inside = (np.abs(known.v) > 2.0) & (np.abs(known.v) < 3.2)
    found = place_of(residual_of(inside * np.sin(300 * known.t), known, rng), known)
    assert found.coordinate == "velocity" and found.spans[0] == pytest.approx((2.0, 3.2), abs=0.25)


def test_moments_are_named_where_no_window_is_a_place():
    rng = np.random.default_rng(5)
    known = samples(rng)
    inside = np.zeros(N)
    for start in (0.4, 1.7, 2.9, 3.3, 5.2):
        inside[(known.t > start) & (known.t < start + 0.1)] = 2.0
    found = place_of(residual_of(inside, known, rng), known)
    assert found.coordinate == "time"
    assert [s[0] for s in found.spans] == pytest.approx([0.4, 1.7, 2.9, 3.3, 5.2], abs=0.03)


def test_a_residual_that_is_everywhere_has_no_place():
    rng = np.random.default_rng(6)
    known = samples(rng)
    found = place_of(residual_of(np.sin(40 * known.t), known, rng), known)
    assert not local(found)


def test_noise_alone_has_no_place():
    rng = np.random.default_rng(7)
    known = samples(rng)
    residual, model = residual_of(np.zeros(N), known, rng)
    quiet = SimpleNamespace(**{**vars(known), "floor": np.full(N, 2 * NOISE)})
    assert localise(residual, quiet, model) is None


def test_jumps_of_the_level_are_found_at_their_moments():
    rng = np.random.default_rng(8)
    known = samples(rng)
    moments = [0.7, 1.9, 2.6, 4.4, 5.1]
    level = sum(s * (known.t > m) for s, m in zip([1.0, -0.6, 0.8, 1.1, -1.4], moments, strict=True))
    residual, model = residual_of(level, known, rng)
    found = change_windows(residual, known, model)
    assert [0.5 * (a + b) for a, b in found.spans] == pytest.approx(moments, abs=0.01)
    assert found.outside == pytest.approx(1.0, abs=0.05) and found.share > 0.95


def test_beside_jumps_that_are_told_a_model_leaves_noise():
    rng = np.random.default_rng(8)
    known = samples(rng)
    moments = [1.9, 4.4]
    level = sum(s * (known.t > m) for s, m in zip([0.6, -1.1], moments, strict=True))
    residual, model = residual_of(level, known, rng)
    assert relative_rms(
        with_change_points(residual, known.t, known.drive, model, moments), known.drive, known
    ) == pytest.approx(1, abs=0.05)
    assert relative_rms(with_change_points(residual, known.t, known.drive, model, [1.9]), known.drive, known) > 2.0


def test_what_comes_and_goes_with_the_motion_is_no_jump_of_the_level():
    rng = np.random.default_rng(9)
    known = samples(rng)
    residual, model = residual_of(np.sin(3 * known.q + 1) * known.q, known, rng)
    assert change_windows(residual, known, model) is None


def test_a_level_that_jumps_after_the_last_sample_jumps_nowhere():
    t = 1e-2 * np.arange(400)
    residual = np.where(t < 2.0, 1.0, -1.0) + 0.1 * np.random.default_rng(1).standard_normal(t.size)
    model = Linear(np.sin(t)[:, None])
    drive = np.ones(t.size, bool)
    left = with_change_points(residual, t, drive, model, [2.0, t[-1] + 1.0])
    np.testing.assert_array_equal(left, with_change_points(residual, t, drive, model, [2.0]))
    assert np.std(left) < 0.2
