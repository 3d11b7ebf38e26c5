"""Plans: motions within limits, that determine parameters and part rivals; carried out on a rig of another make."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rig

from workbench.cli import main
from workbench.definition import Effect, find
from workbench.identification.fit import identify
from workbench.identification.problem import Problem
from workbench.identification.solve import solve
from workbench.inverse.balances import balances
from workbench.inverse.dynamics import inverse_dynamics
from workbench.planning import Envelope, Sensing, design, prospects, sensing_of, separate
from workbench.planning.envelope import load_rest
from workbench.planning.following import followed
from workbench.planning.motions import moves, multisine, quantity, ramps, sine
from workbench.planning.pool import pool
from workbench.planning.selection import tried
from workbench.plant import ONE_MASS, TWO_MASS, Limits, Plant, freed
from workbench.record import IDENTIFICATION, Record, Source

ENVELOPE = Envelope(low=-2.0, high=2.0, speed=12.0, acceleration=500.0, drive=2.4)
SENSING = Sensing(drive=4e-3, counts=rig.COUNT, dt=1e-3, bandwidth=rig.BAND)


def declared(axis: rig.Axis) -> Plant:
    """The plain axis of the rig, as a declaration would write it."""
    friction = find("presliding_hysteresis")(h0=axis.h0, x0=1.0 / axis.rate)
    effects = (
        find("inertia")(inertia=axis.inertia, fixed=True),
        find("viscous_friction")(viscous=axis.viscous),
        friction,
    )
    return Plant(ONE_MASS, effects, limits=Limits(drive=rig.LIMIT))


AXIS = rig.Axis(inertia=0.0026, viscous=0.011, h0=0.15, rate=650.0)
PLANT = declared(AXIS)


def carried_out(machine: rig.Machine, reference, drive: np.ndarray, seed: int = 1, noise: float = SENSING.drive):
    """Let the rig follow a reference, the planned drive fed forward; return the inverse dynamics over what its log holds."""
    position = reference.position - reference.position[0]
    planned = rig.following("planned", IDENTIFICATION, position, 1 / SENSING.dt, drive)
    made = rig.run(machine, 0.0, planned.make(None, False))
    torque = made.u + noise * np.random.default_rng(seed).standard_normal(made.u.size)
    position = rig.COUNT * np.floor(made.q / rig.COUNT + 0.5)
    channels, resolution = {"torque": torque, "position": position}, {"position": rig.COUNT}
    if machine.two:
        channels["load_position"] = rig.COUNT * np.floor(made.ql / rig.COUNT + 0.5)
        resolution["load_position"] = rig.COUNT
    record = Record("planned", IDENTIFICATION, made.t, channels, {}, Source(Path("rig"), "", "rig", {}), resolution)
    return inverse_dynamics([record], rig.BAND)


# --- motions ------------------------------------------------------------------------------------------------------------


def test_every_motion_of_the_pool_is_within_the_limits_and_starts_and_ends_at_rest():
    found = list(pool(PLANT.effects, ENVELOPE, SENSING, 4.0, "rad"))
    assert len(found) > 25
    assert {r.phrase.split(" ")[0] for r in found} == {"a", "ramps", "point-to-point"}
    for r in found:
        assert r.position.size == 4000
        assert ENVELOPE.low <= r.position.min() + 1e-9 and r.position.max() <= ENVELOPE.high + 1e-9
        assert np.abs(r.speed).max() <= ENVELOPE.speed * 1.001
        assert np.abs(r.acceleration).max() <= ENVELOPE.acceleration * 1.001
        assert np.ptp(r.position[:50]) == np.ptp(r.position[-50:]) == 0.0, r.phrase


def test_a_motion_is_what_its_phrase_says():
    wave = sine(ENVELOPE, 0.01, 4.0, 1e-3, "rad", 5.0)
    middle = wave.position[1000:3000]
    t = wave.time[1000:3000]
    fit = np.linalg.lstsq(
        np.stack([np.sin(10 * np.pi * t), np.cos(10 * np.pi * t), np.ones(t.size)], 1), middle, rcond=None
    )[0]
    assert np.hypot(fit[0], fit[1]) == pytest.approx(0.01, rel=1e-6) and fit[2] == pytest.approx(0.0, abs=1e-9)
    assert wave.phrase == "a sine of 10 mrad at 5 Hz about 0 rad"
    ramp = ramps(ENVELOPE, 2.0, 4.0, 1e-3, "rad", 1.0)
    assert np.median(np.abs(ramp.speed)) == pytest.approx(2.0) and np.ptp(ramp.position) == pytest.approx(1.0, rel=0.1)
    fast = multisine(ENVELOPE, 0.5, 4.0, 1e-3, "rad", 60.0)
    spectrum = np.abs(np.fft.rfft(fast.acceleration[1000:3000]))
    assert spectrum[2:122].sum() > 0.9 * spectrum.sum()
    assert moves(ENVELOPE, 2.0, 4.0, 1e-3, "rad").within(ENVELOPE)


@pytest.mark.parametrize(
    ("value", "text"),
    [(5e-4, "0.5 mrad"), (2.5, "2.5 rad"), (1.234e-5, "12 µrad"), (0.17, "0.17 rad"), (117.0, "117 rad")],
)
def test_quantities_are_written_with_the_prefix_that_suits_them(value, text):
    assert quantity(value, "rad") == text


def test_the_drive_of_a_followed_reference_is_that_of_the_closed_form():
    plant = Plant(ONE_MASS, (find("inertia")(inertia=0.0026), find("viscous_friction")(viscous=0.011)))
    wave = sine(ENVELOPE, 0.1, 4.0, 1e-3, "rad", 5.0)
    inverse = followed(wave, plant, SENSING)
    t, w = wave.time[1000:3000], 10 * np.pi
    s = t - 0.15
    expected = 0.1 * (-0.0026 * w**2 * np.sin(w * s) + 0.011 * w * np.cos(w * s))
    np.testing.assert_allclose(inverse.motion.u[1000:3000], expected, atol=1e-4)


# --- rivals -------------------------------------------------------------------------------------------------------------

STRIBECK = find("stribeck_friction")(drop=0.02, speed=0.5)
RIVALS = {
    "nonlinear_viscous_friction": (find("nonlinear_viscous_friction")(quadratic=-4e-4), 2.0),
    "coulomb_asymmetry": (find("coulomb_asymmetry")(coulomb_difference=0.01), 45.0),
    "transport_delay": (find("transport_delay")(delay=4e-4), 45.0),
}


@pytest.mark.parametrize("name", RIVALS)
def test_rivals_part_along_the_motion_that_is_named_when_the_rig_follows_it(name):
    """The wrong one is left with as many standard deviations as was promised, the right one with the noise alone."""
    other, degrees = RIVALS[name]
    found = separate(PLANT, STRIBECK, other, ENVELOPE, SENSING)
    assert found.apart and found.motion in found.sentence and np.degrees(found.angle) > degrees
    machine = rig.Machine(AXIS, {}).adding("stribeck", "axis", (0.02, 0.5))
    inverses = carried_out(machine, found.reference, followed(found.reference, PLANT + STRIBECK, SENSING).motion.u)
    right, wrong = (solve(Problem(PLANT + e, inverses)).cost / SENSING.drive**2 for e in (STRIBECK, other))
    assert (wrong - right) ** 0.5 > 0.6 * found.deviations > 3.0


def test_two_spellings_of_one_effect_are_told_apart_by_no_motion():
    """Gravity about its lowest place and a spring are the same where the travel is small."""
    near = replace(ENVELOPE, low=-0.02, high=0.02)
    found = separate(PLANT, find("cable_spring")(stiffness=0.1), find("gravity")(sine=0.1), near, SENSING)
    assert not found.apart and found.motion == "" and found.sentence.startswith("No motion")


def test_a_rival_that_shows_nothing_as_it_stands_does_not_hide_the_other():
    nothing = find("load_dependent_friction")(mu=0.0)
    found = separate(PLANT, STRIBECK, nothing, ENVELOPE, SENSING)
    assert found.deviations > 3.0
    turned = separate(PLANT, nothing, STRIBECK, ENVELOPE, SENSING)
    assert turned.motion == found.motion and turned.deviations == pytest.approx(found.deviations, rel=0.01)
    assert "Load dependent friction itself shows nowhere" in turned.sentence and "shows" not in found.sentence


def test_of_two_effects_that_show_nothing_it_is_said():
    nothing = [find("load_dependent_friction")(mu=0.0), find("coulomb_asymmetry")(coulomb_difference=0.0)]
    found = separate(PLANT, *nothing, ENVELOPE, SENSING)
    assert not found.apart and found.sentence.startswith("Neither load dependent friction nor Coulomb asymmetry shows")


@pytest.mark.parametrize("c", [0.03, 30.0], ids=["a spring", "a damper that carries four times as much"])
def test_the_motor_of_two_masses_is_planned_where_the_joint_needs_it(c):
    """Inertia behind a spring and a damper: the deflection is that of the closed form."""
    k, load = 250.0, 0.005
    bodies = (find("inertia")(inertia=0.002, at="motor"), find("inertia")(inertia=load, at="load"))
    plant = Plant(TWO_MASS, (*bodies, find("linear_stiffness")(stiffness=k), find("linear_damping")(damping=c)))
    wave = sine(ENVELOPE, 0.1, 4.0, 1e-3, "rad", 5.0)
    inverse = followed(wave, plant, SENSING)
    channels, inside = inverse.motion.record.channels, slice(1000, 3000)
    w = 10 * np.pi
    phasor = -load * w**2 * 0.1 / (k + 1j * w * c)
    expected = np.imag(phasor * np.exp(1j * w * (wave.time[inside] - 0.15)))
    np.testing.assert_allclose(
        (channels["position"] - channels["load_position"])[inside], expected, atol=2e-3 * abs(phasor)
    )


def gap(half_width: float, stiffness: float = 620.0) -> tuple[Plant, Effect]:
    """An axis of two masses without its gap, and the gap."""
    bodies = (find("inertia")(inertia=0.0021, at="motor"), find("inertia")(inertia=0.0055, at="load"))
    friction = find("coulomb_friction")(coulomb=0.02, at="load")
    plain = Plant(TWO_MASS, (*bodies, friction, find("linear_stiffness")(stiffness=stiffness)))
    return freed(plain), find("backlash")(half_width=half_width)


def test_a_motor_that_is_planned_behind_a_gap_crosses_it():
    """The gap is forty encoder steps wide: within it nothing resists, and the motor has to pass it at each reversal."""
    plain, lash = gap(20 * SENSING.counts)
    channels = followed(sine(ENVELOPE, 0.1, 4.0, 1e-3, "rad", 5.0), plain + lash, SENSING).motion.record.channels
    deflection = (channels["position"] - channels["load_position"])[1000:3000]
    torque = 0.0055 * (10 * np.pi) ** 2 * 0.1 + 0.02
    stiffness = plain["linear_stiffness@joint"].parameters["stiffness"].value
    assert np.ptp(deflection) == pytest.approx(2 * (lash.parameters["half_width"].value + torque / stiffness), rel=0.1)


def test_a_plant_explains_the_record_that_is_planned_with_it():
    """What is smoothed of a deflection is not what the joint's law asks for; it must not part two models."""
    plain, lash = gap(20 * SENSING.counts)
    plant = plain + lash
    inverse = followed(sine(ENVELOPE, 0.1, 4.0, 1e-3, "rad", 5.0), plant, SENSING)
    left = inverse.filtered_drive(plant) - inverse.motion.filter(balances(inverse, plant))
    assert np.abs(left).max() < 1e-9 * np.abs(inverse.motion.u).max()


