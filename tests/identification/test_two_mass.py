"""Two masses and maps of readings: parameters recovered from torque that was made without the workbench.

Positions are chosen, smooth and in closed form; the laws that are written below say what drive they need. With two masses
both positions cannot be chosen at will, since the load hangs on the joint alone: its position is chosen, the joint's
deflection solved from the load's balance, and the motor's position follows from that.
"""

from pathlib import Path

import numpy as np
import pytest

from workbench.definition import find
from workbench.identification.fit import identify
from workbench.identification.problem import Problem
from workbench.inverse.balances import balances
from workbench.inverse.dynamics import inverse_dynamics
from workbench.motion import LowPass
from workbench.plant import ONE_MASS, TWO_MASS, Geometry, Plant
from workbench.record import Record, Source

RATE, BAND, RATIO = 2000.0, 150.0, 30.0
JM, JL, BM, BL, K, K3 = 2.1e-3, 2.6e-3, 0.012, 0.0034, 260.0, 1.2e6
SINE, COSINE = -9e-5, -5e-5  # of a kinematic error
SOURCE = Source(Path("r"), "", "", {})


def waves(seed: int, scale: float = 1.0, seconds: float = 6.0) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return (t, q, v, a): a sum of sines, at rest at zero in position at t = 0."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(seconds * RATE)) / RATE
    q, v, a = np.zeros((3, t.size))
    for amplitude, frequency in ((0.9, 0.35), (0.08, 1.9), (6e-3, 9.0), (5e-4, 33.0)):
        w = 2 * np.pi * frequency * rng.uniform(0.9, 1.1)
        q += scale * amplitude * (1 - np.cos(w * t))
        v += scale * amplitude * w * np.sin(w * t)
        a += scale * amplitude * w**2 * np.cos(w * t)
    return t, q, v, a


def recorded(t, u, name="one", role="identification", locked=False, **positions) -> Record:
    return Record(name, role, t, {"torque": np.array(u), **positions}, {}, SOURCE, locked=locked)


def differentiated(q: np.ndarray) -> list[np.ndarray]:
    """Return (v, a) of a smooth position, far above the band in which errors count."""
    return LowPass(4 * BAND, RATE, q.size).derivatives(q, 3)[1:]


def wave(q, order):
    """Error of the gear, none at zero, and its slope over the motor's position."""
    angle = order * q
    slope = order * (SINE * np.cos(angle) - COSINE * np.sin(angle))
    return SINE * np.sin(angle) + COSINE * (np.cos(angle) - 1.0), slope


def driven(seed: int, *, order: float = 0.0, name: str = "one", role: str = "identification") -> Record:
    """Both bodies free: the load moves as chosen, the joint carries what that takes, the motor is where that puts it."""
    t, load, v, a = waves(seed)
    torque = JL * a + BL * v  # through the joint
    stretch = torque / K
    for _ in range(30):
        stretch -= (K * stretch + K3 * stretch**3 - torque) / (K + 3 * K3 * stretch**2)
    motor, slope = load + stretch, 0.0
    if order:
        for _ in range(30):
            error, slope = wave(motor, order)
            motor -= (motor - load + error - stretch) / (1.0 + slope)
        slope = wave(motor, order)[1]
    v_motor, a_motor = differentiated(motor)
    u = JM * a_motor + BM * v_motor + torque * (1.0 + slope)
    return recorded(t, u, name, role, position=motor, load_position=load)


def locked(seed: int, order: float = 0.0) -> Record:
    """The load is held: the joint carries what the motor's small motion winds up."""
    t, q, v, a = waves(seed, 2e-3)
    error, slope = wave(q, order) if order else (0.0, 0.0)
    stretch = q + error
    u = JM * a + BM * v + (K * stretch + K3 * stretch**3) * (1.0 + slope)
    return recorded(t, u, "locked", locked=True, position=q, load_position=np.zeros(t.size))


def believed(*further) -> Plant:
    plant = Plant(TWO_MASS, geometry=Geometry(gear_ratio=RATIO))
    for name, at in (("inertia", "motor"), ("inertia", "load"), ("viscous_friction", "motor"), ("viscous_friction", "load"),
                     ("linear_stiffness", "joint"), ("cubic_stiffness", "joint")):  # fmt: skip
        plant = plant + find(name)(at=at)
    for e in further:
        plant = plant + e
    return plant


def wavy(order: float, at: str = "joint"):
    """A kinematic error whose order is searched from here, its amplitude from next to nothing."""
    return find("kinematic_error")(at=at, sine=1e-5, cosine=1e-5, order=order)


def estimates(fit) -> dict[str, float]:
    return {f"{e.parameter}@{e.at}": e.value for e in fit.estimates}


TRUTH = {"inertia@motor": JM, "inertia@load": JL, "viscous@motor": BM, "viscous@load": BL, "stiffness@joint": K,
         "k3@joint": K3}  # fmt: skip


def test_both_bodies_and_the_joint_are_recovered():
    inverses = inverse_dynamics([driven(1), locked(2), driven(3, name="two", role="validation")], BAND)
    fit = identify(believed(), inverses)
    found = estimates(fit)
    assert found == pytest.approx(TRUTH, rel=2e-3)
    assert fit.validation < 1e-4


