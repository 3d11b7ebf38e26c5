"""A record of which nobody knows how it was begun: friction with memory starts in a state that no channel holds."""

from dataclasses import replace

import numpy as np
import pytest

from workbench.definition import find
from workbench.identification.fit import identify, with_fitted
from workbench.inverse import prehistory
from workbench.inverse.balances import predicted
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import Record

GAP, LENGTH, STROKE = 2e-3, 1e-3, 0.02


def plant() -> Plant:
    return Plant(ONE_MASS) + find("friction_behind_gap")(h0=5.0, half_width=GAP, x0=LENGTH)


def begun_by(h: float, history: float | None, name: str = "sweep") -> Record:
    """Return a record of friction behind a gap that had moved by h before its first sample."""
    t = np.arange(4000) * 1e-3
    still = {"position": STROKE * (1.0 - np.cos(np.pi * t)) / 2.0, "torque": np.zeros(t.size)}
    motion = inverse_dynamics([Record(name, "identification", t, still)], 20.0)[0].motion
    torque = predicted(InverseDynamics(prehistory.displaced(motion, h)), plant())
    return Record(name, "identification", t, still | {"torque": torque}, history=history)


@pytest.mark.parametrize("h", [-2.5e-3, -1e-3, 2.5e-3])
def test_the_displacement_before_a_record_is_found_where_nobody_stated_it(h):
    fit = identify(plant(), inverse_dynamics([begun_by(h, None)], 20.0))
    stated = identify(plant(), inverse_dynamics([begun_by(h, 0.0)], 20.0))
    assert fit.identification < 0.02 and stated.identification > 3.0 * fit.identification
    (finding,) = (f for f in fit.findings if f.kind == "state at the start")
    assert finding.evidence["sweep"] == pytest.approx(h, abs=0.1 * (GAP + LENGTH))


def test_a_start_that_was_stated_is_believed():
    fit = identify(plant(), inverse_dynamics([begun_by(-2.5e-3, 0.0)], 20.0))
    assert not [f for f in fit.findings if f.kind == "state at the start"]


def test_memory_that_the_first_move_erases_is_not_searched():
    short = Plant(ONE_MASS) + find("presliding_hysteresis")(h0=5.0, x0=1e-3 * STROKE)
    inverses = inverse_dynamics([begun_by(0.0, None)], 20.0)
    assert prehistory.begun(short, inverses) is None


@pytest.mark.parametrize(("h", "found"), [(-1.5e-3, -1.0), (0.0, 0.0)])
def test_short_memory_is_searched_where_a_record_rests_before_its_first_move(h, found):
    """Friction holds a weight as the record begins: a twentieth of the record at rest, whose force is all that is left."""
    x0 = 1e-4
    short = Plant(ONE_MASS) + find("presliding_hysteresis")(h0=5.0, x0=x0) + find("viscous_friction")(viscous=1.0)
    t = np.arange(4000) * 1e-3
    still = {"position": STROKE * np.maximum(t - 0.2, 0.0) ** 2 * np.cos(3.0 * t), "torque": np.zeros(t.size)}
    motion = inverse_dynamics([Record("held", "identification", t, still)], 20.0)[0].motion
    torque = predicted(InverseDynamics(prehistory.displaced(motion, h)), short)
    record = Record("held", "identification", t, still | {"torque": torque}, history=None)
    begun = prehistory.begun(short, inverse_dynamics([record], 20.0))
    assert (begun is None) == (found == 0.0)
    assert begun is None or begun[0].motion.record.found < found * x0
    assert prehistory.begun(short, inverse_dynamics([replace(record, history=0.0)], 20.0)) is None
    given = short.swap(short["presliding_hysteresis@axis"](fixed=True))  # a bank of given lengths remembers as well
    assert (prehistory.begun(given, inverse_dynamics([record], 20.0)) is None) == (found == 0.0)


def test_each_record_has_a_start_of_its_own():
    records = [begun_by(-2.5e-3, None, "a"), replace(begun_by(2.5e-3, None, "b"), role="validation")]
    fit = identify(plant(), inverse_dynamics(records, 20.0))
    assert fit.identification < 0.02 and fit.validation < 0.05


def test_a_stated_displacement_is_the_motions_first_increment_as_a_found_one_is():
    relaxed, stated = (inverse_dynamics([begun_by(0.0, h)], 20.0)[0].motion for h in (0.0, 1e-3))
    found = prehistory.displaced(relaxed, 1e-3)
    assert stated.dq[0] == found.dq[0] == relaxed.dq[0] + 1e-3
    assert prehistory.displaced(found, None).dq[0] == relaxed.dq[0]


def test_fitted_records_are_replaced_by_their_role_and_not_by_their_name():
    both = [begun_by(0.0, None, "a"), replace(begun_by(0.0, None, "a"), role="validation")]
    inverses = inverse_dynamics(both, 20.0)
    other = prehistory.begun_at(inverses[:1], [1e-3])
    assert with_fitted(inverses, other) == [other[0], inverses[1]]