def test_a_gap_is_told_from_a_spring_that_hardens():
    plain, lash = gap(20 * SENSING.counts)
    found = separate(plain, lash, find("cubic_stiffness")(k3=1e9), ENVELOPE, replace(SENSING, load=0.01))
    assert found.apart and found.deviations < 1e3


def test_a_joint_that_does_not_resist_is_no_motion_and_no_failure():
    """A rival may be fitted with a stiffness of nothing; no deflection then carries the load along."""
    bodies = (find("inertia")(inertia=0.002, at="motor"), find("inertia")(inertia=0.005, at="load"))
    plant = Plant(TWO_MASS, (*bodies, find("linear_stiffness")(stiffness=0.0), find("linear_damping")(damping=0.0)))
    wave = sine(ENVELOPE, 0.1, 4.0, 1e-3, "rad", 5.0)
    assert np.isnan(followed(wave, plant, SENSING).motion.u).all()
    assert tried(wave, plant, ENVELOPE, SENSING) is None


PAIR = rig.Axis(0.0021, 0.011, 0.11, 620.0, load_inertia=0.0055, load_viscous=0.003, k2=250.0, c2=0.03)


def declared_pair(axis: rig.Axis, off=lambda x: x) -> Plant:
    """Two masses of the rig, friction at the motor, a spring with loss between them; off: what is believed of a value."""
    at = lambda name, place, **values: find(name)(at=place, **{n: off(v) for n, v in values.items()})  # noqa: E731
    effects = (
        at("inertia", "motor", inertia=axis.inertia), at("inertia", "load", inertia=axis.load_inertia),
        at("viscous_friction", "motor", viscous=axis.viscous), at("viscous_friction", "load", viscous=axis.load_viscous),
        at("presliding_hysteresis", "motor", h0=axis.h0, x0=1 / axis.rate),
        at("linear_stiffness", "joint", stiffness=axis.k2), at("linear_damping", "joint", damping=axis.c2),
    )  # fmt: skip
    return Plant(TWO_MASS, effects, limits=Limits(drive=rig.LIMIT))


