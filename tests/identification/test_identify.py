"""Identification: exact recovery from torque made without the workbench, intervals that cover, and honesty about the rest.

The torque of a synthetic record is written down from the motion's closed form; its friction comes from the rig's stack
of turning points on the exact virgin curve, so that what is left is the error of the method, not of a shared formula.
"""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rig
from hypothesis import given, settings
from hypothesis import strategies as st
from threadpoolctl import threadpool_limits

from workbench.definition import find
from workbench.effects.curves import friction_over_speed
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.command import REACH
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.inverse.shift import shifted
from workbench.kernel.step import build
from workbench.motion import motion
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.record import Record, Source

RATE, BAND = 1000.0, 100.0
J, B, H0, A = 0.0026, 0.011, 0.15, 650.0
SOURCE = Source(Path("r"), "", "", {})


def moved(seed: int, seconds: float = 4.0, ahead: float = 0.0) -> tuple[np.ndarray, ...]:
    """Return (t, q, v, a): a slow sweep, a faster one and small ones, in closed form. ahead: s, t begins so much later."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(seconds * RATE)) / RATE + ahead
    q, v, a = np.zeros((3, t.size))
    for amplitude, frequency in ((1.0, 0.4), (0.2, 2.3), (0.02, 9.0), (0.002, 31.0)):
        w, phase = 2 * np.pi * frequency * rng.uniform(0.9, 1.1), rng.uniform(0, 2 * np.pi)
        q += amplitude * np.sin(w * t + phase)
        v += amplitude * w * np.cos(w * t + phase)
        a -= amplitude * w**2 * np.sin(w * t + phase)
    return t, q, v, a


def torque(q, v, a, **extra) -> np.ndarray:
    return extra.get("J", J) * a + extra.get("b", B) * v + extra.get("h0", H0) * rig.masing(q, extra.get("rate", A))


def recorded(t, q, u, name: str = "one", role: str = "identification", start: float = 0.0) -> Record:
    return Record(name, role, start + t, {"torque": np.array(u), "position": np.array(q)}, {}, SOURCE)


def believed(**values) -> Plant:
    """The plain axis with starts that are a quarter off."""
    plant = Plant(ONE_MASS) + find("inertia")(inertia=values.get("J", 0.002))
    plant = plant + find("viscous_friction")(viscous=0.014)
    return plant + find("presliding_hysteresis")(h0=0.11, x0=1.3 / A)


def smooth() -> Plant:
    """Without friction."""
    return Plant(ONE_MASS) + find("inertia") + find("viscous_friction") + find("constant_offset")


def estimate(fit, name: str):
    return next(e for e in fit.estimates if e.parameter == name)


@pytest.fixture(scope="module")
def clean() -> tuple[Record, ...]:
    """Two identification records and one for validation, without noise."""
    found = []
    for seed, role in ((1, "identification"), (2, "identification"), (3, "validation")):
        t, q, v, a = moved(seed)
        found.append(recorded(t, q, torque(q, v, a), f"r{seed}", role, 10.0 * seed))
    return tuple(found)


# --- what is there is found ---------------------------------------------------------------------------------------------


def test_a_plain_axis_is_recovered(clean):
    """Up to the 24 elements of the bank, about h0/(2 N^2) of the friction."""
    fit = identify(believed(), inverse_dynamics(clean, BAND))
    for name, true, within in (("inertia", J, 1e-3), ("viscous", B, 5e-3), ("h0", H0, 1e-3), ("a", A, 5e-3)):
        assert estimate(fit, name).value == pytest.approx(true, rel=within)
    assert fit.identification < 1e-3 and fit.validation < 1e-3
    assert estimate(fit, "a").unit == "1/rad" and estimate(fit, "inertia").unit == "kg*m^2"


def test_smooth_effects_are_recovered_to_many_digits():
    """Without friction nothing is discretised: what is left are the filters at the ends of the record."""
    t, q, v, a = moved(4)
    u = J * a + B * v + 0.02 + 0.3 * np.sin(q + 0.4) + 1e-4 * v * np.abs(v)
    plant = smooth() + find("gravity") + find("nonlinear_viscous_friction")
    fit = identify(plant, inverse_dynamics([recorded(t, q, u)], BAND))
    for name, true in (
        ("inertia", J),
        ("viscous", B),
        ("offset", 0.02),
        ("mgl", 0.3),
        ("phase", 0.4),
        ("quadratic", 1e-4),
    ):
        assert estimate(fit, name).value == pytest.approx(true, rel=1e-3)
    assert fit.identification < 1e-4


def test_shapes_are_found_from_afar(clean):
    t, q, v, a = moved(5, 8.0)
    friction = rig.masing(q, A)
    u = torque(q, v, a) + 0.05 * np.exp(-((v / 0.6) ** 2)) * friction + 0.02 * np.sin(60 * q + 0.7)
    plant = believed() + find("stribeck_friction")(speed=0.3) + find("cogging")(order=59.6)
    fit = identify(plant, inverse_dynamics([recorded(t, q, u)], BAND))
    for name, true, within in (
        ("drop", 0.05, 0.02),
        ("speed", 0.6, 0.02),
        ("amplitude", 0.02, 0.01),
        ("order", 60.0, 1e-4),
    ):
        assert estimate(fit, name).value == pytest.approx(true, rel=within)
    assert fit.identification < 2e-3


def test_no_more_is_asked_of_a_drive_than_it_gives(clean):
    """u' = u/sqrt(1 + u^2) stays below one: exact where it has an inverse, and little more than the drive's limit beyond."""
    plant = replace(believed() + find("torque_constant_saturation")(fall=1.0), limits=Limits(drive=3.0))
    inverses = inverse_dynamics(clean, BAND)[0]
    most = REACH * max(3.0, float(np.abs(inverses.motion.u).max()))
    asked = np.linspace(-5.0, 5.0, inverses.motion.u.size)
    found = inverses.command.undone(plant, asked)
    assert np.abs(found).max() == most
    within = np.abs(asked) < 0.5
    np.testing.assert_allclose(found[within], asked[within] / np.sqrt(1.0 - asked[within] ** 2), rtol=1e-3)


@pytest.mark.parametrize("delay", [0.0003, 0.0021])
def test_a_delay_is_found(clean, delay):
    t, q, _, _ = moved(6)
    _, _, v, a = moved(6, ahead=delay)  # the command acts `delay` after it was given
    u = J * a + B * v
    fit = identify(smooth() + find("transport_delay")(delay=1e-3), inverse_dynamics([recorded(t, q, u)], BAND))
    assert estimate(fit, "delay").value == pytest.approx(delay, abs=2e-6)
    assert estimate(fit, "inertia").value == pytest.approx(J, rel=2e-3)


@pytest.mark.parametrize("lag", [0.0002, 0.001, 0.004])
def test_a_lag_is_found_below_and_above_the_sample_time(lag):
    """The applied torque is known in closed form, so the command is u' + T du'/dt."""
    t, q, v, a = moved(7)
    rate = np.gradient(J * a + B * v, t, edge_order=2)
    fit = identify(
        smooth() + find("actuator_lag")(time_constant=5e-4),
        inverse_dynamics([recorded(t, q, J * a + B * v + lag * rate)], BAND),
    )
    assert estimate(fit, "time_constant").value == pytest.approx(lag, rel=0.01, abs=2e-6)


@pytest.mark.parametrize("lag", [0.0002, 0.001, 0.004])
@pytest.mark.parametrize("frequency", [5.0, 40.0, 90.0])
def test_a_lag_answers_a_sine_as_its_closed_form(frequency, lag):
    t = np.arange(2000) / RATE
    plant = Plant(ONE_MASS) + find("actuator_lag")(time_constant=lag)
    wave = np.exp(2j * np.pi * frequency * t)
    expected = (wave / (1 + 2j * np.pi * frequency * lag)).imag
    found = InverseDynamics(motion(recorded(t, np.zeros(t.size), wave.imag), BAND)).command.applied(plant)
    assert np.abs(found - expected)[100:-100].max() < 2e-3


def test_a_fixed_parameter_stays_and_the_rest_is_fitted(clean):
    plant = believed().swap(find("inertia")(inertia=0.002, fixed=True))
    fit = identify(plant, inverse_dynamics(clean, BAND))
    held = estimate(fit, "inertia")
    assert held.value == held.low == held.high == 0.002 and held.fixed
    assert fit.plant["inertia"].parameters["inertia"].fixed
    assert not estimate(fit, "viscous").fixed
    assert fit.identification > 0.02  # the wrong value is left in the residual, for the trace to find


# --- intervals ----------------------------------------------------------------------------------------------------------


def coloured(rng, n: int, size: float, memory: float = 0.02) -> np.ndarray:
    """Noise with an exponential memory of 20 ms, its rms `size`."""
    keep = np.exp(-1 / (memory * RATE))
    noise = rng.normal(size=n + 200) * size * np.sqrt(1 - keep**2)
    for k in range(1, noise.size):
        noise[k] += keep * noise[k - 1]
    return noise[200:]


def test_intervals_cover_under_coloured_noise():
    """40 sets, three parameters: 95 % is meant; an interval that took the noise for white would cover about half."""
    rng = np.random.default_rng(8)
    made = [moved(seed, 6.0) for seed in (20, 21)]
    motions = [motion(recorded(t, q, 0 * q, f"r{k}"), BAND) for k, (t, q, *_) in enumerate(made)]
    true = {"inertia": J, "viscous": B, "offset": 0.02}
    hits = []
    for _ in range(40):
        inverses = []
        for m, (t, q, v, a) in zip(motions, made, strict=True):
            u = J * a + B * v + 0.02 + coloured(rng, t.size, 0.02)
            inverses.append(
                InverseDynamics(type(m)(recorded(t, q, u, m.record.name), u, m.q, m.dq, m.v, m.a, m.filter, m.counts))
            )
        fit = identify(smooth(), inverses)
        hits += [estimate(fit, n).low <= value <= estimate(fit, n).high for n, value in true.items()]
    assert 0.8 <= np.mean(hits) <= 1.0


# --- what the data do not determine -------------------------------------------------------------------------------------


def said(fit) -> dict[str, str]:
    return {f.subject: f.kind for f in fit.findings}


def test_without_acceleration_inertia_is_not_determined():
    rng = np.random.default_rng(9)
    t = np.arange(4000) / RATE
    records = [recorded(t, s * t, B * s + 0.02 + 0.002 * rng.normal(size=t.size), f"r{s}") for s in (1.0, -2.0, 3.0)]
    fit = identify(smooth(), inverse_dynamics(records, BAND))
    assert said(fit)["inertia@axis.inertia"] in ("not determined", "at bound")
    assert estimate(fit, "viscous").value == pytest.approx(B, rel=0.05)
    assert "viscous_friction@axis.viscous" not in said(fit)


def test_a_collinear_pair_is_known_only_together():
    t, q, v, a = moved(10)
    u = J * a + B * v + 0.5 * q - 0.1 + 0.002 * np.random.default_rng(1).normal(size=t.size)
    fit = identify(smooth() + find("cable_spring"), inverse_dynamics([recorded(t, q, u)], BAND))
    (finding,) = [f for f in fit.findings if f.kind == "known only together"]
    assert finding.subject == "cable_spring@axis.preload, constant_offset@axis.offset"
    assert "hardly tell them apart" in finding.sentence and finding.remedy
    total = (
        fit.plant["cable_spring"].parameters["preload"].value + fit.plant["constant_offset"].parameters["offset"].value
    )
    assert total == pytest.approx(-0.1, abs=2e-3)


def test_a_value_on_its_bound_is_said_to_be():
    t, q, v, a = moved(11)
    fit = identify(smooth(), inverse_dynamics([recorded(t, q, J * a - 0.01 * v)], BAND))
    assert said(fit)["viscous_friction@axis.viscous"] == "at bound"
    bound = estimate(fit, "viscous")
    assert bound.value == bound.low == bound.high == 0.0


def test_findings_are_sentences(clean):
    t, q, v, a = moved(11)
    fit = identify(smooth() + find("cable_spring"), inverse_dynamics([recorded(t, q, J * a - 0.01 * v)], BAND))
    assert fit.findings
    for finding in fit.findings:
        assert finding.sentence.endswith(".") and finding.subject and finding.remedy


# --- the same numbers, whatever the order and the machine ---------------------------------------------------------------


def numbers(fit) -> list[float]:
    return [
        *(x for e in sorted(fit.estimates, key=lambda e: (e.effect, e.parameter)) for x in (e.value, e.low, e.high)),
        fit.identification, fit.validation, fit.condition, *(fit.nrmse[n] for n in sorted(fit.nrmse)),
    ]  # fmt: skip


def test_the_order_of_records_does_not_matter(clean):
    inverses = inverse_dynamics(clean, BAND)
    assert numbers(identify(believed(), inverses)) == numbers(identify(believed(), inverses[::-1]))


def test_the_order_of_effects_does_not_matter(clean):
    plant = believed() + find("constant_offset") + find("stribeck_friction")
    backwards = Plant(ONE_MASS, plant.effects[::-1])
    assert numbers(identify(plant, inverse_dynamics(clean, BAND))) == numbers(
        identify(backwards, inverse_dynamics(clean, BAND))
    )


def test_the_number_of_threads_does_not_matter(clean):
    found = []
    for threads in (1, 2, 4):
        with threadpool_limits(limits=threads, user_api="blas"):
            found.append(numbers(identify(believed(), inverse_dynamics(clean, BAND))))
    assert found[0] == found[1] == found[2]


def test_a_fresh_process_finds_the_same_numbers(clean):
    code = (
        "import test_identify as t; from workbench.identification.fit import identify; from workbench.inverse.dynamics import inverse_dynamics\n"
        "r = [t.recorded(*m[:2], t.torque(*m[1:]), f'r{s}', role, 10.0 * s)\n"
        "     for s, role in ((1, 'identification'), (2, 'identification'), (3, 'validation')) for m in [t.moved(s)]]\n"
        "print(t.numbers(identify(t.believed(), inverse_dynamics(r, t.BAND))))"
    )
    here = Path(__file__).resolve().parent
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path[:0] = {[str(here), str(here.parent)]!r}\n{code}"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stdout.strip() == str(numbers(identify(believed(), inverse_dynamics(clean, BAND))))


def test_validation_never_influences_the_fit(clean):
    *fitted, validation = clean
    other = recorded(validation.time - validation.time[0], validation.channels["position"],
                     validation.drive * 3 + 1.0, "r3", "validation", 30.0)  # fmt: skip
    one, two = (identify(believed(), inverse_dynamics([*fitted, v], BAND)) for v in (validation, other))
    assert [(e.value, e.low, e.high) for e in one.estimates] == [(e.value, e.low, e.high) for e in two.estimates]
    assert one.identification == two.identification and one.validation != two.validation


# --- maps of the command ------------------------------------------------------------------------------------------------


@settings(max_examples=10, deadline=None)
@given(st.floats(0.0, 0.005), st.floats(5e-5, 0.005), st.floats(0.5, 30.0))
def test_delay_and_lag_and_their_inverse_undo_each_other(delay, lag, frequency):
    t = np.arange(1500) / RATE
    u = np.sin(2 * np.pi * frequency * t) * np.exp(-(((t - 0.7) / 0.15) ** 2)) + 0.3  # at rest at both ends
    plant = Plant(ONE_MASS) + find("transport_delay")(delay=delay) + find("actuator_lag")(time_constant=lag)
    inverse = InverseDynamics(motion(recorded(t, np.zeros(t.size), u), BAND))
    again = inverse.command.undone(plant, inverse.command.applied(plant))
    assert np.abs(again - u).max() < 1e-6


@given(st.floats(-0.02, 0.02))
@settings(max_examples=30, deadline=None)
def test_shifting_moves_a_smooth_signal_by_any_part_of_a_sample(delay):
    t = np.arange(600) / RATE
    found = shifted(np.sin(40 * t), delay, 1 / RATE)[50:-50]
    np.testing.assert_allclose(found, np.sin(40 * (t - delay))[50:-50], atol=1e-9)
    varying = np.full(t.size, delay)
    varying[0] += 1e-9
    np.testing.assert_allclose(shifted(np.sin(40 * t), varying, 1 / RATE)[50:-50], found, atol=1e-12)


def test_shifting_by_whole_samples_is_exact_and_holds_the_ends():
    x = np.random.default_rng(0).normal(size=50)
    np.testing.assert_array_equal(shifted(x, 3e-3, 1e-3)[3:], x[:-3])
    np.testing.assert_allclose(shifted(x, 3e-3, 1e-3)[:3], x[0])
    np.testing.assert_allclose(shifted(x, 1.0, 1e-3), x[0])


# --- refusals -----------------------------------------------------------------------------------------------------------


def test_a_signal_that_a_record_does_not_have_is_refused(clean):
    plant = believed() + replace(find("constant_offset"), reads=("temperature",))
    with pytest.raises(
        WorkbenchError, match="effect 'constant_offset' reads 'temperature', which record 'r1' does not"
    ):
        identify(plant, inverse_dynamics(clean, BAND))


def test_no_array_of_a_record_is_changed(clean):
    before = [r.drive.copy() for r in clean]
    identify(believed(), inverse_dynamics(clean, BAND))
    assert all(np.array_equal(b, r.drive) for b, r in zip(before, clean, strict=True))


def test_asking_for_the_direction_leaves_coulomb_friction_what_it_is():
    """Columns and steps are kept under the step of an effect: what only asks for the direction has a step of its own."""
    t, q, *_ = moved(3)
    plant = Plant(ONE_MASS) + find("inertia")(inertia=0.01) + find("coulomb_friction")(coulomb=0.1)
    (inverses,) = inverse_dynamics([recorded(t, q, np.zeros_like(q))], 50.0)
    told = inverses.direction(plant, "axis")
    assert np.abs(told).max() == pytest.approx(1.0)
    assert build(find("coulomb_friction")).reads == ("dir",)
    columns = {e.key: column[0] for e, _, column in inverses.columns(plant)}
    np.testing.assert_array_equal(columns["coulomb_friction@axis"], told)


def test_what_a_curve_is_at_its_knots_is_no_finding_each():
    """A table of twelve levels is one law, which its band judges: of most levels a record says little beside their neighbours."""
    t, q, v, a = moved(12)
    drive = J * a + B * v + 0.02 + 0.05 * np.random.default_rng(3).normal(size=t.size)
    curve = friction_over_speed(np.geomspace(1e-3 * np.abs(v).max(), np.abs(v).max(), 12))
    fit = identify(smooth() + curve, inverse_dynamics([recorded(t, q, drive)], BAND))
    assert len([e for e in fit.estimates if e.effect == curve.name and not e.fixed]) >= 12
    assert not [s for s in said(fit) if all(one.startswith(curve.key) for one in s.split(", "))]
