"""Where encoders were set to zero: a disc off its axis, and two encoders whose zeros lie apart in each record."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import measured

from workbench.campaign import load
from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.balances import predicted
from workbench.inverse.bodies import Bodies
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.inverse.zeros import relaxed
from workbench.motion import motion
from workbench.plant import ONE_MASS, TWO_MASS, Plant
from workbench.record import Record, Source
from workbench.simulation import open_loop

DT, BAND = 5e-4, 60.0
STIFFNESS, DISC = 800.0, 2e-3


def elastic(rotary: bool = True) -> Plant:
    plant = Plant(TWO_MASS, rotary=rotary)
    for e in (
        find("inertia")(at="motor", inertia=0.004),
        find("inertia")(at="load", inertia=0.008),
        find("viscous_friction")(at="motor", viscous=0.05),
        find("viscous_friction")(at="load", viscous=0.08),
        find("linear_stiffness")(stiffness=STIFFNESS),
        find("linear_damping")(damping=0.05),
        find("gravity")(at="load", sine=0.4, cosine=0.1),
    ):
        plant += e
    return plant


def recorded(plant: Plant, *zeros: float) -> list[Record]:
    """Return a record each of a plant whose load encoder reads less by that zero."""
    t, lane = DT * np.arange(8000), np.arange(len(zeros))
    drive = sum(a * np.sin(2 * np.pi * f * (1 + 0.17 * lane) * t[:, None] + lane) for a, f in ((1.0, 0.9), (0.5, 5.3)))
    run = open_loop(plant, drive, DT, substeps=8, resolution=1e-9)
    found = []
    for i, zero in enumerate(zeros):
        channels = {"torque": drive[:, i].copy(), "position": run["q"][:, i].copy()}
        channels["load_position"] = run["load.q"][:, i] - zero
        role = "validation" if i == 2 else "identification"
        found.append(Record(f"r{i}", role, t, channels, {}, Source(Path("made"), "", "", {})))
    return found


@pytest.mark.parametrize("counted", [False, True], ids=["all", "counted"])
@pytest.mark.parametrize("apart", [(0.0,), (0.01,)])
def test_a_filtered_column_is_the_column_behind_the_filter_where_errors_count(apart, counted):
    """Of two balances side by side, with the joint's mean torque where the zeros are free."""
    (p,) = inverse_dynamics(recorded(elastic(), *apart), BAND)
    n, keep = p.motion.u.size, p.motion.keep
    counts = np.stack([np.arange(n) % 7 > 0, np.arange(n) % 5 > 0]) if counted else None
    p = InverseDynamics(p.motion, counts=counts)
    assert (p.motion.record.zero is None) is (apart == (0.0,))
    for (e, name, column), (_, _, found) in zip(p.columns(elastic()), p.filtered(elastic()), strict=True):
        both = p.motion.filter(column)
        both = both if counts is None else np.where(counts, both, 0.0)
        assert found == pytest.approx(both[:, keep].T.ravel(), abs=1e-9 * np.abs(both).max()), (e.key, name)


@pytest.mark.parametrize("apart", [(0.0, 0.0, 0.0), (0.01, -0.02, 0.015)])
def test_a_joint_is_identified_whatever_the_zeros_of_its_encoders(apart):
    records = recorded(elastic(), *apart)
    fit = identify(elastic(), inverse_dynamics(records, BAND))
    for key, name in (("linear_stiffness@joint", "stiffness"), ("inertia@load", "inertia"), ("gravity@load", "sine")):
        truth = elastic()[key].parameters[name].value
        assert fit.plant[key].parameters[name].value == pytest.approx(truth, rel=0.02), name
    assert fit.identification < 0.01 and fit.validation < 0.01
    said = [f for f in fit.findings if f.kind == "zeros apart"]
    if any(apart):
        (finding,) = said
        shift = np.array(list(finding.evidence.values())) - apart  # but for the mean that gravity bends the joint by
        assert np.abs(shift).max() < 2.0 * 0.5 / STIFFNESS
    else:
        assert said == [] and relaxed(records, BAND) == tuple(records)


def counted(record: Record, first: int) -> Record:
    """Return a record from a sample on, with encoders of a microradian."""
    channels = {n: x[first:] for n, x in record.channels.items()}
    return replace(
        record,
        time=record.time[first:],
        channels=channels,
        resolution=dict.fromkeys(("position", "load_position"), 1e-6),
    )


def test_a_record_that_begins_with_its_joint_wound_up_has_its_encoders_zeros_nevertheless():
    """Friction holds a coupling at an edge of its gap: what the encoders read at first is no zero, if the motion does not say so, too."""
    records = recorded(elastic(), 0.0, 0.0, 0.0)
    apart = [np.abs(r.channels["position"] - r.channels["load_position"]) for r in records]
    wound = [counted(r, int(np.argmax(x[:4000]))) for r, x in zip(records, apart, strict=True)]
    assert relaxed(wound, BAND) == tuple(wound)
    begun = [counted(r, 0) for r in recorded(elastic(), 1e-4, -1e-4, 2e-4)]
    assert [r.zero for r in relaxed(begun, BAND)] == pytest.approx([1e-4, -1e-4, 2e-4], abs=2e-6)