def test_rivals_on_two_masses_part_when_the_rig_follows_the_motor():
    plant = declared_pair(PAIR)
    right, wrong = STRIBECK(at="motor"), find("nonlinear_viscous_friction")(quadratic=-4e-4, at="motor")
    found = separate(plant, right, wrong, ENVELOPE, replace(SENSING, load=0.01))
    assert found.apart and "Stribeck friction at the motor" in found.sentence
    drive = followed(found.reference, plant + right, SENSING)
    planned = replace(found.reference, position=drive.motion.record.channels["position"])
    machine = rig.Machine(PAIR, {}).adding("stribeck", "motor", (0.02, 0.5))
    inverses = carried_out(machine, planned, drive.motion.u)
    costs = [solve(Problem(plant + e, inverses)).cost / SENSING.drive**2 for e in (right, wrong)]
    assert (costs[1] - costs[0]) ** 0.5 > 0.5 * found.deviations


# --- accuracy -----------------------------------------------------------------------------------------------------------

NOISE = 0.04  # N*m a sample: a quarter of the friction, so that noise and not the model sets what is known


def guess(axis: rig.Axis, rng, drop: float, speed: float) -> Plant:
    """What is believed of an axis before the plan: every value up to a tenth wrong."""
    off = lambda x: float(x * rng.uniform(0.9, 1.1))  # noqa: E731
    plain = declared(rig.Axis(off(axis.inertia), off(axis.viscous), off(axis.h0), off(axis.rate)))
    return freed(plain + find("stribeck_friction")(drop=off(drop), speed=off(speed)))


