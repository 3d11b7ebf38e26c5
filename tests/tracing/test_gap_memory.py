"""Friction behind a gap, where Coulomb friction is declared: the gap is missing, and memory too where the friction gives way over a length of its own."""

from pathlib import Path

import numpy as np

from workbench.definition import find
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record, Source
from workbench.tracing.tracing import trace

SOURCE = Source(Path("made"), "", "made", {})
COUNT, GAP, LENGTH = 1e-5, 0.02, 3e-3
PLANT = Plant(ONE_MASS) + find("inertia")(inertia=0.01) + find("viscous_friction") + find("coulomb_friction")


def rubbing(q: np.ndarray) -> np.ndarray:
    """Force of a slider of 0.5 N*m behind a spring that slips at LENGTH, behind a gap, in series."""
    w, found = 0.0, np.empty(q.size)
    for i, dq in enumerate(np.diff(q, prepend=q[0])):
        w = min(max(w + dq, -GAP - LENGTH), GAP + LENGTH)
        found[i] = 0.5 * (w - min(max(w, -GAP), GAP)) / LENGTH
    return found


def recorded(name: str, role: str, slow: float) -> Record:
    t = np.arange(8000) / 1000.0
    w, slow, rng = 2 * np.pi * 1.7, 2 * np.pi * slow, np.random.default_rng(len(name))
    q = 0.3 * np.sin(slow * t) + 0.05 * np.sin(w * t)
    v = 0.3 * slow * np.cos(slow * t) + 0.05 * w * np.cos(w * t)
    a = -0.3 * slow**2 * np.sin(slow * t) - 0.05 * w**2 * np.sin(w * t)
    drive = 0.01 * a + 0.05 * v + rubbing(q) + 0.005 * rng.normal(size=t.size)
    channels = {"torque": drive, "position": COUNT * np.round(q / COUNT), "reference": q}
    return Record(name, role, t, channels, {}, SOURCE, {"position": COUNT})


def test_memory_is_named_beside_a_gap_where_its_length_is_above_two_counts():
    records = [recorded("a", IDENTIFICATION, 0.35), recorded("bb", VALIDATION, 0.25)]
    offered = ("friction_behind_gap", "stribeck_friction", "presliding_hysteresis")
    found = trace(PLANT, inverse_dynamics(records, 60.0), only=offered)
    assert (found.verdict, found.added) == ("cause", ("backlash", "presliding_hysteresis"))
    assert "presliding hysteresis is missing with it" in found.causes[0].sentence
    assert found.sentence.startswith("Backlash and presliding hysteresis are missing.")
