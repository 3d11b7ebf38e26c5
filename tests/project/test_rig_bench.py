"""The rig's benches against closed forms: contacts, laws, disturbances, reports, and what a campaign of theirs states."""

import gzip
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from rig.bench import campaign, drawn
from rig.bench.cause import harmonics, walk
from rig.bench.causes import CAUSES, OUTSIDE, possible
from rig.bench.contacts import lognormal, of_curve, stretched, virgin
from rig.bench.kernel import (
    CUBIC,
    GAUSS,
    LORENTZ,
    POWER,
    RATIONAL,
    ROOT,
    SATURATING,
    TANH,
    Facts,
    applied_torque,
    drag,
    peak,
    played,
    rubbed,
)
from rig.bench.machines import EMPTY, KINDS, Machine, Reported, Timeline
from rig.bench.machines import drawn as stand
from rig.bench.measuring import BROAD, FIRST, STILL, Nuisances, Rates, coloured, disturbance, reported, run, subdivided
from rig.bench.motions import Motion

J, B, V = 0.1, 0.05, 2.0
FREE = Facts(J, B, 0.0, 50.0, J * 100.0, 20.0, 1e-6, forward=J)
SLOW = Rates(1000, 100.0, 1.0)


def ramp(facts: Facts, lists=EMPTY, seconds: float = 1.2, v: float = V):
    """Follow a constant speed, reached within 0.2 s."""
    t = np.arange(round(seconds * SLOW.control)) / SLOW.control
    q = v * np.where(t < 0.2, 2.5 * t**2, t - 0.1)
    return run(Machine(facts, lists), Motion(q, np.zeros(t.size), SLOW.control, ""), 0.0, SLOW)


def pushed(machine: Machine, torque: float, seconds: float = 0.5, start: float = 0.0, **more):
    """Let a constant torque act on an axis that nothing controls."""
    n = round(seconds * SLOW.control)
    return run(machine, Motion(np.zeros(n), np.full(n, torque), SLOW.control, "", closed=False), start, SLOW, **more)


def steady(facts: Facts, lists=EMPTY) -> float:
    """The drive at constant speed."""
    return float(np.mean(ramp(facts, lists).u[-250:-50]))


# --- contacts and laws ------------------------------------------------------------------------------------------------


def test_a_contact_follows_its_virgin_curve_and_masings_rule():
    """A branch after a reversal is the virgin curve, twice as large in force and in distance."""
    bristles = lognormal(1e-3, 0.8)
    x = np.linspace(0.0, 5e-3, 400)
    np.testing.assert_allclose(rubbed(x, bristles), virgin(bristles, x), atol=1e-12)
    there_and_back = np.concatenate([x, x[::-1][1:]])
    back = rubbed(there_and_back, bristles)[x.size :]
    np.testing.assert_allclose(back[-1], virgin(bristles, x[-1:])[0] - 2 * virgin(bristles, x[-1:] / 2)[0], atol=1e-12)


def test_bristles_stand_for_a_stretched_exponential_and_one_comes_near_a_lognormal_contact():
    x = np.geomspace(2e-5, 5e-3, 50)
    np.testing.assert_allclose(virgin(of_curve(4e-4, 0.7), x), 1 - np.exp(-((x / 4e-4) ** 0.7)), atol=6e-3)
    bristles = lognormal(1e-3, 1.0)
    x0, d = stretched(bristles)
    assert d < 1.0 and np.abs(virgin(of_curve(x0, d), x) - virgin(bristles, x)).max() < 0.05


def test_friction_behind_a_gap_is_nothing_until_the_gap_is_crossed():
    x = 1e-3 * np.sin(np.linspace(0, 6 * np.pi, 500))
    assert not np.any(played(x, 1e-3)) and np.ptp(played(x, 4e-4)) == pytest.approx(2 * (1e-3 - 4e-4), rel=1e-3)
    light = Facts(J, 0.0, 1.0, 50.0, 10.0, 20.0, 1e-6, series_gap=0.05)
    r = pushed(Machine(light, EMPTY._replace(bristles=lognormal(1e-4, 0.3))), 0.1, 0.25)
    assert r.q[-1] == pytest.approx(0.5 * 0.1 / J * 0.25**2, rel=0.01) and r.q[-1] < 0.05


