"""Where friction turns between the samples of a slow log, its operators run along the path between them."""

import numpy as np
import pytest

from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.inverse.oftener import moved_oftener, read_oftener
from workbench.inverse.prehistory import displaced
from workbench.motion import LowPass, motion
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record
from workbench.tracing.criteria import Criteria
from workbench.tracing.slow_log import slow_log
from workbench.tracing.tracing import trace

RATE, BAND, COUNT = 100.0, 11.0, 1e-7
INSIDE, CUT = 20, 35.0  # steps of the axis in a sample; Hz, of the drive's own filter
INERTIA, VISCOUS, COULOMB = 2.0, 40.0, 30.0


def recorded(name: str, role: str, period: float, seconds: float = 24.0) -> Record:
    """Return a swing whose Coulomb friction steps within a sample; the drive passed a low pass before it was logged."""
    inside = np.arange(int(seconds * RATE) * INSIDE) / (RATE * INSIDE)
    w, u = 2 * np.pi / period, 2 * np.pi / (1.37 * period)
    q = 0.1 * np.sin(w * inside) + 0.03 * np.sin(u * inside + 0.4)
    v = 0.1 * w * np.cos(w * inside) + 0.03 * u * np.cos(u * inside + 0.4)
    a = -0.1 * w**2 * np.sin(w * inside) - 0.03 * u**2 * np.sin(u * inside + 0.4)
    force = INERTIA * a + VISCOUS * v + COULOMB * np.sign(v)
    t, q = inside[::INSIDE], q[::INSIDE]
    force = LowPass(CUT, RATE * INSIDE, inside.size)(force)[::INSIDE]
    force = force + 0.05 * np.random.default_rng(len(name)).standard_normal(t.size)
    return Record(
        name, role, t, {"force": force, "position": COUNT * np.round(q / COUNT)}, resolution={"position": COUNT}
    )


def declared() -> Plant:
    plant = Plant(ONE_MASS, rotary=False)
    for name in ("inertia", "viscous_friction", "coulomb_friction"):
        plant += find(name)
    return plant


def records() -> list[Record]:
    return [
        recorded("a", IDENTIFICATION, 0.83),
        recorded("bb", IDENTIFICATION, 1.31),
        recorded("ccc", VALIDATION, 1.07),
    ]


def test_friction_of_a_slow_log_that_has_a_memory_turns_between_samples_once_its_operator_runs_there():
    inverses = inverse_dynamics(records(), BAND)
    plant = declared().without("coulomb_friction") + find("presliding_hysteresis")(h0=20.0, x0=2e-5)
    found = slow_log(plant, inverses, Criteria().practical)
    assert found is not None and found.times == 8
    coarse, often = identify(plant, inverses), identify(plant, found.inverses)
    assert often.identification < 0.2 * coarse.identification and often.validation < 0.2 * coarse.validation
    told = trace(plant, inverses)
    assert [f.kind for f in told.findings].count("slow log") == 1


def test_a_complete_model_of_a_slow_log_with_coulomb_friction_lacks_nothing():
    inverses = inverse_dynamics(records(), BAND)
    assert slow_log(declared(), inverses, Criteria().practical) is None
    told = trace(declared(), inverses)
    assert told.verdict == "nothing_missing" and not told.added and told.after.validation < 0.006


def test_what_a_faster_log_would_not_show_changes_nothing():
    fast = [read_oftener(r, 4) for r in records()]
    assert slow_log(declared(), inverse_dynamics(fast, BAND), Criteria().practical) is None
    plain = Plant(ONE_MASS, rotary=False) + find("inertia") + find("viscous_friction")
    assert slow_log(plain, inverse_dynamics(records(), BAND), Criteria().practical) is None


def test_a_path_that_is_read_oftener_passes_through_its_samples_and_begins_where_it_did():
    m = motion(recorded("a", IDENTIFICATION, 0.83, 5.0), BAND)
    often = moved_oftener(m, 3)
    assert np.allclose(often.record.channels["position"][::3], m.record.channels["position"], atol=1e-15)
    assert np.allclose(often.t[::3], m.t) and often.dt == pytest.approx(m.dt / 3)
    begun = moved_oftener(displaced(m, 0.02), 3)
    assert begun.dq[0] == pytest.approx(often.dq[0] + 0.02)
    assert np.array_equal(begun.dq[1:], often.dq[1:])
