"""Which gains are possible: from which amplitude on a design is made."""

import numpy as np
import pytest

from workbench.design import possible
from workbench.tuning import OutOfReach

FEASIBLE = 1e-3  # the lowest amplitude that allows any gains
AMPLITUDES = np.geomspace(1e-5, 1.0, 20)


def test_gains_are_tuned_from_the_lowest_amplitude_on_that_allows_any(monkeypatch):
    def design(plant, amplitudes, goal, task, **_):
        if amplitudes[0] < FEASIBLE:
            raise OutOfReach("no gains keep the goal", float(amplitudes[amplitudes >= FEASIBLE][0]))
        return amplitudes

    monkeypatch.setattr(possible, "design", design)
    amplitudes = possible.design_from_lowest(None, AMPLITUDES, None, None)
    assert FEASIBLE <= amplitudes[0] < 2 * FEASIBLE and amplitudes[-1] == 1.0 and amplitudes.size == 20


def test_a_schedule_over_less_than_a_decade_is_none(monkeypatch):
    def design(plant, amplitudes, *_, **__):
        raise OutOfReach("no gains keep the goal", float(amplitudes[-1]))

    monkeypatch.setattr(possible, "design", design)
    with pytest.raises(OutOfReach):
        possible.design_from_lowest(None, AMPLITUDES, None, None)
