"""The loop of a record simulated with its controller, and parameters from it, beside a rig that shares no code with either."""

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest
import rig
from scipy.linalg import expm

from workbench.control import fixed_pd, pi_cascade
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.motion import motion
from workbench.output_error.refine import refine
from workbench.output_error.rerun import rerun
from workbench.plant import Limits, Plant
from workbench.record import Record, Source
from workbench.simulation import Loop, open_loop

BAND = 100.0
SOURCE = Source(Path("none"), "", "none", {})
AXIS = rig.Axis(inertia=0.012, viscous=0.03, h0=0.2, rate=400.0)
TS = rig.PER_CONTROL / rig.RATE
RIG = Loop(TS, rig.PER_CONTROL, velocity_filter=1 / (2 * pi * 250.0), resolution=rig.COUNT)
GAIN = AXIS.inertia * 2 * pi * 22.0
CASCADE = pi_cascade(2 * pi * 6.0, GAIN, GAIN * 2 * pi * 4.0, 1e3)  # as the rig's own, written there a second time


def recorded(name: str, dt: float, role: str = "identification", **channels) -> Record:
    time = np.arange(channels["position"].size) * dt
    return Record(name, role, time, channels, {}, SOURCE, resolution={"position": rig.COUNT})


def on_the_rig(seconds: float = 4.0) -> Record:
    """Return a record at the control rate: slow waves under gross sliding, with a torque injected on top."""
    t = np.arange(round(seconds / TS)) * TS
    reference = 0.05 * np.sin(2 * pi * 0.5 * t) + 0.02 * np.sin(2 * pi * 3.0 * t)
    injected = 0.15 * np.sin(2 * pi * 11.0 * t) + 0.1 * np.sin(2 * pi * 23.0 * t)
    q, _, u = logs = np.empty((3, t.size * rig.PER_CONTROL))
    rig.simulate(AXIS, *rig.Machine(AXIS, {}).tables(), 0.0, reference, np.zeros(t.size), injected, True, False, *logs)
    q, u = q[:: rig.PER_CONTROL], u[:: rig.PER_CONTROL]
    read = rig.COUNT * np.floor(q / rig.COUNT + 0.5)
    return recorded("waves", TS, position=read, torque=u, reference=reference, injected=injected)


def model(inertia=AXIS.inertia, viscous=AXIS.viscous, h0=AXIS.h0, x0=1 / AXIS.rate) -> Plant:
    hysteresis = find("presliding_hysteresis")(h0=h0, x0=x0, d=1.0).free("x0")
    hysteresis = replace(
        hysteresis, parameters={**hysteresis.parameters, "d": replace(hysteresis.parameters["d"], fixed=True)}
    )
    effects = find("inertia")(inertia=inertia), find("viscous_friction")(viscous=viscous), hysteresis
    return Plant("one mass", effects, limits=Limits(drive=rig.LIMIT))


@pytest.fixture(scope="module")
def waves() -> Record:
    return on_the_rig()


def test_the_true_plant_in_the_loop_gives_the_record_again(waves):
    again = rerun(model(), motion(waves, BAND), RIG, CASCADE)
    assert again.errors["drive"] < 0.004
    assert again.errors["position"] < 1e-4
    assert again.raw["drive"] < 0.05  # a count of the encoder, which the velocity makes much of, falls otherwise
    assert again.simulated["drive"].shape == waves.time.shape


def test_a_wrong_inertia_is_seen_in_the_drive(waves):
    wrong = rerun(model(inertia=1.3 * AXIS.inertia), motion(waves, BAND), RIG, CASCADE)
    assert wrong.errors["drive"] > 0.05


def test_output_error_finds_the_parameters_of_the_rig(waves):
    inverses = inverse_dynamics([waves], BAND)
    start = model(1.3 * AXIS.inertia, 0.6 * AXIS.viscous, 0.8 * AXIS.h0, 1.5 / AXIS.rate)
    fit = refine(start, inverses, RIG, CASCADE)
    before, after = fit.details["output_error"]
    assert before > 0.1
    assert after < 0.003
    truth = {"inertia": AXIS.inertia, "viscous": AXIS.viscous, "h0": AXIS.h0}
    found = {e.parameter: e for e in fit.estimates}
    for name, value in truth.items():
        assert found[name].value == pytest.approx(value, rel=0.005), name
        assert 0.0 < found[name].high - found[name].low < 0.02 * value, name
    inverse = identify(start, inverses)
    assert inverse.plant["inertia"].parameters["inertia"].value == pytest.approx(found["inertia"].value, rel=0.03)