@pytest.mark.parametrize(
    ("facts", "resists"),
    [
        ({"curved": 0.3, "curved_kind": POWER, "curved_power": 0.45, "curved_speed": 1.0}, 0.3 * V**0.45),
        ({"curved": 0.3, "curved_kind": SATURATING, "curved_speed": 0.5}, 0.3 * np.tanh(4.0)),
        ({"h0": 0.4, "drop": 0.3, "drop_speed": 1.0, "drop_shape": LORENTZ}, 0.4 + 0.3 / 5.0),
        ({"h0": 0.4, "asymmetry": 0.1}, 0.5),
        ({"h0": 0.4, "fading": 0.2, "fading_distance": 0.05}, 0.6),
    ],
)
def test_a_law_resists_a_constant_speed_as_its_formula_says(facts, resists):
    lists = EMPTY._replace(bristles=lognormal(1e-4, 0.5))
    assert steady(FREE._replace(**facts), lists) == pytest.approx(B * V + resists, rel=0.01)


def test_creep_of_several_rates_drags_by_stiffness_over_rate():
    """A spring whose foot follows at rate r is stretched by v / r."""
    rows = np.array([[8.0, 0.1], [30.0, 0.4]])
    assert steady(FREE, EMPTY._replace(creeping=rows)) == pytest.approx(
        B * V + (rows[:, 1] / rows[:, 0]).sum() * V, rel=0.01
    )


@pytest.mark.parametrize("phase", [0.0, 0.5 * np.pi, -0.5 * np.pi])
def test_an_uneven_joint_yields_by_the_stiffness_of_its_place(phase):
    facts = FREE._replace(load_inertia=J, k2=500.0, c2=1.0, uneven=0.3, uneven_order=2.0, uneven_phase=phase)
    n = 8000
    held = Motion(np.zeros(n), np.full(n, 0.2), SLOW.control, "", closed=False, locked=True)
    r = run(Machine(facts, EMPTY), held, 0.0, SLOW)
    assert r.q[-1] == pytest.approx(0.2 / (500.0 * (1.0 + 0.3 * np.sin(phase))), rel=1e-3) and not r.ql.any()


def test_shapes_have_their_closed_forms():
    x, near = 0.7, pytest.approx
    for shape, form in (
        (GAUSS, np.exp(-(x**2))),
        (LORENTZ, 1 / (1 + x**2)),
        (RATIONAL, 1 / (1 + x)),
        (0.55, np.exp(-(x**0.55))),
    ):
        assert peak(shape, x) == near(form)
    assert drag(POWER, 2.0, -x) == near(-(x**2)) and drag(SATURATING, 0.0, x) == near(np.tanh(x))
    fall = 0.5
    for kind, form in ((TANH, np.tanh(0.6) / fall), (CUBIC, 1.2 - fall**2 * 1.2**3 / 3), (ROOT, 1.2 / np.sqrt(1.36))):
        assert applied_torque(kind, fall, 1.2) == near(form)
        assert applied_torque(kind, fall, 1e-6) == near(1e-6) and applied_torque(kind, 0.0, 3.0) == 3.0


def test_waves_of_several_orders_are_multiples_that_get_weaker():
    rows = harmonics(np.random.default_rng(1), 0.1, 24.0, 3)
    assert np.all(np.diff(rows[:, 0]) < 0) and rows[0, 0] == 0.1 and np.all(rows[:, 1] % 24.0 == 0)


def test_friction_warms_up_with_the_bench_clock():
    warm = Timeline(level=lambda t: 1.0 + 0.5 * np.exp(-t / 10.0))
    machine = Machine(FREE._replace(h0=1.0), EMPTY._replace(bristles=lognormal(1e-6, 0.3)), (warm,))
    assert pushed(machine, 1.4).q[-1] < 1e-4  # held, while cold
    assert pushed(machine, 1.4, start=60.0).q[-1] > 0.1


# --- what is not reported, and what is --------------------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "corner"), [(BROAD, 200.0), (FIRST, 18.0)])
def test_a_disturbance_has_its_rms_and_its_colour(kind, corner):
    x = coloured(np.random.default_rng(2), 400_000, 4000.0, kind, corner)
    assert np.std(x) == pytest.approx(1.0, rel=0.03)
    power = np.abs(np.fft.rfft(x)) ** 2
    f = np.fft.rfftfreq(x.size, 1 / 4000.0)
    share = power[f < corner].sum() / power.sum()
    # of first order, 2/pi atan(1) of the power lies below the corner; of the steep filter nearly all
    assert share == pytest.approx(0.5 if kind == FIRST else 0.97, abs=0.03)


