"""A joint that has nearly no stiffness at rest has a gap, whichever law of hardening bends to it."""

from types import SimpleNamespace

import numpy as np
import pytest

from workbench.definition import find
from workbench.identification.cross_validation import HeldOut
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import TWO_MASS, Plant
from workbench.record import IDENTIFICATION, Record
from workbench.tracing import slack

DT = 1e-3


def deflected(reach: float):
    """Return the inverse dynamics of a record whose joint is deflected as far as `reach`, to either side."""
    t = DT * np.arange(4000)
    load = 0.1 * np.sin(3.0 * t)
    channels = {"torque": np.sin(t), "position": load + reach * np.sin(7.0 * t), "load_position": load}
    steps = {"position": 1e-7, "load_position": 1e-7}
    return inverse_dynamics([Record("made", IDENTIFICATION, t, channels, {}, resolution=steps)], 60.0)


@pytest.mark.parametrize(("inner", "outer"), [(200.0, 250.0), (0.0, 450.0), (450.0, 0.0)])
def test_the_stiffness_at_rest_is_that_of_all_laws_of_the_joint_together(inner, outer):
    plant = Plant(TWO_MASS) + find("linear_stiffness")(at="joint", stiffness=100.0)
    plant += find("piecewise_stiffness")(at="joint", k1=inner, k2=outer, threshold=1e-3)
    assert slack.stiffness_at_rest(plant, deflected(4e-3)) == pytest.approx(
        (100.0 + inner) / (100.0 + inner + outer), rel=0.02
    )


def judged(name: str, left: float, family: str = "joint stiffness"):
    candidate = SimpleNamespace(at="joint", effect=name, family=family)
    fitted = SimpleNamespace(plant=None)
    return SimpleNamespace(
        candidate=candidate, refitted=fitted, score=SimpleNamespace(earns=True), errors=HeldOut(np.array([left]))
    )


@pytest.mark.parametrize(
    ("ratio", "beside", "family", "stays"),
    [
        (0.1, "softer", "joint stiffness", True),
        (0.45, "softer", "joint stiffness", False),
        (0.1, "creep", "creep", False),
    ],
)
def test_a_gap_stays_beside_the_law_that_bends_its_flanks_where_the_joint_is_slack(
    monkeypatch, ratio, beside, family, stays
):
    monkeypatch.setattr(slack, "stiffness_at_rest", lambda plant, inverses: ratio)
    last = SimpleNamespace(plant=None, inverses=())
    assert slack.bent_gap(judged("backlash", 0.07), [judged(beside, 0.04, family)], last) is stays
    assert not slack.bent_gap(judged(beside, 0.04, family), [judged("backlash", 0.07)], last)