def test_a_plant_whose_values_are_all_known_is_only_compared(waves):
    known = model()
    known = replace(
        known, effects=tuple(e(fixed=True, **{n: p.value for n, p in e.parameters.items()}) for e in known.effects)
    )
    fit = refine(known, inverse_dynamics([waves], BAND), RIG, CASCADE)
    assert fit.plant == known
    before, after = fit.details["output_error"]
    assert before == after < 0.003


def sampled(inertia: float, viscous: float, kp: float, kd: float, reference: np.ndarray, ts: float):
    """Exact response of inertia and viscous friction under a held torque: the matrix exponential, one step a sample."""
    step = expm(ts * np.array([[0, 1, 0], [0, -viscous / inertia, 1 / inertia], [0, 0, 0]]))[:2]
    x, before = np.zeros(2), 0.0
    position, drive = [], []
    for r in reference:
        u = kp * (r - x[0]) - kd * (x[0] - before) / ts
        before = x[0]
        position.append(x[0])
        drive.append(u)
        x = step @ np.array([*x, u])
    return np.array(position), np.array(drive)


def test_a_linear_loop_is_that_of_the_matrix_exponential():
    ts, kp, kd = 1e-3, 60.0, 1.2
    t = np.arange(2000) * ts
    reference = 0.05 * np.sin(2 * pi * 2.0 * t) + 0.01 * np.sign(np.sin(2 * pi * 1.3 * t))
    q, u = sampled(0.01, 0.05, kp, kd, reference, ts)
    record = replace(recorded("linear", ts, position=q, torque=u, reference=reference), resolution={})
    plant = Plant("one mass", (find("inertia")(inertia=0.01), find("viscous_friction")(viscous=0.05)))
    errors = [rerun(plant, motion(record, BAND), Loop(ts, n), fixed_pd(kp, kd)).raw["drive"] for n in (10, 100)]
    assert errors[1] < 2e-3
    assert errors[1] < 0.15 * errors[0]  # the integration of the lanes is of first order


def test_two_masses_are_compared_by_both_encoders():
    effects = (
        find("inertia")(inertia=0.01, at="motor"), find("viscous_friction")(viscous=0.02, at="motor"),
        find("inertia")(inertia=0.02, at="load"), find("viscous_friction")(viscous=0.01, at="load"),
        find("linear_stiffness")(stiffness=300.0, at="joint"), find("linear_damping")(damping=0.05, at="joint"),
    )  # fmt: skip
    plant = Plant("two mass", effects)
    t = np.arange(1000) * 1e-3
    u = 0.3 * np.sin(2 * pi * 3.0 * t)
    run = open_loop(plant, u, 1e-3, 4)
    record = recorded("free", 1e-3, position=run["q"][:, 0], load_position=run["load.q"][:, 0], torque=u,
                      reference=np.zeros(t.size), injected=u)  # fmt: skip
    again = rerun(plant, motion(record, BAND), Loop(1e-3, 4), fixed_pd(0.0, 0.0))
    assert set(again.errors) == {"position", "load_position", "drive"}
    assert max(again.raw.values()) < 1e-9


def test_a_record_without_a_reference_is_refused(waves):
    channels = {n: c for n, c in waves.channels.items() if n != "reference"}
    with pytest.raises(WorkbenchError, match="no channel 'reference'"):
        rerun(model(), motion(replace(waves, channels=channels), BAND), RIG, CASCADE)


def test_a_loop_at_another_rate_is_refused(waves):
    with pytest.raises(WorkbenchError, match="a sample every 0.00025 s, but the loop runs every 0.001 s"):
        rerun(model(), motion(waves, BAND), Loop(1e-3, 5), CASCADE)


def test_a_controller_of_the_wrong_sign_is_a_sentence(waves):
    unstable = replace(model(), limits=Limits())
    for call in (
        lambda: rerun(unstable, motion(waves, BAND), RIG, fixed_pd(-1e6, -1e4)),
        lambda: refine(unstable, inverse_dynamics([waves], BAND), RIG, fixed_pd(-1e6, -1e4)),
    ):
        with pytest.raises(WorkbenchError, match="infinity"):
            call()