def test_what_pushes_the_body_moves_it_and_is_not_in_the_reported_drive():
    machine = Machine(FREE, EMPTY)
    t = np.arange(2000) / SLOW.control
    force = disturbance(Nuisances(BROAD, 0.1, 200.0), 1.0, [1, 2], t, SLOW.control)
    assert np.std(force) == pytest.approx(0.1, rel=0.15)
    assert not disturbance(Nuisances(STILL), 1.0, [1, 2], t, SLOW.control).any()
    plain, shaken = pushed(machine, 0.2), pushed(machine, 0.2, pushed=force)
    np.testing.assert_array_equal(plain.u, shaken.u)
    assert np.abs(plain.q - shaken.q).max() > 1e-5


def test_hum_that_the_axis_feels_is_of_the_mains_and_of_no_colour():
    t = np.arange(8000) / SLOW.control
    force = disturbance(Nuisances(felt=0.02, mains=50.0), 3.0, [1, 2], t, SLOW.control)
    assert 2 * abs(np.mean(force * np.exp(-2j * np.pi * 50.0 * t))) == pytest.approx(0.02 * 3.0 * np.sqrt(2.0))
    assert np.std(force) == pytest.approx(0.02 * 3.0 * np.sqrt(1.09))
    beside = disturbance(Nuisances(BROAD, 0.1, 200.0), 3.0, [1, 2], t, SLOW.control)
    both = disturbance(Nuisances(BROAD, 0.1, 200.0, felt=0.02), 3.0, [1, 2], t, SLOW.control)
    np.testing.assert_allclose(both - beside, force, atol=1e-12)


def test_a_wander_is_one_course_whatever_asks_for_it():
    t = np.linspace(0.0, 900.0, 9000)
    x = walk(3, 2.0, t)
    np.testing.assert_array_equal(x[100:200], walk(3, 2.0, t[100:200]))
    assert np.std(x) == pytest.approx(1.0, rel=0.15)
    assert np.mean(x[:-20] * x[20:]) == pytest.approx(np.exp(-1.0), abs=0.12)  # 2 s apart


def reporting(**nuisances):
    """The drive at rest as a bench reports it, (n,), and its log: 20 s at 1 kHz."""
    s = stand(np.random.default_rng(4), "gimbal", 1000, 100.0)
    log = pushed(Machine(FREE, EMPTY), 0.0, 20.0)
    x = Nuisances(**{"noise": 0.0, **nuisances})
    return reported(log, s, s.machine, x, SLOW, 2.0, [5, 6]).u, log


def test_the_reported_drive_hums_drifts_and_comes_in_steps():
    hum, log = reporting(hum=0.01, mains=50.0)
    line = 2 * np.mean(hum * np.exp(-2j * np.pi * 50.0 * log.t))
    assert abs(line) == pytest.approx(0.01 * 2.0 * np.sqrt(2.0), rel=1e-3)
    grain, _ = reporting(noise=0.01, grain=0.02)
    np.testing.assert_allclose(grain / 0.04, np.round(grain / 0.04), atol=1e-9)
    assert len(np.unique(np.round(grain / 0.04))) > 2
    drift, _ = reporting(drift=0.01)
    assert 0.0 < np.abs(drift).max() < 0.1 and np.abs(np.diff(drift)).max() < 0.02 * np.abs(drift).max() * 10
    assert not reporting()[0].any()


def test_a_drive_that_was_filtered_before_the_log_has_nothing_above():
    u, _ = reporting(noise=0.01, cut=150.0)
    power, f = np.abs(np.fft.rfft(u)) ** 2, np.fft.rfftfreq(u.size, 1e-3)
    assert power[f > 300.0].sum() < 1e-3 * power[f < 150.0].sum()


def test_an_encoder_errs_within_its_line_by_waves_of_a_fraction_of_it():
    """A wave or two a line, no larger than what stays quiet in the band."""
    s = stand(np.random.default_rng(4), "gimbal", 1000, 100.0)
    x = Nuisances(waves=2, steps=64, subdivision=0.5)
    rows = subdivided(s, x, SLOW, 1e9)
    line = 64 * s.machine.facts.count
    assert rows[0, 0] == pytest.approx(0.5 * s.machine.facts.count) and rows[0, 1] == pytest.approx(4 * np.pi / line)
    assert subdivided(s, x, SLOW, 1e-9)[0, 0] < 1e-6 * s.machine.facts.count
    plain = pushed(Machine(FREE, EMPTY), 0.2)
    off = pushed(Machine(FREE, EMPTY).waved("reading", rows), 0.2)
    np.testing.assert_allclose(off.q - plain.q, rows[0, 0] * np.sin(rows[0, 1] * plain.q + rows[0, 2]), atol=1e-12)


