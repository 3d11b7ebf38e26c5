"""Gains and tables for drives that take no code: written in the drive's units, read back, refused where it cannot hold them."""

import json
from dataclasses import replace
from math import pi

import numpy as np
import pytest
import yaml
from firmware_bench import AXIS, Gains, need

from workbench.control import fixed_pd, pi_cascade, profile_pi, scheduled_pd
from workbench.control.notched import notched
from workbench.definition import find
from workbench.drives import (
    Cascade,
    Units,
    cascade_of,
    cogging,
    elmo,
    friction,
    kinematic,
    linuxcnc,
    moteus,
    odrive,
    ros2,
    sdo,
    twincat,
)
from workbench.drives.objects import Object, value_of
from workbench.errors import WorkbenchError
from workbench.frequency import Notch
from workbench.plant import ONE_MASS, Plant

TURN = 2.0 * pi
GAINS = Cascade(60.0, 5.0, 300.0, 12.0, 3.3)
PLAIN = replace(GAINS, ki=0.0)
OBJECTS = (
    Object("kv", 0x3000, 1, "UNSIGNED32", 1e3),
    Object("kvp", 0x3140, 1, "REAL32"),  # as an AMP8000's speed loop
    Object("ki", 0x3140, 2, "REAL32"),
    Object("speed_limit", 0x607F, 0, "UNSIGNED32", 1e4),
)


def test_a_pd_is_a_cascade_and_a_schedule_one_a_knot():
    (one,) = cascade_of(fixed_pd(900.0, 5.0), AXIS)
    assert (one.kv, one.kvp, one.ki, one.limit) == (180.0, 5.0, 0.0, 3.3)
    many = cascade_of(scheduled_pd(Gains, scale=0.5), AXIS)
    assert len(many) == Gains.knots.size
    assert many[3].kv * many[3].kvp == pytest.approx(0.5 * Gains.kp[3]) and many[3].kvp == 0.5 * Gains.kd[3]
    assert cascade_of(pi_cascade(60.0, 5.0, 300.0, 12.0), AXIS) == (GAINS,)


