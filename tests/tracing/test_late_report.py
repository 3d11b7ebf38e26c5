"""A drive that is reported late is a transport delay of its channel, one that acts late is one of its command."""

import numpy as np
import pytest

from workbench.definition import find
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record
from workbench.tracing.tracing import trace

DT, BAND, COUNT = 1e-3, 60.0, 1e-7
INERTIA, VISCOUS = 2.0, 15.0
LATE = 1.5e-3  # s
FREQUENCIES = np.array([0.7, 1.9, 4.3, 9.1, 17.0, 31.0])  # Hz


def reported(name: str, role: str, late: float, seed: int) -> Record:
    """Return an axis moved by sines whose drive is reported `late` s after the motion that it makes; a count and noise."""
    rng = np.random.default_rng(seed)
    t, w = DT * np.arange(6000), 2.0 * np.pi * FREQUENCIES
    size, phase = 0.3 / w**1.5, rng.uniform(-np.pi, np.pi, w.size)
    q = (size * np.sin(np.outer(t, w) + phase)).sum(axis=1)
    before = np.outer(t - late, w) + phase
    drive = (size * (VISCOUS * w * np.cos(before) - INERTIA * w**2 * np.sin(before))).sum(axis=1)
    drive += 0.003 * np.std(drive) * rng.standard_normal(t.size)
    return Record(
        name, role, t, {"force": drive, "position": COUNT * np.round(q / COUNT)}, resolution={"position": COUNT}
    )


@pytest.mark.parametrize(("late", "place"), [(LATE, "sensor.force"), (-LATE, "command")])
def test_a_report_and_a_drive_that_are_late_are_delays_of_their_own_place(late, place):
    plant = Plant(ONE_MASS, rotary=False) + find("inertia") + find("viscous_friction")
    records = [reported("a", IDENTIFICATION, late, 1), reported("b", VALIDATION, late, 2)]
    offered = ("clock_skew", "transport_delay", "actuator_lag", "flexible_mode")
    found = trace(plant, inverse_dynamics(records, BAND), only=offered)
    assert found.verdict == "cause" and found.added == ("transport_delay",) and found.causes[0].at == place
    assert {p.parameter: p.value for p in found.causes[0].parameters}["delay"] == pytest.approx(abs(late), rel=0.02)
    assert (
        "clock_skew" not in found.causes[0].rivals
    )  # that keeps pace: the same by another name, which no motion tells apart
