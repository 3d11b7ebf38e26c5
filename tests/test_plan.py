"""Plans: motions within limits, that determine parameters and part rivals; carried out on a rig of another make."""

from dataclasses import replace

import numpy as np
import pytest
import rig
from scipy.interpolate import CubicSpline

from workbench.campaign import load
from workbench.effect import find
from workbench.errors import WorkbenchError
from workbench.identify.fit import fitted_on, passes_of
from workbench.identify.problem import Problem
from workbench.identify.solve import solve
from workbench.plan import Envelope, Sensing, separate
from workbench.plan.following import followed
from workbench.plan.motions import moves, multisine, pool, quantity, ramps, sine
from workbench.plant import ONE_MASS, Limits, Plant

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


def carried_out(folder, axis: rig.Axis, reference, drive: np.ndarray, seed: int = 1):
    """Let the rig follow a reference, the planned drive fed forward; return the campaign of that motion."""
    steps = rig.PER_SAMPLE // rig.PER_CONTROL
    t = np.arange(reference.position.size * steps) * rig.PER_CONTROL / rig.RATE
    course = CubicSpline(reference.time, reference.position - reference.position[0])
    motion = (course(t), course(t, 1), CubicSpline(reference.time, drive)(t))
    records = (("planned", "identification", None, "as planned"), ("again", "validation", None, "the same once more"))
    folder.mkdir(parents=True, exist_ok=True)
    made = [rig.run(axis, 0.0, motion)]
    made.append(replace(made[0], start=float(np.ceil(t[-1] + 2.0))))
    rig.logged(folder, made, 2e-3, np.random.default_rng(seed), records)
    guess = {"inertia": axis.inertia, "viscous": axis.viscous, "h0": axis.h0, "a": axis.rate}
    (folder / "campaign.toml").write_text(
        rig.declaration(axis, guess, "planned", [r.start for r in made], records), encoding="utf-8"
    )
    return load(folder)


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
    wave = sine(ENVELOPE, 0.01, 5.0, 4.0, 1e-3, "rad")
    middle = wave.position[1000:3000]
    t = wave.time[1000:3000]
    fit = np.linalg.lstsq(
        np.stack([np.sin(10 * np.pi * t), np.cos(10 * np.pi * t), np.ones(t.size)], 1), middle, rcond=None
    )[0]
    assert np.hypot(fit[0], fit[1]) == pytest.approx(0.01, rel=1e-6) and fit[2] == pytest.approx(0.0, abs=1e-9)
    assert wave.phrase == "a sine of 10 mrad at 5 Hz about 0 rad"
    ramp = ramps(ENVELOPE, 1.0, 2.0, 4.0, 1e-3, "rad")
    assert np.median(np.abs(ramp.speed)) == pytest.approx(2.0) and np.ptp(ramp.position) == pytest.approx(1.0, rel=0.1)
    fast = multisine(ENVELOPE, 0.5, 60.0, 4.0, 1e-3, "rad")
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
    wave = sine(ENVELOPE, 0.1, 5.0, 4.0, 1e-3, "rad")
    passes = followed(wave, plant, SENSING)
    t, w = wave.time[1000:3000], 10 * np.pi
    s = t - 0.15
    expected = 0.1 * (-0.0026 * w**2 * np.sin(w * s) + 0.011 * w * np.cos(w * s))
    np.testing.assert_allclose(passes.motion.u[1000:3000], expected, atol=1e-4)


# --- rivals -------------------------------------------------------------------------------------------------------------

STRIBECK = find("stribeck_friction")(drop=0.02, speed=0.5)
RIVALS = {
    "nonlinear_viscous_friction": (find("nonlinear_viscous_friction")(quadratic=-4e-4), 2.0),
    "coulomb_asymmetry": (find("coulomb_asymmetry")(coulomb_difference=0.01), 45.0),
    "transport_delay": (find("transport_delay")(delay=4e-4), 45.0),
}


@pytest.mark.parametrize("name", RIVALS)
def test_rivals_part_along_the_motion_that_is_named_when_the_rig_follows_it(tmp_path, name):
    """The wrong one is left with as many standard deviations as was promised, the right one with the noise alone."""
    other, degrees = RIVALS[name]
    found = separate(PLANT, STRIBECK, other, ENVELOPE, SENSING)
    assert found.apart and found.motion in found.sentence and np.degrees(found.angle) > degrees
    axis = replace(AXIS, forces={"stribeck_friction": (0.02, 0.5)})
    drive = followed(found.reference, PLANT + STRIBECK, SENSING).motion.u
    campaign = carried_out(tmp_path, axis, found.reference, drive)
    passes = fitted_on(passes_of(campaign.records, campaign.bandwidth))
    right, wrong = (solve(Problem(PLANT + e, passes)).cost / SENSING.drive**2 for e in (STRIBECK, other))
    assert (wrong - right) ** 0.5 > 0.6 * found.deviations > 3.0


def test_two_spellings_of_one_effect_are_told_apart_by_no_motion():
    """Gravity about its lowest place and a spring are the same where the travel is small."""
    near = replace(ENVELOPE, low=-0.02, high=0.02)
    found = separate(PLANT, find("cable_spring")(stiffness=0.1), find("gravity")(sine=0.1), near, SENSING)
    assert not found.apart and found.motion == "" and found.sentence.startswith("No motion")


def test_a_rival_that_shows_nothing_as_it_stands_does_not_hide_the_other():
    found = separate(PLANT, STRIBECK, find("load_dependent_friction")(mu=0.0), ENVELOPE, SENSING)
    assert found.deviations > 3.0


def test_two_masses_are_refused_with_a_sentence():
    with pytest.raises(WorkbenchError, match="one mass"):
        separate(Plant("two mass"), STRIBECK(at="load"), find("transport_delay")(), ENVELOPE, SENSING)