def test_the_promised_accuracy_is_reached_in_nine_of_ten_runs_on_the_rig():
    reached, drop, speed = 0, 0.05, 0.6
    sensing = replace(SENSING, drive=NOISE)
    for seed in range(10):
        rng = np.random.default_rng([seed, 5])
        axis = rig.servo(rng)
        machine = rig.Machine(axis, {}).adding("stribeck", "axis", (drop, speed))
        plant = guess(axis, rng, drop, speed)
        plan = design(plant, ENVELOPE, sensing, 0.08)
        fit = identify(plant, carried_out(machine, plan.trajectory, plan.drive, seed, NOISE))
        truth = {
            "inertia": axis.inertia, "viscous": axis.viscous, "h0": axis.h0, "a": axis.rate, "drop": drop, "speed": speed,
        }  # fmt: skip
        promised = prospects(plan, fit.estimates, 0.08)
        assert {p.parameter for p in promised} == set(truth)
        got = {e.parameter: e.value for e in fit.estimates}
        assert all(p.reached for p in promised)
        reached += all(abs(got[p.parameter] / truth[p.parameter] - 1.0) <= p.then for p in promised)
    assert reached >= 9


def test_what_is_promised_of_two_masses_is_reached_on_the_rig():
    """Noise of both balances is read off a first, short record; then each of the eight parameters is as near as was said."""
    for seed in range(2):
        rng = np.random.default_rng([seed, 9])
        machine = rig.Machine(PAIR._replace(k2=rng.uniform(200.0, 300.0), rate=rng.uniform(400.0, 900.0)), {})
        plant = declared_pair(machine.axis, lambda x, rng=rng: float(x * rng.uniform(0.9, 1.1)))
        first = design(plant, ENVELOPE, replace(SENSING, drive=0.02, load=0.02), 0.1, most=1)
        inverses = carried_out(
            machine, replace(first.trajectory, position=first.position), first.drive, 50 + seed, 0.02
        )
        fit = identify(plant, inverses)
        sensing = sensing_of(inverses, fit.rms[IDENTIFICATION], load_rest(fit.plant, inverses))
        plan = design(fit.plant, ENVELOPE, sensing, 0.05)
        trajectory = replace(plan.trajectory, position=plan.position)
        got = identify(plant, carried_out(machine, trajectory, plan.drive, seed, 0.02))
        true = freed(declared_pair(machine.axis))
        promised = prospects(plan, got.estimates, 0.05)
        assert len(promised) == 8 and all(p.reached for p in promised)
        for p in promised:
            truth = true[f"{p.effect}@{p.at}"].outside[p.parameter].value
            found = next(e.value for e in got.estimates if (e.at, e.parameter) == (p.at, p.parameter))
            assert abs(found / truth - 1.0) < 1.3 * p.then, (seed, p.at, p.parameter)