def test_of_a_record_that_begins_in_motion_the_first_reading_is_no_zero():
    """Its joint carries something there, and what the others agree on, which begin at rest, is its zero, too."""
    made = [counted(r, 0) for r in recorded(elastic(), 0.0, 0.0, 0.0)]
    apart = np.abs(made[1].channels["position"] - made[1].channels["load_position"])
    deflected = 100 + int(np.argmax(apart[100:1200]))
    assert apart[deflected] > 1e-4
    moving = [made[0], counted(made[1], deflected), made[2]]
    assert relaxed(moving, BAND) == tuple(moving)
    made = [counted(r, 0) for r in recorded(elastic(), 1e-4, 1e-4, 1e-4)]
    moving = [made[0], counted(made[1], deflected), made[2]]
    assert [r.zero for r in relaxed(moving, BAND)] == pytest.approx([1e-4] * 3, abs=2e-6)
    made = [counted(r, 0) for r in recorded(elastic(), 1e-4, -1e-4, 2e-4)]
    moving = [made[0], counted(made[1], deflected), made[2]]
    zeros = [r.zero for r in relaxed(moving, BAND)]
    assert zeros[::2] == pytest.approx([1e-4, 2e-4], abs=2e-6) and zeros[1] == pytest.approx(-1e-4, abs=1e-4)


def test_a_weight_that_winds_the_joint_up_with_place_is_no_zero():
    """An arm that leans on its joint, here this way and there that way, has a mean angle between its encoders in every record."""

    def leaning(record: Record, q: np.ndarray) -> Record:
        """Return a record of a load that goes slowly between two places, and of a joint that holds its weight and turns it."""
        t = record.time
        load = q[0] + (q[1] - q[0]) * (0.5 - 0.5 * np.cos(2 * np.pi * 0.6 * t)) + 0.02 * np.sin(2 * np.pi * 3.1 * t)
        carried = 4.0 * np.sin(load) + 0.008 * np.gradient(np.gradient(load, DT), DT)
        channels = {"torque": carried, "position": load + carried / STIFFNESS, "load_position": load}
        return replace(record, channels=channels, resolution=dict.fromkeys(("position", "load_position"), 1e-6))

    places = ((-0.9, -0.2), (0.1, 0.8), (-0.3, 0.6))
    records = [leaning(r, np.array(q)) for r, q in zip(recorded(elastic(), 0.0, 0.0, 0.0), places, strict=True)]
    assert relaxed(records, BAND) == tuple(records)
    apart = [
        replace(r, channels={**r.channels, "load_position": r.channels["load_position"] - 0.03 * k})
        for k, r in enumerate(records)
    ]
    assert [r.zero for r in relaxed(apart, BAND)] == pytest.approx([0.0, 0.03, 0.06], abs=4e-4)


def clamped(zero: float) -> Record:
    """Return a record of the same motor whose load is held; what the load encoder reads there is where it was set to zero."""
    t = DT * np.arange(8000)
    held = Plant(ONE_MASS)
    for e in (
        find("inertia")(inertia=0.004),
        find("viscous_friction")(viscous=0.1),  # the motor's, and the joint's damping
        find("linear_stiffness")(at="axis", stiffness=STIFFNESS),
    ):
        held += e
    drive = np.sin(2 * np.pi * 0.9 * t) + 0.5 * np.sin(2 * np.pi * 5.3 * t)
    q = open_loop(held, drive[:, None], DT, substeps=8, resolution=1e-9)["q"][:, 0]
    channels = {"torque": drive, "position": q, "load_position": np.full(t.size, -zero)}
    return Record("held", "identification", t, channels, {}, Source(Path("made"), "", "", {}), locked=True)


def test_a_load_that_is_held_reads_its_zero_at_first_where_the_others_have_one_too():
    """Else the held joint would be wound up by the zero, and its spring given away for a friction that asks for no zero."""
    fit = identify(elastic(), inverse_dynamics([*recorded(elastic(), 0.01, 0.01, 0.01), clamped(0.01)], BAND))
    assert fit.plant["linear_stiffness@joint"].parameters["stiffness"].value == pytest.approx(STIFFNESS, rel=0.02)
    assert fit.identification < 0.02 and fit.nrmse["held"] < 0.02


def test_a_kinematic_error_is_found_between_encoders_whose_zeros_lie_apart():
    """Every record has a zero of its own, so the wave's is no parameter: what rounding makes of its derivative is no direction."""
    wave = find("kinematic_error")(at="joint", order=6.0)
    truth = elastic() + wave(sine=2e-3, cosine=1e-3)
    fit = identify(elastic() + wave, inverse_dynamics(recorded(truth, 0.01, -0.02, 0.015), BAND))
    found = fit.plant["kinematic_error@joint"].parameters
    assert (found["sine"].value, found["cosine"].value) == pytest.approx((2e-3, 1e-3), rel=0.03)
    assert found["order"].value == pytest.approx(6.0, rel=1e-3) and fit.validation < 0.02


