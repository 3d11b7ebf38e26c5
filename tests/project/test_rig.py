"""The rig against closed forms, and against what it says of itself: sizes, floors, and what campaigns hold."""

import numpy as np
import pytest
import rig
from rig.machine import Machine, unexplained

from workbench.campaign import load
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics

HELD = rig.Axis(
    inertia=0.002, viscous=0.05, h0=0.0, rate=0.0, load_inertia=0.003, load_viscous=0.0, k2=300.0, c2=0.3, count=1e-7
)


def pushed(axis: rig.Axis, torque: float, seconds: float = 1.0, locked: bool = True):
    """Let a constant torque act on a machine whose load is held or free."""
    n = round(seconds * rig.RATE / rig.PER_CONTROL)
    motion = rig.Motion(np.zeros(n), np.zeros(n), np.full(n, torque), closed=False, locked=locked)
    return rig.run(Machine(axis, {}), 0.0, motion)


def test_a_joint_gives_by_torque_over_stiffness_where_the_load_is_held():
    assert pushed(HELD, 0.6).q[-1] == pytest.approx(0.6 / 300.0, rel=1e-6)


def test_backlash_adds_its_half_width_to_the_deflection():
    assert pushed(HELD._replace(gap=1e-3), 0.6).q[-1] == pytest.approx(0.6 / 300.0 + 1e-3, rel=1e-6)


@pytest.mark.parametrize("torque", [0.2, 1.0])
def test_two_stiffnesses_in_series_give_as_their_formula_says(torque):
    """Flexspline T_f/K_f atan(T/T_f), wave generator T_w/K_w (1 - exp(-T/T_w))."""
    tf, kf, tw, kw = 0.5, 400.0, 0.4, 1500.0
    n = round(rig.RATE / rig.PER_CONTROL)
    machine = Machine(HELD, {}).adding("in_series", "joint", (1 / tf, kf, tw / tf, kw, HELD.k2))
    motion = rig.Motion(np.zeros(n), np.zeros(n), np.full(n, torque), closed=False, locked=True)
    deflection = tf / kf * np.arctan(torque / tf) + tw / kw * (1 - np.exp(-torque / tw))
    assert rig.run(machine, 0.0, motion).q[-1] == pytest.approx(deflection, rel=1e-4)


def test_a_free_load_is_carried_along_with_the_sum_of_both_inertias():
    r = pushed(HELD._replace(viscous=0.0, c2=1.0), 0.1, 0.5, locked=False)
    assert r.q[-1] == pytest.approx(0.5 * 0.1 / 0.005 * 0.5**2, rel=1e-2)
    assert r.q[-1] - r.ql[-1] == pytest.approx(
        0.1 * 0.6 / 300.0, rel=1e-2
    )  # what turns the load goes through the joint


def test_a_log_is_as_late_as_its_clock():
    axis = rig.Axis(inertia=0.002, viscous=0.05, h0=0.0, rate=0.0)
    on_time, late = pushed(axis, 0.1), pushed(axis._replace(late=5e-3), 0.1)
    np.testing.assert_allclose(late.q[5:], on_time.q[:-5], atol=1e-9)


@pytest.mark.parametrize(("base", "rate"), [("presliding", 5000), ("gravity", 1000), ("two mass", 1000)])
def test_a_sound_machine_is_explained_by_what_is_declared_of_it(base, rate):
    """What its balance leaves, before noise and counts, is below the least noise of any campaign."""
    rng = np.random.default_rng(3)
    machine = rig.based(rng, base, 1e-7).machine
    for made in rig.runs(machine, 3, rig.Measuring(rate=rate, short=True), rig.RECORDS):
        assert np.sqrt(np.mean(unexplained(machine, made, 150.0) ** 2)) < 1e-3


@pytest.mark.parametrize(
    ("name", "base"),
    [
        ("transport_delay", "linear"),
        ("clock_skew", "presliding"),
        ("torque_constant_saturation", "gravity"),
        ("viscous_friction", "dry"),
    ],
)
def test_an_effect_of_any_kind_is_as_large_as_asked(tmp_path, name, base):
    """What a fit of the declared model leaves is the noise and the effect, three times as large, in squares."""
    truth = rig.campaign(tmp_path, 11, (name,), 3.0 / rig.LEVEL, base=base, short=True)
    assert truth["missing"] == [name] and truth["sizes"][0] == pytest.approx(3.0, rel=0.05)
    campaign = load(tmp_path)
    left = identify(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth)).identification
    assert left / truth["floor"]["identification"] == pytest.approx(np.hypot(1.0, 3.0), rel=0.25)


def test_every_kind_is_one_law_or_one_map_and_names_its_parameters():
    """What is drawn fits what is named, and what no catalogue has says where it lives."""
    for name, kind in rig.EFFECTS.items():
        assert bool(kind.law) + bool(kind.fields) + (kind.wrong is not None) == 1, name
        base = rig.based(np.random.default_rng(1), kind.bases[0], rig.COUNT)
        assert len(kind.draw(np.random.default_rng(2), base)) == len(kind.names), name
        assert (kind.where is None) == bool(kind.effect), name


def test_the_rig_knows_every_effect_that_a_trace_may_name():
    from workbench.definition import catalogue

    known = {kind.effect for kind in rig.EFFECTS.values()}
    assert known - {""} <= set(catalogue())
    named = {name for name, e in catalogue().items() if e.traced and not e.nearest}  # else it bears another one's name
    asked = named - {"linear_stiffness"}  # of which no joint is without
    asked -= {"friction_behind_gap"}  # which the benches have
    assert asked <= known