def test_a_locked_load_has_no_balance():
    free, held = inverse_dynamics([driven(1), locked(2)], BAND)
    assert balances(free, believed()).shape == (2, free.motion.u.size)
    assert balances(held, believed()).shape == (1, held.motion.u.size)
    found = estimates(identify(believed(), [held]))
    assert {n: found[n] for n in TRUTH if not n.endswith("load")} == pytest.approx(
        {n: v for n, v in TRUTH.items() if not n.endswith("load")}, rel=2e-3
    )
    # whatever the load's parameters are, a record that holds it still says nothing of them
    moved = believed().with_values({"inertia@load": {"inertia": 1.0}, "viscous_friction@load": {"viscous": 1.0}})
    assert np.array_equal(balances(held, moved), balances(held, believed()))


def test_the_loads_balance_is_the_joints_torque():
    (free,) = inverse_dynamics([driven(1)], BAND)
    plant = believed().with_values(
        {"inertia@motor": {"inertia": JM}, "inertia@load": {"inertia": JL}, "viscous_friction@motor": {"viscous": BM},
         "viscous_friction@load": {"viscous": BL}, "linear_stiffness@joint": {"stiffness": K}, "cubic_stiffness@joint": {"k3": K3}}
    )  # fmt: skip
    motor, load = balances(free, plant)[:, free.motion.keep]
    u = free.motion.u[free.motion.keep]
    assert np.abs(motor - u).max() < 2e-3 * np.abs(u).max() and np.abs(load).max() < 2e-3 * np.abs(u).max()


@pytest.mark.parametrize("start", [2 * RATIO, 2 * RATIO + 0.05])
def test_a_kinematic_error_at_the_joint_is_recovered(start):
    """Its slope enters both balances, and a joint at rest where both encoders read zero is not wound up by it."""
    order = 2 * RATIO
    records = [driven(1, order=order), locked(2, order), driven(3, order=order, name="two", role="validation")]
    inverses = inverse_dynamics(records, BAND)
    fit = identify(believed(wavy(start)), inverses)
    found = estimates(fit)
    assert {n: found[n] for n in TRUTH} == pytest.approx(TRUTH, rel=5e-3)
    assert found["amplitude@joint"] == pytest.approx(np.hypot(SINE, COSINE), rel=5e-3)
    assert found["phase@joint"] == pytest.approx(np.arctan2(COSINE, SINE), abs=5e-3)
    assert found["order@joint"] == pytest.approx(order, abs=1e-3)
    assert fit.validation < 1e-3 < identify(believed(), inverses).validation


def test_a_constant_between_the_encoders_does_not_wind_up_the_joint():
    """At rest at zero the joint's forces are zero, whatever the phase of the error."""
    t = np.arange(2000) / RATE
    still = recorded(t, 0 * t, position=0 * t, load_position=0 * t)
    plant = believed(wavy(60.0)(cosine=1e-4)).with_values({"linear_stiffness@joint": {"stiffness": K}})
    assert not balances(*inverse_dynamics([still], BAND), plant).any()


@pytest.mark.parametrize(
    ("name", "shape", "wave_number"), [("kinematic_error", "order", 60.0), ("encoder_eccentricity", "turns", 3.0)]
)
def test_a_map_of_the_only_encoder_is_undone(name, shape, wave_number):
    size = 3e-4 if wave_number > 10 else 3e-3
    records = []
    for seed, role in ((1, "identification"), (2, "validation")):
        t, q, v, a = waves(seed)
        reading = q + size * (np.sin(wave_number * q + 0.7) - np.sin(0.7))  # zero where the encoder was set to zero
        records.append(recorded(t, (JM + JL) * a + BM * v + 0.4 * np.sin(2 * q), role, role, position=reading))
    plant = Plant(ONE_MASS) + find("inertia") + find("viscous_friction")
    plant = plant + find("cogging")(order=2.0) + find(name)(at="sensor.position", **{shape: wave_number, "sine": 1e-5})
    fit = identify(plant, inverse_dynamics(records, BAND))
    found = {(e.effect, e.parameter): e.value for e in fit.estimates}
    assert found["inertia", "inertia"] == pytest.approx(JM + JL, rel=5e-3)
    assert found["viscous_friction", "viscous"] == pytest.approx(BM, rel=5e-3)
    assert found[name, "amplitude"] == pytest.approx(size, rel=5e-3)
    assert found[name, "phase"] == pytest.approx(0.7, abs=5e-3)
    assert fit.validation < 2e-3


def test_a_fit_with_a_locked_record_is_the_same_again():
    """Where the load is locked, the columns of its parameters are zero and not whatever the memory held before."""
    inverses = inverse_dynamics([driven(1), locked(2)], BAND)
    problem = Problem(believed(), inverses)
    for _ in range(3):
        filled = np.full(problem.lengths[0] * 6, 7.0)  # memory that the next array may get
        del filled
        phi = problem.assemble(problem.start())[1]
        rows = slice(problem.lengths[0], sum(problem.lengths))
        load = [i for i, n in enumerate(problem.free_linear) if n.key.endswith("@load")]
        assert len(load) == 2 and not phi[rows][:, load].any()