def planned(plant: Plant, accuracy: float = 0.05, envelope: Envelope = ENVELOPE, most: int = 2):
    """What a plan promises of a plant of which nothing is known: parameter -> Prospect."""
    plan = design(plant, envelope, SENSING, accuracy, most=most)
    return plan, {p.parameter: p for p in prospects(plan, plan.promised, accuracy)}


def test_a_plan_stays_within_the_limits_from_end_to_end():
    plan, _ = planned(PLANT, 0.002, most=4)
    assert len(plan.picks) == 4 and plan.trajectory.within(ENVELOPE)
    assert np.abs(plan.drive).max() <= 1.05 * ENVELOPE.drive
    assert plan.trajectory.speed[0] == plan.trajectory.speed[-1] == 0.0


def test_more_motions_are_planned_where_more_accuracy_is_asked_for():
    noisy = replace(SENSING, drive=NOISE)
    lengths = [design(freed(PLANT), ENVELOPE, noisy, a).trajectory.time[-1] for a in (0.2, 0.05)]
    assert lengths[0] < lengths[1]


def test_an_effect_of_size_zero_is_said_to_have_no_shape():
    _, found = planned(PLANT + find("stribeck_friction")(drop=0.0, speed=0.5))
    assert not found["speed"].reached and "zero as it is fitted" in found["speed"].sentence
    assert found["h0"].reached and found["h0"].why == ""


