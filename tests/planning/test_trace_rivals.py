"""The experiment that a trace names for rivals, run on the rig: along it they part."""

from dataclasses import replace

import numpy as np
import pytest
import rig
from scipy.interpolate import CubicSpline
from test_plan import carried_out

import workbench.planning
from workbench.campaign import load
from workbench.identification.problem import Problem
from workbench.identification.solve import solve
from workbench.inverse.dynamics import inverse_dynamics
from workbench.planning.following import followed, with_effect
from workbench.tracing.tracing import trace

DT = 1e-3  # s, of the rig's log
NOISE = 2e-3  # N*m, of the rig's torque
LATE = ("transport_delay", "clock_skew", "actuator_lag")


def test_rivals_of_a_trace_part_along_the_experiment_that_it_names(tmp_path, monkeypatch):
    """A late command and a drive that lags explain these records alike; along the named motion the rig tells them apart. A clock that keeps pace
    is the delay by another name, and no rival."""
    truth = rig.campaign(tmp_path, 103, ("transport_delay",), 1.0, short=True)
    campaign, asked = load(tmp_path), []
    separate = workbench.planning.separate

    def watched(plant, a, b, envelope, sensing):
        asked.append((plant, a, b, sensing, separate(plant, a, b, envelope, sensing)))
        return asked[-1][-1]

    monkeypatch.setattr(workbench.planning, "separate", watched)
    found = trace(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth), only=LATE, most=1)
    (cause,) = found.causes
    assert (cause.effect, cause.rivals) == ("transport_delay", ("actuator_lag",))
    ((plant, right, wrong, sensing, named),) = asked
    assert cause.experiment == named.sentence and named.apart

    delay = truth["parameters"]["transport_delay"]["delay"]
    machine = rig.Machine(rig.Axis(**truth["axis"], delay=delay, count=rig.COUNT), {})
    t = np.arange(int(named.reference.time[-1] / DT)) * DT  # the rig follows at its own rate
    planned = CubicSpline(named.reference.time, named.reference.position)(t)
    reference = replace(named.reference, position=planned, dt=DT)
    drive = followed(reference, with_effect(plant, right), sensing).motion.u
    inverses = carried_out(machine, reference, drive, noise=NOISE)
    costs = [solve(Problem(with_effect(plant, e), inverses)).cost for e in (right, wrong)]
    assert np.sqrt((costs[1] - costs[0]) / NOISE**2) > 0.5 * named.deviations > 3.0
    late = next(e for e in found.after.estimates if e.parameter == "delay")
    assert late.value == pytest.approx(delay, rel=0.2)
