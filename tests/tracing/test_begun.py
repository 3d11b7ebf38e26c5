"""A search looks at records as the declared model's friction starts in them, where nobody promised how it does."""

import numpy as np
import pytest

from workbench.definition import find
from workbench.inverse.balances import predicted
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.inverse.prehistory import displaced
from workbench.plant import ONE_MASS, Plant
from workbench.record import Record
from workbench.tracing.judge import STANDARD
from workbench.tracing.preparing import prepared
from workbench.tracing.tracing import trace

BAND, LENGTH, HEIGHT, WEIGHT = 20.0, 1e-4, 5.0, 8.0
PLANT = Plant(ONE_MASS) + find("presliding_hysteresis")(h0=HEIGHT, x0=LENGTH) + find("viscous_friction")(viscous=1.0)


def held(h: float, history: float | None) -> list[Record]:
    """A record that rests for a while, begun by a displacement h; history: what is stated of it."""
    t = np.arange(6000) * 1e-3
    q = 0.02 * np.maximum(t - 0.2, 0.0) ** 2 * np.cos(3.0 * t)
    still = {"position": q, "torque": np.zeros(t.size)}
    motion = inverse_dynamics([Record("held", "identification", t, still)], BAND)[0].motion
    drive = predicted(InverseDynamics(displaced(motion, h)), PLANT)
    drive += 0.02 * np.random.default_rng(1).normal(size=t.size)
    return [Record("held", "identification", t, {"position": q, "torque": drive}, history=history)]


@pytest.mark.parametrize(("h", "history", "loaded"), [(-1e-3, None, True), (0.0, None, False), (-1e-3, 0.0, False)])
def test_a_search_sees_the_start_that_whole_records_show_and_believes_what_was_promised(h, history, loaded):
    records = inverse_dynamics(held(h, history), BAND)
    found = prepared(PLANT, records, (), STANDARD)
    assert (found.begun is not None) == loaded
    (seen,) = found.decimated
    first = [p.motion.dq[0] for p in (seen, seen.fine)]  # operators run at a rate of their own
    assert all((x < -LENGTH) == loaded for x in first) and seen.motion.u.size < records[0].motion.u.size
    assert found.inverses == records  # each fit of whole records finds its own start


def hanging(name: str, role: str, h: float, w: float) -> Record:
    """A record of PLANT under a weight that its friction holds in part as it begins; nothing is promised of its start."""
    t = np.arange(5000) * 1e-3
    moving = np.maximum(t - 0.5, 0.0)
    still = {"position": 4e-3 * (1.0 - np.cos(w * moving)) * np.cos(0.3 * w * moving), "torque": np.zeros(t.size)}
    motion = inverse_dynamics([Record(name, role, t, still)], BAND)[0].motion
    hung = PLANT + find("constant_offset")(offset=WEIGHT)
    drive = predicted(InverseDynamics(displaced(motion, h)), hung)
    drive += 0.02 * np.random.default_rng(round(10 * w)).normal(size=t.size)
    return Record(name, role, t, still | {"torque": drive}, history=None)


@pytest.mark.parametrize("forgotten", ["presliding_hysteresis", "constant_offset"])
def test_what_an_axis_lacks_that_hangs_on_its_friction_is_named_though_no_start_fits_before_it_is_there(forgotten):
    records = [
        hanging("down", "identification", -3e-4, 3.0),
        hanging("up", "identification", 2e-4, 5.0),
        hanging("moves", "validation", -1e-4, 4.0),
    ]
    declared = (PLANT + find("constant_offset")).without(f"{forgotten}@axis")
    only = {
        "presliding_hysteresis",
        "fading_memory",
        "constant_offset",
        "sensor_trend",
        "cable_spring",
        "coulomb_friction",
    }
    found = trace(declared, inverse_dynamics(records, BAND), only=only)
    assert [c.effect for c in found.causes] == [forgotten]
    assert found.after.validation < 0.02
