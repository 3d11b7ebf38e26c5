"""A notch behind a law: what it lets through, and that it changes nothing where it has no depth."""

from types import SimpleNamespace

import numpy as np
import pytest

from workbench.control import fixed_pd, law_named
from workbench.control.notched import coefficients, notched, response
from workbench.errors import WorkbenchError

DT = 2.5e-4
NOTCH = SimpleNamespace(centre=150.0, damping=0.7, depth=0.2)


def through(controller, e: np.ndarray) -> np.ndarray:
    """Return what a notched fixed PD commands where the error is e (n,) and nothing moves."""
    z, out = SimpleNamespace(notch_first=0.0, notch_second=0.0), []
    p = SimpleNamespace(**controller.parameters)
    for one in e:
        after, u = controller.law.step(SimpleNamespace(e=one, vh=0.0), z, p)
        z = SimpleNamespace(**after)
        out.append(u)
    return np.array(out)


@pytest.mark.parametrize("frequency", [20.0, 150.0, 600.0])
def test_a_sine_comes_through_with_the_gain_that_the_response_says(frequency):
    made = notched(fixed_pd(1.0, 0.0), NOTCH, DT)
    t = DT * np.arange(4000)
    u = through(made, np.sin(2 * np.pi * frequency * t))[2000:]
    basis = np.stack([np.sin(2 * np.pi * frequency * t), np.cos(2 * np.pi * frequency * t)], axis=1)[2000:]
    a, b = np.linalg.lstsq(basis, u, rcond=None)[0]
    expected = response([NOTCH], np.array([2 * np.pi * frequency * DT]), DT)[0]
    assert a + 1j * b == pytest.approx(expected, rel=1e-6)


def test_at_its_centre_a_notch_passes_its_depth_and_a_constant_whole():
    theta = np.array([1e-9, 2 * np.pi * NOTCH.centre * DT])
    whole, deep = np.abs(response([NOTCH], theta, DT))
    assert whole == pytest.approx(1.0) and deep == pytest.approx(NOTCH.depth)


def test_without_depth_a_notch_is_none():
    made = notched(fixed_pd(2.0, 0.0), SimpleNamespace(centre=150.0, damping=0.7, depth=1.0), DT)
    e = np.random.default_rng(1).standard_normal(200)
    assert through(made, e) == pytest.approx(2.0 * e)


def test_notches_of_lanes_are_those_of_each_and_the_law_is_known_by_its_name():
    lanes = SimpleNamespace(centre=np.array([100.0, 300.0]), damping=0.7, depth=np.array([0.1, 0.5]))
    each = [coefficients(SimpleNamespace(centre=c, damping=0.7, depth=d), DT) for c, d in ((100.0, 0.1), (300.0, 0.5))]
    assert np.array(coefficients(lanes, DT)).T == pytest.approx(np.array(each))
    made = notched(fixed_pd(1.0, 0.0), lanes, DT)
    assert law_named(made.law.name) is made.law


def test_a_notch_beyond_half_the_sampling_rate_is_refused():
    with pytest.raises(WorkbenchError, match="below 2000 Hz"):
        notched(fixed_pd(1.0, 0.0), SimpleNamespace(centre=2500.0, damping=0.7, depth=0.2), DT)
