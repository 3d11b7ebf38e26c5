"""What additions come to beside each other, and what of a noise floor stands."""

from types import SimpleNamespace

import numpy as np
import pytest
from test_otherwise import PLANT, recorded

from workbench.definition import find
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, TWO_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing import weighing
from workbench.tracing.answer import Answer
from workbench.tracing.candidates import ADDITION, CORRECTION, WHOLE, Candidate
from workbench.tracing.criteria import Criteria
from workbench.tracing.judge import ScoredCandidate
from workbench.tracing.selection import Selection
from workbench.tracing.state import State
from workbench.tracing.weighing import as_they_end, refuted_by


def test_a_data_sheets_value_is_weighed_beside_what_came_after_it():
    """Of a mass that is off by 3 % and a drag that nobody declared it takes what 3 % of the mass take, however much it took before the drag."""
    drag = lambda v: 0.5 * v * np.abs(v)  # noqa: E731
    inverses = inverse_dynamics([recorded(n, IDENTIFICATION, s, drag, 5.0) for n, s in (("a", 1.0), ("bb", 0.7))], 50.0)
    declared = PLANT.swap(find("inertia")(inertia=0.0103, fixed=True))
    (wrong,) = (c for c in WHOLE.candidates(declared) if (c.effect, c.kind) == ("inertia", CORRECTION))
    last = State(wrong.plant + find("nonlinear_viscous_friction"), inverses)
    j = ScoredCandidate(wrong, None, None, 1)
    selected = Selection(None, State(declared, inverses), Answer([j], None, last), (), (), ())
    taken = weighing._beside_others(j, selected)
    off = sum(np.sum((0.0003 * p.motion.filter(p.motion.a)[p.motion.keep]) ** 2) for p in inverses)
    assert taken == pytest.approx((off / last.power) ** 0.5, rel=0.2)


def ended(*effects, masses=ONE_MASS):
    """Names of additions by the values that they end with on records of 10 s."""
    found = Plant(masses)
    for e in effects:
        found = found + e
    band = SimpleNamespace(bandwidth=50.0)
    motion = SimpleNamespace(counts=1e-6, t=[0.0, 10.0], record=SimpleNamespace(dt=1e-3), filter=band)
    state = SimpleNamespace(plant=found, inverses=[SimpleNamespace(motion=motion)])
    added = [ScoredCandidate(Candidate(e.name, e.at, ADDITION, found, part=e.nearest), None, None, 1) for e in effects]
    return [j.candidate.name for j in as_they_end(added, found, state, Criteria())]


def test_a_delay_of_no_time_beside_a_lag_is_no_addition():
    lag = find("actuator_lag")(time_constant=1.2e-3)
    none, next_to_none, some = (find("transport_delay")(delay=x) for x in (0.0, 4e-7, 3e-4))
    assert ended(none, lag) == ended(next_to_none, lag) == ["actuator_lag"]
    assert ended(some, lag) == ["transport_delay", "actuator_lag"]


def test_a_gap_that_another_law_leaves_no_width_is_an_addition_still():
    assert ended(find("backlash")(at="joint", half_width=1e-7), masses=TWO_MASS) == ["backlash"]


@pytest.mark.parametrize(
    ("right", "left", "named"),
    [(600.0, 0.3, "piecewise_stiffness"), (0.0, 20.0, "piecewise_stiffness"), (600.0, 200.0, "cable_spring")],
)
def test_a_cable_that_is_slack_to_one_side_is_a_bumper(right, left, named):
    assert ended(find("slack_cable")(at="axis", right=right, left=left, place=0.045)) == [named]


def test_a_floor_is_no_higher_than_what_the_final_fit_leaves_of_a_record_that_it_was_not_fitted_to():
    """A free curve beside two additions: a centrifuge's error stood at 0.86 of a floor that these alone had told."""
    keep = slice(0, 10_000)
    motion = SimpleNamespace(record=SimpleNamespace(role=IDENTIFICATION), filter=SimpleNamespace(bandwidth=50.0), dt=1e-3, keep=keep)  # fmt: skip
    fit = SimpleNamespace(identification=0.0081, validation=0.0044, plant=Plant(ONE_MASS) + find("inertia"))
    told = {IDENTIFICATION: 0.0094, VALIDATION: 0.0045}
    lower = refuted_by(told, fit, [SimpleNamespace(motion=motion)])
    assert lower[VALIDATION] <= 0.0044 and lower[IDENTIFICATION] <= 0.0081 / 0.9
    fit.identification, fit.validation = 0.02, 0.01
    assert refuted_by(told, fit, [SimpleNamespace(motion=motion)]) == told
