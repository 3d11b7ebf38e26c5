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

BAND, LENGTH, HEIGHT = 20.0, 1e-4, 5.0
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