def test_around_a_resting_target_the_pid_is_the_cascade():
    """Both laws along one wandering motion that begins at the target: the same commands, sample by sample."""
    p, i, d = GAINS.pid
    dt, n = 1e-4, 2000
    y = 1e-3 * np.sin(np.arange(n) * 0.01) * np.arange(n) / n
    v = np.gradient(y, dt)
    error = -GAINS.kv * y - v
    cascade = GAINS.kvp * error + GAINS.ki * np.concatenate([[0.0], np.cumsum(0.5 * (error[1:] + error[:-1]) * dt)])
    sums = np.concatenate([[0.0], np.cumsum(0.5 * (y[1:] + y[:-1]) * dt)])
    pid = -p * y - i * sums - d * v
    assert np.abs(cascade - pid).max() < 1e-5 * np.abs(pid).max()


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: cascade_of(profile_pi(60.0, 5.0, 300.0, 400.0, 0.01, 12.0), AXIS), "no cascade"),
        (lambda: cascade_of(scheduled_pd(Gains, deceleration=1.0, speed_limit=1.0), AXIS), "no cascade"),
        (lambda: cascade_of(fixed_pd(900.0, 0.0), AXIS), "kd is zero"),
        (lambda: cascade_of(notched(fixed_pd(900.0, 5.0), Notch(260.0, 364.0, 0.6), 2.5e-4), AXIS), "a notch behind its law"),
        (lambda: cascade_of(fixed_pd(np.ones(2), 1.0), AXIS), "several sets"),
        (lambda: cascade_of(fixed_pd(1.0, 1.0), Plant(ONE_MASS)), "no limit"),
        (lambda: replace(GAINS, kv=-1.0), "kv is -1"),
        (lambda: Object("kq", 0x3000, 1, "REAL32"), "'kv' or 'ki'"),
        (lambda: Object("kv", 0x3000, 1, "REAL"), "REAL32"),
        (lambda: Object("kv", 0x10, 1, "REAL32"), "does not exist"),
        (lambda: sdo.write(GAINS, OBJECTS[:2]), "no object for ki"),
        (lambda: sdo.write(GAINS, (*OBJECTS, OBJECTS[0])), "stated twice"),
        (lambda: sdo.write(replace(GAINS, kv=1e9), OBJECTS), r"0x3000:01 \(kv\) would be 1e\+12"),
        (lambda: sdo.write(replace(GAINS, kv=1.4e-3), OBJECTS), "finer units"),
        (lambda: elmo.write([PLAIN] * 17, Units(65536, 2.0), "1/s"), "1 to 16"),
        (lambda: elmo.write([PLAIN], Units(65536, 2.0), "Hz"), "mA/count"),
        (lambda: elmo.write([PLAIN], Units(0, 2.0), "1/s"), "counts"),
        (lambda: elmo.write([PLAIN], Units(65536), "1/s"), "state amps"),
        (lambda: elmo.write([replace(PLAIN, mass=1.0)], Units(65536, 2.0), "1/s"), "feed-forward"),
        (lambda: odrive.write(replace(GAINS, rotary=False)), "rotary"),
        (lambda: odrive.write(replace(GAINS, viscous=1.0)), "viscous"),
        (lambda: odrive.write(replace(GAINS, forward=0.5)), "share of 0.5"),
        (lambda: moteus.write(replace(GAINS, rotary=False)), "rotary"),
        (lambda: moteus.write(replace(GAINS, mass=1.0)), "feed-forward"),
        (lambda: moteus.write(replace(GAINS, kvp=1e9)), "kp would be"),
        (lambda: ros2.write(replace(GAINS, mass=1.0)), "feed-forward"),
        (lambda: ros2.write(GAINS, joint="a b"), "no name"),
        (lambda: linuxcnc.write(GAINS, Units(), "pid x"), "no pid channel"),
        (lambda: linuxcnc.write(replace(GAINS, kvp=1e12), Units()), "Pgain"),
    ],
)  # fmt: skip
def test_what_a_drive_cannot_hold_is_refused_by_name(make, said):
    with pytest.raises(WorkbenchError, match=said):
        make()


def test_an_sdo_list_reads_back():
    found = sdo.read(sdo.write(GAINS, OBJECTS))
    assert found == {(0x3000, 1): 60000.0, (0x3140, 1): 5.0, (0x3140, 2): 300.0, (0x607F, 0): 120000.0}


def test_a_start_up_list_reads_back():
    found = twincat.read(twincat.write(GAINS, OBJECTS))
    for o in OBJECTS:
        assert value_of(o, found[o.index, o.subindex]) == pytest.approx(getattr(GAINS, o.quantity), rel=1e-6)
    assert found[0x3000, 1] == (60000).to_bytes(4, "little")


def test_a_canopen_library_reads_the_bytes_of_both_lists_too():
    need("canopen", "no CANopen library here")
    from canopen import objectdictionary as od

    lines = [x.split(" #")[0].split(",") for x in sdo.write(GAINS, OBJECTS).splitlines() if x.startswith("0x")]
    listed = {(int(i, 16), int(sub, 16)): bytes.fromhex(data) for i, sub, _, _, data in lines}
    assert listed == twincat.read(twincat.write(GAINS, OBJECTS))
    for o in OBJECTS:
        entry = od.ODVariable(o.quantity, o.index, o.subindex)
        entry.data_type = getattr(od, o.type)
        raw = entry.decode_raw(listed[o.index, o.subindex])
        assert raw == pytest.approx(getattr(GAINS, o.quantity) * o.per_si, rel=1e-6)
        assert entry.encode_raw(raw) == listed[o.index, o.subindex]


