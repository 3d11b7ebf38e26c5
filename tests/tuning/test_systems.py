"""Plant and law as python-control's objects: the same responses and margins that tuning takes from the sampled loop."""

from dataclasses import replace

import control
import numpy as np
import pytest

from workbench.description import Equivalent
from workbench.simulation import Loop
from workbench.tuning import sampled
from workbench.tuning.axis import Axis
from workbench.tuning.margins import margins
from workbench.tuning.systems import law_system, plant_system

LOOP = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4)
SPRING = Equivalent(np.array([1e-5, 1e-2]), np.array([95.0, 11.6]), np.array([0.1, 13.1]))
KP, KD = 400.0, 5.0


@pytest.mark.parametrize("delay", [0.0, 1e-4, 2.5e-4, 6e-4])
def test_the_objects_have_the_responses_of_the_sampled_loop(delay):
    axis = Axis.of(SPRING, 0.0074, 0.01, replace(LOOP, delay=delay))
    theta = np.geomspace(1e-3, 3.0, 50)
    kp = np.full(2, KP / axis.unit_kp)
    expected = sampled.response(theta, axis.steps(kp), axis.clock) / axis.unit_kp
    z = np.exp(1j * theta)
    for row in (0, 1):
        assert np.ravel(plant_system(axis, row, KP)(z)) == pytest.approx(expected[row], rel=1e-9)
    law = KP + KD / LOOP.sample_time * sampled.difference(theta, axis.clock)
    assert np.ravel(law_system(KP, KD, axis.clock)(z)) == pytest.approx(law, rel=1e-9)


def test_the_loop_as_an_object_has_the_margins_that_are_reported():
    axis = Axis.of(SPRING, 0.0074, 0.01, LOOP)
    kp, kd = np.full(2, KP / axis.unit_kp), np.full(2, KD / axis.unit_kd)
    gain, phase = margins(kp, kd, axis.steps(kp), axis.clock)
    for row in (0, 1):
        g, p, *_ = control.stability_margins(plant_system(axis, row, KP) * law_system(KP, KD, axis.clock))
        assert g == pytest.approx(gain[row], rel=2e-3) and np.radians(p) == pytest.approx(phase[row], rel=2e-3)
