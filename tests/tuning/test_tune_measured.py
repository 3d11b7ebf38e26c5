"""Gains within a measured frequency response: a mode that the model lacks holds them back, and none leaves them as they are."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import expm

from workbench.description import Equivalent
from workbench.frequency import Response
from workbench.tuning import TuningGoal, sampled, tune, tune_within, tuned_axis
from workbench.tuning.measured import law_of

TS, TOTAL = 0.25e-3, 0.0046
LOOP = SimpleNamespace(sample_time=TS, delay=TS, velocity_filter=TS)
GOAL = TuningGoal()
FREE = Equivalent(np.array([1e-3, 1e-1]), np.zeros(2), np.zeros(2))


def response(mode: float | None, damping: float = 0.01) -> Response:
    """Acceleration over drive at the load of two free masses, in closed form; of one mass without a mode."""
    f = np.geomspace(1.0, 1000.0, 4000)
    s, w = 2j * np.pi * f, 2 * np.pi * (mode or 1.0)
    joint = (2 * damping * w * s + w**2) / (s**2 + 2 * damping * w * s + w**2) if mode else np.ones(f.size)
    return Response("shaken", f, joint / TOTAL, np.ones(f.size), 1e-3 * np.abs(joint) / TOTAL, 0.5, "periods", 10.0)


def sensitivity(gains, seen: Response) -> np.ndarray:
    """Largest |S| at each amplitude on the lines of a response."""
    clock = sampled.Clock.of(LOOP)
    return np.array([
        np.max(1 / np.abs(1 + law_of(kp, kd, seen, clock) * seen.receptance))
        for kp, kd in zip(gains.kp, gains.kd, strict=True)
    ])  # fmt: skip


def stable(gains, mode: float, damping: float = 0.01, motor: float = 0.0016) -> bool:
    """Whether the exact sampled loop of the two masses is stable at every amplitude: eigenvalues, the delay a sample."""
    load = TOTAL - motor
    k = motor * load / TOTAL * (2 * np.pi * mode) ** 2
    c = 2 * damping * k / (2 * np.pi * mode)
    a = np.zeros((5, 5))  # motor q, v; load q, v; u
    a[0, 1] = a[2, 3] = 1.0
    a[1, :4] = np.array([-k, -c, k, c]) / motor
    a[3, :4] = np.array([k, c, -k, -c]) / load
    a[1, 4] = 1.0 / motor
    step = expm(a * TS)
    for kp, kd in zip(gains.kp, gains.kd, strict=True):
        whole = np.zeros((7, 7))  # the four, y before, vh, u of the sample before
        whole[:4, :4], whole[:4, 6] = step[:4, :4], step[:4, 4]
        alpha = 1.0 - np.exp(-1.0)
        whole[4, 2] = 1.0
        whole[5, [2, 4, 5]] = alpha / TS, -alpha / TS, 1.0 - alpha
        whole[6] = -kd * whole[5]
        whole[6, 2] -= kp
        if np.abs(np.linalg.eigvals(whole)).max() > 1.0 + 1e-9:
            return False
    return True


@pytest.mark.parametrize("mode", [150.0, 300.0])
def test_a_mode_that_the_model_lacks_holds_the_gains_back_until_the_sensitivity_is_kept(mode):
    seen = response(mode)
    free = tune(FREE, TOTAL, 0.0, GOAL, LOOP, margins=False)
    held = tune_within(seen, FREE, TOTAL, 0.0, GOAL, LOOP, margins=False)
    assert (held.kp < 0.9 * free.kp).all()
    assert not stable(free, mode) and stable(held, mode)
    assert 1.7 < sensitivity(held, seen).max() <= 2.03  # no more is given away than the response asks for
    (finding,) = (f for f in held.findings if f.kind == "response limits")
    assert "shaken" in finding.sentence and finding.evidence["share"] < 1.0


def test_presliding_stiffness_stands_beside_the_response_of_sliding():
    """With the stiffness that the model has at that amplitude, the loop of one mass keeps its own peak."""
    stiff = Equivalent(np.array([1e-4, 1e-2]), np.array([150.0, 10.0]), np.array([60.0, 5.0]))
    free, held = (
        f(stiff, TOTAL, 0.0, GOAL, LOOP, margins=False)
        for f in (tune, lambda *a, **k: tune_within(response(None), *a, **k))
    )
    np.testing.assert_array_equal(held.kp, free.kp)


def test_without_a_mode_the_gains_are_those_of_the_model():
    seen = response(None)
    free, held = (
        f(FREE, TOTAL, 0.0, GOAL, LOOP, margins=False) for f in (tune, lambda *a, **k: tune_within(seen, *a, **k))
    )
    np.testing.assert_array_equal(free.kp, held.kp)
    assert free.findings == held.findings


def test_the_law_is_that_of_the_sampled_loop():
    """On the response of a free mass it gives the loop that tuning has, whose hold is exact."""
    seen, clock = response(None), sampled.Clock.of(LOOP)
    kp, kd = 40.0, 0.9
    theta = seen.omega * TS
    plant = sampled.response(theta, sampled.steps(np.zeros(1), np.zeros(1), clock), clock)[0] * TS**2 / TOTAL
    exact = (kp + kd / TS * sampled.difference(theta, clock)) * plant
    low = seen.frequency < 400.0
    np.testing.assert_allclose((law_of(kp, kd, seen, clock) * seen.receptance)[low], exact[low], rtol=0.02)


def test_a_study_tunes_within_the_response_of_its_records():
    """The gains at each amplitude that a controller is designed from are those that the measured mode allows."""
    from workbench.definition import find
    from workbench.plant import Limits, Plant
    from workbench.simulation import Loop

    plant = Plant(
        "one mass",
        (find("inertia")(inertia=TOTAL), find("presliding_hysteresis")(h0=0.1, x0=1e-3)),
        limits=Limits(drive=GOAL.drive, speed=GOAL.speed),
    )
    loop = Loop(TS, delay=TS, velocity_filter=TS, resolution=1e-6)
    amplitudes = np.geomspace(1e-3, 0.1, 4)
    free, held = (tuned_axis(plant, amplitudes, GOAL, loop, response=r).gains for r in (None, response(150.0)))
    assert (held.kp[-2:] < 0.9 * free.kp[-2:]).all()
    assert any(f.kind == "response limits" for f in held.findings)