def test_elmo_gain_sets_read_back_and_are_all_filled():
    units = Units(counts=65536, amps=2.0)
    found = elmo.read(elmo.write([GAINS, replace(GAINS, kv=30.0)], units, "mA/count"))
    per_count = TURN / 65536
    assert len(found) == 16 and found[1] == found[15] and found[0][2] == 60.0 and found[1][2] == 30.0
    assert found[0][1] == pytest.approx(5.0 * per_count * 2000.0, rel=1e-6)  # mA/(count/s): 2 A a N*m
    assert found[0][0] == pytest.approx(300.0 * per_count * 2000.0, rel=1e-6)
    assert elmo.read(elmo.write([GAINS], units, "1/s"))[0][0] == pytest.approx(60.0)


def test_an_odrive_configuration_reads_back_in_turns():
    given = replace(GAINS, mass=0.01, forward=1.0)
    assert json.loads(odrive.write(given))["axis0.controller.config.vel_gain"] == pytest.approx(5.0 * TURN)
    found = odrive.read(odrive.write(given))
    assert found.kv == 60.0 and found.kvp == pytest.approx(5.0) and found.ki == pytest.approx(300.0)
    assert found.mass == pytest.approx(0.01) and found.speed_limit == pytest.approx(12.0)


def test_moteus_lines_read_back():
    found = moteus.read(moteus.write(GAINS))
    assert found["servo.pid_position.kp"] == pytest.approx((60.0 * 5.0 + 300.0) * TURN)
    assert found["servo.pid_position.ki"] == pytest.approx(300.0 * 60.0 * TURN)
    assert found["servo.pid_position.kd"] == pytest.approx(5.0 * TURN)
    assert found["servo.pid_position.ilimit"] == pytest.approx(3.3)


def test_ros2_parameters_read_back_by_another_reader_too():
    content = ros2.write(GAINS, joint="elbow")
    gains = yaml.safe_load(content)["pid_controller"]["ros__parameters"]["gains"]["elbow"]
    assert gains == pytest.approx(ros2.read(content))
    assert (
        gains["p"] == 600.0
        and gains["i"] == 18000.0
        and gains["d"] == 5.0
        and gains["u_clamp_min"] == pytest.approx(-3.3)
    )
    assert all(isinstance(v, float) for v in gains.values())  # ROS refuses an integer for a double


def test_linuxcnc_lines_hold_the_law_in_machine_units():
    given = replace(GAINS, mass=0.01, viscous=0.02)
    found = linuxcnc.read(linuxcnc.write(given, Units(amps=2.0), "pid.z"))
    degree = pi / 180.0 * 2.0
    assert found["Pgain"] == pytest.approx(600.0 * degree) and found["Dgain"] == pytest.approx(5.0 * degree)
    assert (
        found["FF0"] == 0.0
        and found["FF2"] == pytest.approx(0.01 * degree)
        and found["maxoutput"] == pytest.approx(6.6)
    )
    # a reference's speed reaches the output by D and FF1 together: the cascade's forward share, and viscous friction
    assert found["FF1"] + found["Dgain"] == pytest.approx(0.02 * degree, rel=1e-4)  # of two float32
    whole = linuxcnc.read(linuxcnc.write(replace(given, forward=1.0), Units()))
    assert whole["FF1"] == pytest.approx(0.02 * pi / 180.0)


WRITTEN = {
    "sdo": (lambda: sdo.write(GAINS, OBJECTS), sdo.read),
    "twincat": (lambda: twincat.write(GAINS, OBJECTS), twincat.read),
    "elmo": (lambda: elmo.write([GAINS], Units(65536, 2.0), "1/s"), elmo.read),
    "odrive": (lambda: odrive.write(GAINS), odrive.read),
    "moteus": (lambda: moteus.write(GAINS), moteus.read),
    "ros2": (lambda: ros2.write(GAINS), ros2.read),
    "linuxcnc": (lambda: linuxcnc.write(GAINS, Units()), linuxcnc.read),
}