def test_clocks_are_late_packets_are_lost_and_drives_trend():
    machine = Machine(FREE, EMPTY)
    late = pushed(replace(machine, reported=Reported(late=5e-3)), 0.2)
    np.testing.assert_allclose(late.q[5:], pushed(machine, 0.2).q[:-5], atol=1e-9)
    lost = pushed(replace(machine, reported=Reported(lost=((0.2, -1e-3),))), 0.2)
    np.testing.assert_allclose(lost.ql - pushed(machine, 0.2).ql, np.where(lost.t > 0.2, -1e-3, 0.0))
    s = stand(np.random.default_rng(4), "gimbal", 1000, 100.0)
    trending = replace(s.machine, reported=Reported(trend=0.3))
    u = reported(pushed(machine, 0.2, start=10.0), s, trending, Nuisances(noise=0.0), SLOW, 1.0, [1, 2]).u
    np.testing.assert_allclose(u, 0.2 + 0.3 * (10.0 + np.arange(u.size) / 1000), atol=1e-6)


# --- campaigns --------------------------------------------------------------------------------------------------------


def test_where_coulomb_friction_is_declared_contacts_give_way_within_a_count():
    found = [stand(np.random.default_rng(k), "screw stage", 1000, 80.0) for k in range(20)]
    light, heavy = [s for s in found if s.coulomb], [s for s in found if not s.coulomb]
    assert light and heavy
    assert all(np.median(s.machine.lists.bristles[:, 0]) < s.machine.facts.count for s in light)
    assert all(np.median(s.machine.lists.bristles[:, 0]) > 10 * s.machine.facts.count for s in heavy)


def test_every_cause_and_every_kind_of_machine_is_drawn_and_may_be_there():
    specs = drawn(200, 5)
    assert specs == drawn(200, 5) != drawn(200, 6) and len({s.seed for s in specs}) == 200
    assert {n for s in specs for n in s.missing} == {*CAUSES, *OUTSIDE} and {s.kind for s in specs} == set(KINDS)
    assert [sum(s.of == of for s in specs) for of in ("single", "pair", "none", "outside")] == [100, 25, 45, 30]
    stands = [stand(np.random.default_rng(k), kind, 1000, 80.0) for k in range(12) for kind in KINDS]
    assert all(any(possible(name, s) for s in stands) for name in (*CAUSES, *OUTSIDE))


def test_the_rigs_benches_lack_nothing_that_a_trace_cannot_name():
    from workbench.definition import catalogue

    assert set(CAUSES) <= set(catalogue())


def test_a_campaign_loads_states_its_truth_and_is_off_by_its_tolerance(tmp_path):
    from workbench.campaign import load

    truth = campaign(tmp_path, 5, ("gravity",), kind="gimbal")
    loaded = load(tmp_path)
    assert truth["missing"] == ["gravity"] and truth["at"] == ["axis"] and 0.015 <= truth["sizes"][0] < 0.16
    assert truth["nrmse_true_identification"] < truth["nrmse_declared_identification"]
    apart = truth["nrmse_declared_identification"] ** 2 - truth["nrmse_true_identification"] ** 2
    assert np.sqrt(apart) == pytest.approx(truth["sizes"][0], rel=0.35)
    assert {r.role for r in loaded.records} == {"identification", "validation"}
    declared = tomllib.loads((tmp_path / "campaign.toml").read_text(encoding="utf-8"))
    last = next(r["file"] for r in declared["records"] if r["role"] == "validation")
    with gzip.open(tmp_path / last, "rt") as f:
        assert f.readline().startswith("time,torque,position,reference")


def test_a_data_sheet_that_is_wrong_is_off_by_its_share_and_others_by_their_tolerance(tmp_path):
    truth = campaign(tmp_path, 6, ("inertia",), kind="gimbal", tolerance=0.03)
    text = tomllib.loads((tmp_path / "campaign.toml").read_text(encoding="utf-8"))
    assert text["tolerance"] == 0.03
    stated = next(e for e in text["effects"] if e["effect"] == "inertia")["parameters"]["inertia"]
    assert stated["fixed"] and abs(truth["parameters"]["inertia"]["share"]) > 0.0