def test_friction_in_proportion_to_the_joints_torque_knows_the_weight_that_a_free_zero_takes():
    """The angle between encoders of separate zeros holds no weight; the load's balance does, and friction of the motor's side follows it."""
    friction = find("coulomb_friction")(at="motor", coulomb=0.05), find("load_dependent_friction")(at="motor", mu=0.1)
    truth = elastic() + friction[0] + friction[1]
    records = inverse_dynamics(recorded(truth, 0.01, -0.02, 0.015), BAND)
    fit = identify(elastic() + friction[0] + find("load_dependent_friction")(at="motor"), records)
    assert fit.plant["load_dependent_friction@motor"].parameters["mu"].value == pytest.approx(0.1, abs=0.01)
    assert fit.validation < 0.02


def test_a_zero_that_is_free_is_found_without_the_measured_drive():
    records = recorded(elastic(), 0.01, -0.02, 0.015)
    turned = [replace(r, channels={**r.channels, "torque": r.channels["torque"][::-1].copy()}) for r in records]
    for a, b in zip(inverse_dynamics(records, BAND), inverse_dynamics(turned, BAND), strict=True):
        assert a.motion.record.zero == b.motion.record.zero is not None
        np.testing.assert_array_equal(predicted(a, elastic()), predicted(b, elastic()))


def test_records_of_the_shared_campaigns_keep_their_zeros_and_those_of_a_robot_do_not():
    for name in ("campaigns/c02", "campaigns/c06", "campaigns/c08", "campaigns_d/d14", "campaigns_d/d27"):
        campaign = load(measured(name))
        assert relaxed(campaign.records, campaign.bandwidth) == campaign.records, name
    robot = load(measured("measured/kr300_axis1"))
    zeros = [np.degrees(r.zero) for r in relaxed(robot.records, robot.bandwidth)]
    assert zeros == pytest.approx([0.081, 0.085, -0.059], abs=0.006)  # as found independently


# --- a disc off its axis ------------------------------------------------------------------------------------------------


def disc(at: str):
    return find("encoder_eccentricity")(at=at, sine=0.3 * DISC, cosine=DISC)


def test_a_disc_off_its_axis_reads_zero_at_zero_and_its_map_is_undone_exactly():
    q = np.linspace(-1.0, 1.0, 2001)
    read = q + 0.3 * DISC * np.sin(q) + DISC * (np.cos(q) - 1.0)
    source = Source(Path("made"), "", "", {})
    record = Record("r", "identification", DT * np.arange(q.size), {"torque": 0 * q, "position": read}, {}, source)
    bodies = Bodies(motion(record, BAND), lambda _, make: make())
    np.testing.assert_allclose(bodies.reading("position", [disc("sensor.position")]), q, atol=1e-12)


def test_a_simulated_reading_is_zero_where_the_encoder_was_set_to_zero():
    plant = Plant(ONE_MASS) + find("inertia")(inertia=0.01) + disc("sensor.position")
    run = open_loop(plant, 0.2 * np.ones((800, 1)), DT, substeps=4, resolution=1e-12)
    q, y = run["q"][:, 0], run["y"][:, 0]
    assert y[0] == 0.0 and np.abs(y - q).max() > 0.1 * DISC
    np.testing.assert_allclose(y, q + 0.3 * DISC * np.sin(q) + DISC * (np.cos(q) - 1.0), atol=1e-9)


def test_a_disc_off_its_axis_at_the_load_winds_up_no_joint():
    """The joint of a resting axis carries nothing, whatever the phase of the disc."""
    plant = elastic().without("gravity") + disc("sensor.load_position")
    still = np.zeros(2000)
    channels = {"torque": still, "position": still.copy(), "load_position": still.copy()}
    record = Record("r", "identification", DT * np.arange(2000), channels, {}, Source(Path("made"), "", "", {}))
    np.testing.assert_array_equal(predicted(*inverse_dynamics([record], BAND), plant), still)


def test_two_encoders_that_begin_apart_are_brought_together_and_a_disc_at_the_load_is_a_disc():
    """Truth: a disc of 1.6e-4 rad whose reading begins off zero, and a joint that hardens with 2.2e7 N*m/rad^3."""
    campaign = load(measured("campaigns_d/d21"))
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    assert [p.motion.record.zero for p in inverses] == pytest.approx([-1.378e-4] * 5, abs=1e-6)
    plant = campaign.plant + find("encoder_eccentricity")(at="sensor.load_position") + find("cubic_stiffness")
    fit = identify(plant, inverses)
    found = {(e.effect, e.parameter): e.value for e in fit.estimates}
    assert found["encoder_eccentricity", "amplitude"] == pytest.approx(1.6e-4, rel=0.03)
    assert found["encoder_eccentricity", "phase"] == pytest.approx(2.1, abs=0.05)
    assert found["cubic_stiffness", "k3"] == pytest.approx(2.2e7, rel=0.05)
    assert fit.identification < 0.008 and fit.validation < 0.008