@pytest.mark.parametrize("name", WRITTEN)
def test_a_file_that_lost_a_line_or_a_number_is_refused(name):
    """Strict readers: whatever single line is taken out or spoilt, a file is refused or says less, and never another number."""
    write, read = WRITTEN[name]
    content = write()
    whole = read(content)
    assert "licence is claimed" in content or name == "odrive"
    with pytest.raises(WorkbenchError):
        read("nonsense here\n")
    refused = 0
    lines = content.splitlines()
    for n, line in enumerate(lines):
        for instead in ([], [line.replace("0", "x").replace("3", "x")]):
            try:
                found = read("\n".join([*lines[:n], *instead, *lines[n + 1 :]]) + "\n")
            except WorkbenchError:
                refused += 1
            else:
                assert found == whole or (name in ("sdo", "twincat") and found.items() <= whole.items())
    assert refused > len(lines) / 2


# --- compensation tables ---------------------------------------------------------------------------------------------


def test_a_cogging_table_is_the_effects_torque():
    wave = find("cogging")()
    names = [n for n in wave.parameters if n not in ("order",)]
    wave = wave(**{names[0]: 0.04, names[1]: 0.03, "order": 12.0})
    found = cogging.load(cogging.write(Plant(ONE_MASS, (wave,)), 48, homing=True))
    assert found.homing and found.period == pytest.approx(TURN / 12.0) and found.x.size == 48
    assert np.abs(found.y).max() == pytest.approx(0.05, rel=0.01) and abs(found.y.mean()) < 1e-12


def test_a_kinematic_error_table_is_valid_after_homing_only():
    wave = find("kinematic_error")(at="sensor.position", cosine=3e-5, sine=4e-5, order=60.0)
    text = kinematic.write(Plant(ONE_MASS, (wave,)), 64)
    found = kinematic.load(text)
    assert "valid after homing only" in text and found.homing
    assert np.ptp(found.y) == pytest.approx(1e-4, rel=0.01)


def test_a_friction_table_is_coulomb_and_viscous_in_sliding():
    plant = Plant(
        ONE_MASS,
        (find("inertia")(inertia=1.0), find("coulomb_friction")(coulomb=0.2), find("viscous_friction")(viscous=0.05)),
    )
    found = friction.load(friction.write(plant, 4.0, 8))
    assert found.y == pytest.approx(0.2 * np.sign(found.x) + 0.05 * found.x) and not found.homing
    memory = Plant(ONE_MASS, (find("presliding_hysteresis")(h0=0.15, x0=1.6e-3),))
    assert friction.load(friction.write(memory, 4.0, 8)).y[-1] == pytest.approx(0.15, rel=0.01)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: cogging.write(Plant(ONE_MASS)), "no cogging"),
        (lambda: kinematic.write(Plant(ONE_MASS)), "no kinematic error"),
        (lambda: friction.write(Plant(ONE_MASS), 1.0), "no friction"),
        (lambda: friction.write(Plant(ONE_MASS), 1.0, 5), "even count"),
        (lambda: cogging.write(Plant(ONE_MASS, (find("cogging")(order=12.0),)), 9999), "4 to 4096"),
        (lambda: friction.load("# cogging; valid always; period 0\n#\na,b\n0,1\n1,1\n"), "no table of friction"),
        (lambda: friction.load("# friction; valid always; period 0\n#\na,b\n0,1\n0,1\n"), "does not increase"),
        (lambda: friction.load("# friction; valid always; period 0\n#\na,b\n0,1\n1,x\n"), "line 5: 'x' is no number"),
        (lambda: friction.load("# friction; valid always; period 0\n#\na,b\n0,1\n1\n"), "two cells"),
    ],
)  # fmt: skip
def test_tables_that_cannot_be_are_refused(make, said):
    with pytest.raises(WorkbenchError, match=said):
        make()
