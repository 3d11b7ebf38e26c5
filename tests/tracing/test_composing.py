"""One composite in the place of its parts; presliding beside Coulomb friction."""

import numpy as np
import pytest
from test_near_law import PLANT, inverses, stops

from workbench.definition import find
from workbench.inverse.balances import predicted
from workbench.tracing.criteria import Criteria
from workbench.tracing.tracing import trace

LUGRE = {"sigma0": 0.3 / 4e-4, "sigma1": 0.3, "x0": 4e-4, "ratio": 0.6, "speed": 0.15}


def test_presliding_and_a_peak_that_are_lugre_friction_bear_its_name():
    (bare,) = inverses(lambda t, q, way: 0.0 * t)
    whole = predicted(bare, PLANT.without("coulomb_friction") + find("lugre_friction")(**LUGRE))
    smooth = predicted(bare, PLANT.without("coulomb_friction"))
    noise = 0.002 * np.random.default_rng(3).standard_normal(whole.size)
    seen = inverses(lambda t, q, way: whole - smooth + noise)
    found = trace(PLANT, seen)
    assert [c.effect for c in found.causes] == ["lugre_friction"]
    assert found.after.plant["lugre_friction"].parameters["x0"].value == pytest.approx(4e-4, rel=0.1)


def test_a_length_beside_ideal_coulomb_friction_is_presliding_and_no_near_law():
    seen = inverses(lambda t, q, way: 0.5 * way + stops(q, 3e-4, 0.1))
    found = trace(PLANT, seen)
    assert [c.effect for c in found.causes] == ["presliding_hysteresis"]
    assert found.after.plant["coulomb_friction"].parameters["coulomb"].value == pytest.approx(0.5, rel=0.05)
    assert Criteria().near == 0.8
