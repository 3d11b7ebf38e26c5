"""The law as firmware: Python's reference arithmetic and the compiled C give the same bits, whatever comes in."""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from firmware_bench import AXIS, LOOP, Gains, Host, axes_of, bits_of, every, golden

from workbench.control import fixed_pd, scheduled_pd
from workbench.control.named import every as laws
from workbench.errors import WorkbenchError
from workbench.firmware import firmware
from workbench.firmware.stages import stages
from workbench.firmware.units import unit
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.simulation import Loop

ARITHMETICS = ("float32", "fixed")


@pytest.mark.parametrize("name", laws())
def test_units_hold_together_in_every_law(name):
    law = laws()[name]
    for feedback in ("position", "load_position") if law.both else ("position",):
        made = stages(law, feedback)  # raises where unlike units are added
        assert {unit(c.power) for c in made.constants} <= {
            "1", "s", "1/s", "count", "count/s", "count/s^2", "count^2/s^2", "s/count", "N*m", "N*m/count",
            "N*m*s/count", "N*m*s^2/count",
        }  # fmt: skip


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize("name", every())
def test_c_and_python_agree_in_every_bit_of_1000_vectors(name, arithmetic):
    made = built(name, arithmetic).made
    states, words = golden(made)
    axes = axes_of(made.reference, states)
    other = words[:, 1] if made.reference.stages.both else 0
    added = words[:, 3].view(made.reference.dtype)
    with np.errstate(all="ignore"):
        u = made.reference.step(axes, words[:, 0], words[:, 2], added, other)
    got, after = built(name, arithmetic).vectors(states, words)
    assert np.count_nonzero(got != u.view(np.uint32)) == 0
    assert np.count_nonzero(after != bits_of(made.reference, axes)) == 0
    assert np.abs(made.reference.real("u_c", u)).max() <= made.numbers.limit
    assert np.unique(u).size > 300 and axes.fault.any() and not axes.fault.all()


@cache
def built(name: str, arithmetic: str) -> Host:
    return Host(firmware(*every()[name], arithmetic))


@pytest.mark.parametrize("name", every())
def test_no_integer_leaves_its_range_whatever_comes_in(name):
    made = built(name, "fixed").made
    states, words = golden(made, 4000, seed=7)
    states[:, 3:] = np.random.default_rng(3).permuted(states[:, 3:], axis=0)  # memories that no motion leaves behind
    axes = axes_of(made.reference, states)
    made.reference.step(axes, words[:, 0], words[:, 2], words[:, 3].view(np.int32), words[:, 1])
    for typed in made.reference.scales.parts[1:]:
        for line, n in zip(typed.lines, made.reference.last[typed.part.name], strict=True):
            slack = 1e-6 * 2**30 + 4.0  # of rounding
            bits = line.format.bits
            assert (
                np.max(n) <= line.format.high * 2.0**bits + slack and np.min(n) >= line.format.low * 2.0**bits - slack
            )
            assert np.abs(n).max() < 2**31


