"""What few blocks of the identification records hold, and validation carries."""

from pathlib import Path

import numpy as np
import pytest

from workbench.definition import find
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record, Source
from workbench.tracing import tracing
from workbench.tracing.tracing import trace

SOURCE = Source(Path("made"), "", "made", {})
COUNT, DT, FALL = 1e-6, 1e-3, 0.04
PLANT = Plant(ONE_MASS) + find("inertia")(inertia=0.01) + find("viscous_friction") + find("coulomb_friction")


def recorded(name: str, role: str, hard: float, seconds: float = 14.0) -> Record:
    """A record of two sines that are three times as large in its last `hard` seconds, of a drive whose constant falls where it gives much."""
    t = DT * np.arange(round(seconds / DT))
    grows = 0.5 + 0.5 * np.tanh((t - (seconds - hard)) / 0.05)
    q = (1.0 + 2.0 * grows) * (0.05 * np.sin(6.0 * t) + 0.005 * np.sin(31.0 * t + len(name)))
    v = np.gradient(q, DT)
    a = np.gradient(v, DT)
    real = 0.05 * a + 0.02 * v + 0.1 * np.tanh(v / 1e-3)
    reported = real / np.sqrt(1.0 - FALL * real**2)
    reported = reported + 0.01 * np.random.default_rng(len(name)).normal(size=t.size)
    channels = {"torque": reported, "position": COUNT * np.round(q / COUNT), "reference": q}
    return Record(name, role, t, channels, {}, SOURCE, {"position": COUNT})


@pytest.mark.parametrize("asked", [True, False])
def test_what_shows_in_the_last_second_of_a_record_alone_is_a_cause_where_validation_carries_it(monkeypatch, asked):
    if not asked:
        monkeypatch.setattr(tracing, "by_validation", lambda choice: choice)
    made = (("a", IDENTIFICATION, 0.8), ("bb", IDENTIFICATION, -1.0), ("ccc", VALIDATION, 14.0))
    records = [recorded(*m) for m in made]
    found = trace(PLANT, inverse_dynamics(records, 40.0))
    assert found.added == (("torque_constant_saturation",) if asked else ())
    assert all("no test of the choice" in c.sentence for c in found.causes)
