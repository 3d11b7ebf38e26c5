"""Two encoders as an angle measurement: lateness of one, zeros, compliance, and what may pass for lateness."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import measured
from made_joints import BAND, BL, BM, JL, JM, K, joint, jointed

from workbench.campaign import load
from workbench.definition import find
from workbench.encoders.angle import Ends
from workbench.encoders.blocks import Blocks
from workbench.encoders.clocks import late_clock, plain
from workbench.encoders.deflection import deflection_of, zeros
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import motion
from workbench.plant import ONE_MASS, Plant


def raw(records, band: float) -> list[InverseDynamics]:
    """InverseDynamics over the records as they are: the zeros of their encoders are not taken off before."""
    return [InverseDynamics(motion(r, band)) for r in records]


def told(records, plant=None):
    return deflection_of(raw(records, BAND), plant or jointed())


@pytest.mark.parametrize("late", [3e-3, -4e-4])
def test_two_encoders_tell_how_late_one_of_them_is(late):
    """Friction behind the joint is not known: the truth lies in the interval, which is wider by what friction may be."""
    found = told([joint(1, late=late), joint(2, late=late, zero=1e-3)])
    assert found.late.low < late < found.late.high and found.late.sure and found.share > 0.9
    assert found.late.value == pytest.approx(late, abs=(BM + BL) / K)
    assert found.friction[1] - found.friction[0] < found.late.high - found.late.low


def test_known_friction_leaves_lateness_nothing_to_hide_behind():
    late = 1e-4  # less than viscous friction could pass for: (BM + BL)/K is 4e-4 s
    found = told([joint(1, late=late), joint(2, late=late)], jointed(inertia=True, viscous=True))
    assert (
        found.late.low < late < found.late.high
        and found.late.value == pytest.approx(late, rel=0.05)
        and found.share > 0.5
    )


def test_dry_friction_that_nobody_declared_hides_no_lateness():
    records = [joint(1, late=3e-3, coulomb=6000.0), joint(2, late=3e-3, coulomb=6000.0, zero=1e-3)]
    assert not plain(told(records))
    found = late_clock(raw(records, BAND), jointed())
    assert found.channel == "load_position" and found.seconds.low < 3e-3 < found.seconds.high
    on_time = [joint(1, coulomb=6000.0), joint(2, coulomb=6000.0, zero=1e-3)]
    assert late_clock(raw(on_time, BAND), jointed()) is None


def test_a_drive_that_tells_no_inertia_leaves_the_declared_one_to_the_angle():
    """A balancer that nobody declared: by the drive's balance alone the bodies have less than no inertia, as a slow robot's have."""

    def balanced(record):
        u = record.channels["torque"] + 1e4 * record.channels["position"]
        return replace(record, channels={**record.channels, "torque": u})

    late = [balanced(joint(k, late=3e-3)) for k in (1, 2)]
    found = late_clock(raw(late, BAND), jointed())
    assert found.channel == "load_position" and found.seconds.low < 3e-3 < found.seconds.high
    assert late_clock(raw([balanced(joint(k)) for k in (1, 2)], BAND), jointed()) is None


def test_a_clock_that_gains_is_told_from_one_that_is_late():
    found = told(
        [joint(1, late=1e-3, gains=2e-4), joint(2, late=1e-3, gains=2e-4)], jointed(inertia=True, viscous=True)
    )
    assert found.drift.value == pytest.approx(2e-4, rel=0.03) and found.start == pytest.approx(1e-3, rel=0.05)


def test_viscous_friction_behind_the_joint_is_no_lateness():
    found = told([joint(1, viscous=5 * BL), joint(2, viscous=5 * BL)])
    assert not found.late.sure and found.share < 0.1


def test_hysteresis_of_the_joint_is_no_lateness():
    """Half of the deflection lags behind the torque: as the speed does, and yet otherwise."""
    found = told([joint(1, loop=0.5), joint(2, loop=0.5)], jointed(inertia=True, viscous=True))
    assert found.share < 0.2
    both = told([joint(1, loop=0.5, late=2e-3), joint(2, loop=0.5, late=2e-3)], jointed(inertia=True, viscous=True))
    assert both.late.value == pytest.approx(2e-3, rel=0.1) and both.share > 0.7


def test_the_drive_tells_whose_clock_is_late():
    """The drive is logged with one of the encoders; there its balance holds."""
    plant = jointed(inertia=True, viscous=True)
    assert told([joint(1, late=3e-3), joint(2, late=3e-3)], plant).by_motor > 1.5
    motor = told([joint(1, late=3e-3, motor=True), joint(2, late=3e-3, motor=True)], plant)
    assert motor.by_motor < 0.7 and motor.late.value == pytest.approx(-3e-3, rel=0.05)


def test_zeros_and_compliance_come_with_their_intervals():
    records = [joint(1, zero=1.4e-3, late=3e-3), joint(2, zero=-1e-3, late=3e-3)]
    found = told(records, jointed(inertia=True, viscous=True))
    for name, zero in (("r1", 1.4e-3), ("r2", -1e-3)):
        assert found.zeros[name].value == pytest.approx(zero, abs=3e-5)
    assert found.compliance.value == pytest.approx(1 / K, rel=0.1)
    assert found.inertial.value == pytest.approx(JL / K, rel=0.05)
    assert zeros(raw(records, BAND), jointed()) == pytest.approx({"r1": 1.4e-3, "r2": -1e-3}, abs=3e-5)


def test_each_record_says_it_for_itself():
    found = told([joint(1, late=2e-3), joint(2, late=1e-3)], jointed(inertia=True, viscous=True))
    assert found.records["r1"].value == pytest.approx(2e-3, rel=0.1)
    assert found.records["r2"].value == pytest.approx(1e-3, rel=0.1)


def test_no_second_encoder_says_nothing():
    record = joint(1)
    alone = type(record)(
        "one", "identification", record.time, {n: record.channels[n] for n in ("torque", "position")}, {}, record.source
    )
    assert zeros(raw([alone], BAND), jointed()) == {}
    one = Plant(ONE_MASS) + find("inertia")(inertia=1.0)
    assert late_clock(raw([alone], BAND), one) is None


def test_what_is_known_bounds_friction_behind_the_joint():
    """Of 1000 kg m2 and 1600 N m s/rad in all."""
    free = Ends((JM, JL), (BM, BL)).rates(1000.0, 1600.0)
    assert free.least == 0.0 and free.most > 1600.0 / JL
    known = Ends((JM, JL), (BM, BL), (True, True), (True, True)).rates(1000.0, 1600.0)
    assert known.least < BL / JL < known.most and known.most - known.least == pytest.approx(0.02 * BL / JL)
    other = Ends((JM, JL), (BM, BL), (True, False), (True, False)).rates(1000.0, 1600.0)
    assert other.least < BL / JL < other.most < 1.02 * BL / JL and other.load == pytest.approx(JL)


def test_a_jackknife_holds_the_truth_as_often_as_it_says():
    rng, held = np.random.default_rng(3), 0
    for _ in range(300):
        x = rng.normal(size=(400, 2))
        y = x @ [1.0, 2.0] + rng.normal(size=400)
        blocks = Blocks(x, y, [slice(20 * k, 20 * k + 20) for k in range(20)])
        held += abs(blocks.solved()[0] - 1.0) < blocks.half_widths()[0]
    assert 0.92 < held / 300 < 0.98


@pytest.mark.parametrize("name", ["kr300_axis1", "kr300_axis1_JmJl", "kr300_axis3", "kr300_axis3_JmJl"])
def test_the_link_encoder_of_a_robot_is_stamped_three_milliseconds_late(name):
    campaign = load(measured("measured", name))
    found = deflection_of(raw(campaign.records, campaign.bandwidth), campaign.plant)
    assert 2.6e-3 < found.late.value < 3.3e-3 and found.share > 0.9
    assert all(2.6e-3 < r.value < 3.3e-3 for r in found.records.values())
    if "axis1" in name:
        degrees = [np.rad2deg(found.zeros[f"axis1_{r}"].value) for r in "ABC"]
        assert degrees == pytest.approx([0.081, 0.085, -0.059], abs=0.005)


@pytest.mark.parametrize("half", [slice(0, 1250), slice(1250, None)], ids=["first", "second"])
def test_five_seconds_of_a_slow_robot_say_it_too(half):
    """The drive's balance alone gives its bodies -3500 and -300 kg*m^2 there."""
    campaign = load(measured("measured", "kr300_axis3"))

    def part(record):
        return replace(record, time=record.time[half], channels={n: x[half] for n, x in record.channels.items()})

    records = [part(r) for r in campaign.records if r.role == "identification"]
    found = late_clock(raw(records, campaign.bandwidth), campaign.plant)
    assert found.channel == "load_position" and found.seconds.low < 2.82e-3 < found.seconds.high
    assert found.seconds.value == pytest.approx(2.82e-3, rel=0.1)