def walked(n: int, seed: int) -> np.ndarray:
    """Readings of an axis that wanders over many reversals and wraps, counts."""
    draw = np.random.default_rng(seed)
    speed = 9.0 * np.sin(np.arange(n) * 0.03) + 3.0 * np.sin(np.arange(n) * 0.11) + draw.normal(size=n)
    return (np.round(np.cumsum(speed)).astype(np.int64) - 500 & 0xFFFFFFFF).astype(np.uint32)


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize("name", every())
def test_c_and_python_agree_along_a_motion(name, arithmetic):
    made = built(name, arithmetic).made
    n, axes = 250, 6
    y = np.stack([walked(n, seed) for seed in range(axes)])
    r = (y.view(np.int32) + np.round(120.0 * np.sin(np.arange(n) * 0.08))).astype(np.int32).view(np.uint32)
    other = (y.view(np.int32) * 0.75 + 9.0 * np.sin(np.arange(n) * 0.2)).astype(np.int32).view(np.uint32)
    words = np.stack([y, other, r, np.zeros_like(y)], axis=-1).reshape(-1, 4)
    got = built(name, arithmetic).run(words, np.arange(axes * n) % n == 0).reshape(axes, n)
    state = made.reference.start(y[:, 0], r[:, 0], other[:, 0])
    wanted = np.stack([made.reference.step(state, y[:, k], r[:, k], 0, other[:, k]) for k in range(n)], axis=1)
    assert np.count_nonzero(got != wanted.view(np.uint32)) == 0
    assert np.unique(wanted).size > 500


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_a_wrong_sign_is_found(arithmetic):
    """The negative control: one sign of the C turned round."""
    made = firmware(scheduled_pd(Gains), LOOP, AXIS, arithmetic)
    words = np.stack([walked(200, 2), np.zeros(200), np.full(200, 900), np.zeros(200)], axis=1).astype(np.uint32)
    fresh = np.arange(200) == 0

    def turned(files):
        text = files["axis.c"]
        assert text.count("reference - y") == 1
        return files | {"axis.c": text.replace("reference - y", "y - reference")}

    assert (Host(made).run(words, fresh) != Host(made, change=turned).run(words, fresh)).any()


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_the_law_of_the_firmware_is_that_of_the_simulation(arithmetic):
    """Readings of a simulated step given to the reference: its commands are those that the loop acted on."""
    from workbench.definition import find
    from workbench.simulation import Scenario, simulate

    plant = Plant(
        ONE_MASS, (find("inertia")(inertia=0.0074), find("viscous_friction")(viscous=0.02)), limits=Limits(3.3, 20.9)
    )
    target = 40000
    c = scheduled_pd(Gains)
    loop = Loop(2.5e-4, 4, 0.0, 2.5e-4, 4.8e-6)
    found = simulate(plant, loop, c, [Scenario(target=target * 4.8e-6, phase=0.5)], 0.3, ("y", "u", "vh"))
    y = np.round(found.trajectories["y"][:, 0] / 4.8e-6).astype(np.int64)
    raw = (y & 0xFFFFFFFF).astype(np.uint32)
    made = firmware(c, loop, plant, arithmetic)
    axes = made.reference.start(raw[0], np.array([target]))
    u = np.array([made.reference.step(axes, raw[k : k + 1], np.array([target]))[0] for k in range(raw.size)])
    off = np.abs(made.reference.real("u_c", u) - found.trajectories["u"][:, 0])
    if arithmetic == "float32":
        assert off.max() < 1e-5 * 3.3
        return
    scales, vh = made.reference.scales, found.trajectories["vh"][:, 0] / 4.8e-6
    gains = 2.0 ** -scales.column("kp").bits * np.abs(target - y) + 2.0 ** -scales.column("kd").bits * np.abs(vh)
    # a unit of each gain where it is rounded and one where it is interpolated; units of the command for its four cuts
    assert (off <= 2.0 * gains + 4.0 * 2.0 ** -made.reference.format("u_c").bits).all()


def test_the_encoder_wraps_where_its_bits_end():
    made = firmware(fixed_pd(900.0, 5.0), LOOP, AXIS, bits=17)
    y = (np.arange(-200, 400) * 7) % 2**17
    host = Host(made)
    words = np.stack([y, 0 * y, y, 0 * y], axis=1).astype(np.uint32)
    far = host.run(words, np.arange(y.size) == 0)
    whole = Host(firmware(fixed_pd(900.0, 5.0), LOOP, AXIS, bits=32))
    turned = np.stack([np.arange(-200, 400) * 7, 0 * y, np.arange(-200, 400) * 7, 0 * y], axis=1).astype(np.int32)
    steady = whole.run(turned.view(np.uint32), np.arange(y.size) == 0)
    assert np.ptp(far[300:199:-1].view(np.float32)) >= 0.0 and np.isfinite(far.view(np.float32)).all()
    assert far[199] == steady[199]


def test_after_a_jump_the_command_is_zero_until_the_next_start():
    made = firmware(fixed_pd(900.0, 5.0), LOOP, AXIS)
    host = Host(made)
    y = np.zeros(10)
    y[5:] = made.numbers.jump + 1
    words = np.stack([y, 0 * y, y + 100, 0 * y], axis=1).astype(np.uint32)
    fresh = np.isin(np.arange(10), (0, 8))
    u = host.run(words, fresh).view(np.float32)
    assert (u[:5] > 0).all() and (u[5:8] == 0).all() and (u[8:] > 0).all()


def test_what_firmware_cannot_be_made_of_is_refused_by_name():
    with pytest.raises(WorkbenchError, match="resolution in"):
        firmware(fixed_pd(1.0, 1.0), Loop(1e-3), AXIS)
    with pytest.raises(WorkbenchError, match="actuator_limit"):
        firmware(fixed_pd(1.0, 1.0), LOOP, Plant(ONE_MASS))
    with pytest.raises(WorkbenchError, match="several sets"):
        firmware(fixed_pd(np.array([1.0, 2.0]), 1.0), LOOP, AXIS)
    with pytest.raises(WorkbenchError, match="float32"):
        firmware(fixed_pd(1.0, 1.0), LOOP, AXIS, "flaot32")
    fine = SimpleNamespace(knots=1.0 + np.arange(3) / 4096.0, kp=np.ones(3), kd=np.ones(3))
    with pytest.raises(WorkbenchError, match="4096 knots an octave"):
        firmware(scheduled_pd(fine, "following"), LOOP, AXIS)