def test_effects_that_are_one_within_the_travel_are_said_to_be_known_only_together():
    near = replace(ENVELOPE, low=-1e-3, high=1e-3)
    plant = PLANT + find("cable_spring")(stiffness=0.2) + find("gravity")(sine=0.2)
    _, found = planned(plant, envelope=near)
    assert not found["mgl"].reached and "known only together" in found["mgl"].sentence


def test_what_is_below_the_noise_is_said_with_the_time_it_would_take():
    _, found = planned(PLANT + find("constant_offset")(offset=1e-5))
    assert not found["offset"].reached and (
        "s of such motion" in found["offset"].why or "below the noise" in found["offset"].why
    )


# --- the command --------------------------------------------------------------------------------------------------------

STUDY = str(Path(__file__).resolve().parents[2] / "studies" / "harmonic_drive_axis")


def test_a_study_is_planned_into_a_trajectory_at_the_drives_rate(tmp_path, capsys):
    assert main(["plan", STUDY, "--out", str(tmp_path / "plan")]) == 0
    said = capsys.readouterr().out
    assert "now known to" in said and "trajectory.csv" in said
    assert "the model lacks something" in said  # the carried records hold an effect that is not declared
    assert "4 of 4 parameters" in (tmp_path / "plan" / "trajectory.svg").read_text()
    told = json.loads((tmp_path / "plan" / "plan.json").read_text())
    assert {p["parameter"] for p in told["parameters"]} == {"inertia", "viscous", "h0", "a"}
    assert all(p["reached"] and p["promised"] <= 0.02 for p in told["parameters"])
    with open(tmp_path / "plan" / "trajectory.csv", encoding="utf-8") as file:
        names = file.readline().strip().split(",")
        rows = np.loadtxt(file, delimiter=",")
    assert names == ["time_s", "position_rad", "velocity_rad_per_s", "acceleration_rad_per_s2", "torque_Nm"]
    np.testing.assert_allclose(np.diff(rows[:, 0]), told["sample_time"], rtol=1e-6)
    assert told["sample_time"] == 0.25e-3 and rows[-1, 0] == pytest.approx(told["seconds"], abs=1e-3)
    assert np.abs(rows[:, 2]).max() <= 20.9 and np.abs(rows[:, 4]).max() <= 3.0
    np.testing.assert_allclose(np.gradient(rows[:, 1], rows[:, 0])[1:-1], rows[1:-1, 2], atol=0.01)


def test_two_effects_are_told_apart_by_the_command(tmp_path, capsys):
    told = ["plan", STUDY, "--separate", "stribeck_friction", "nonlinear_viscous_friction@axis", "--out"]
    assert main([*told, str(tmp_path / "plan")]) == 0
    assert "record" in capsys.readouterr().out and (tmp_path / "plan" / "trajectory.csv").is_file()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--accuracy", "0"), "more than 0"),
        (("--separate", "stribek_friction", "gravity"), "stribeck_friction"),
        (("--separate", "stribek", "gravity"), "did you mean 'stribeck_friction'"),
        (("--separate", "gravity", "gravity"), "twice"),
        (("--separate", "gravity", "cogging", "--accuracy", "3"), "leave it out"),
    ],
)
def test_what_cannot_be_planned_is_refused_with_a_sentence_and_nothing_is_written(tmp_path, capsys, words, said):
    assert main(["plan", STUDY, "--out", str(tmp_path / "plan"), *words]) == 2
    assert said in capsys.readouterr().err and not (tmp_path / "plan").exists()
