"""The firmware on a Cortex-M4, emulated: the bits of host C and of Python, instructions counted."""

import numpy as np
import pytest
from firmware_bench import AXIS, COUNT, LOOP, Gains, axes_of, bits_of, every, golden, need

need("elftools", "no emulator here")
from firmware_target import Target  # noqa: E402

from workbench.control import RULES, scheduled_pd  # noqa: E402
from workbench.definition import find  # noqa: E402
from workbench.firmware import firmware  # noqa: E402
from workbench.firmware.summary import measured_of  # noqa: E402
from workbench.plant import ONE_MASS, Limits, Plant  # noqa: E402
from workbench.simulation import Scenario, simulate  # noqa: E402

# What a step takes is in measured.json: instructions with velocity filter and encoder, the worst of the vectors and their mean,
# and code; with zig 0.17.1 at -O2. Schedules, of every rule, of one encoder and of two, are held to 120 in float32 and to 200 in
# fixed point; a profile before the law takes a square root more, feed-forward a look-up and a quotient.
ARITHMETICS = ("float32", "fixed")
NAMES = (
    "fixed",
    "following",
    "frozen",
    "error",
    "closing",
    "error, notch",
    "closing, notch",
    "cascade",
    "drive",
    "drive, notch",
    "joint",
    "motor speed",
    "on the motor",
    "following, profiled",
    "fed forward",
)
SCHEDULES = (*RULES, "joint", "motor speed")
HELD = {"float32": 120, "fixed": 200}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_the_target_agrees_in_every_bit_of_1000_vectors(name, arithmetic, tmp_path):
    made = firmware(*every()[name], arithmetic)
    states, words = golden(made)
    target = Target(made, tmp_path)
    target.count(True)
    got, after, spent = target.vectors(states, words)
    axes = axes_of(made.reference, states)
    other = words[:, 1] if made.reference.stages.both else 0
    with np.errstate(all="ignore"):
        u = made.reference.step(axes, words[:, 0], words[:, 2], words[:, 3].view(made.reference.dtype), other)
    assert np.count_nonzero(got != u.view(np.uint32)) == 0
    assert np.count_nonzero(after != bits_of(made.reference, axes)) == 0
    held = measured_of(every()[name][0].law.name, arithmetic)
    assert (spent.max(), round(spent.mean()), target.code) <= (held.worst, held.mean, held.code)
    assert held.worst <= HELD[arithmetic] or name not in SCHEDULES
    assert target.code <= 4096  # bytes of controller and loader


@pytest.mark.parametrize("name", ["following", "following, profiled", "fed forward"])
@pytest.mark.parametrize("arithmetic", ["float32", "fixed"])
def test_another_instruction_set_agrees_in_every_bit_too(name, arithmetic, tmp_path):
    made = firmware(*every()[name], arithmetic)
    states, words = golden(made)
    got, after, _ = Target(made, tmp_path, cpu="risc-v").vectors(states, words)
    axes = axes_of(made.reference, states)
    with np.errstate(all="ignore"):
        u = made.reference.step(axes, words[:, 0], words[:, 2], words[:, 3].view(made.reference.dtype))
    assert np.count_nonzero(got != u.view(np.uint32)) == 0
    assert np.count_nonzero(after != bits_of(made.reference, axes)) == 0


def closed() -> tuple[np.ndarray, int]:
    """Readings of a simulated step on an axis with friction, counts, and its target."""
    effects = (
        find("inertia")(inertia=0.0074),
        find("viscous_friction")(viscous=0.02),
        find("coulomb_friction")(coulomb=0.1),
    )
    plant = Plant(ONE_MASS, effects, limits=Limits(3.3, 20.9))
    run = simulate(plant, LOOP, scheduled_pd(Gains), [Scenario(target=0.1, phase=0.5)], 0.3, ("y",))
    return np.round(run.trajectories["y"][:, 0] / COUNT).astype(np.int64), round(0.1 / COUNT)


@pytest.mark.parametrize("arithmetic", ["float32", "fixed"])
def test_the_target_agrees_along_a_closed_loop_and_a_wrong_sign_does_not(arithmetic, tmp_path):
    made = firmware(scheduled_pd(Gains), LOOP, AXIS, arithmetic)
    y, aim = closed()
    raw = (y & 0xFFFFFFFF).astype(np.uint32)
    words = np.stack([raw, 0 * raw, np.full_like(raw, aim), 0 * raw], axis=1)
    first = np.arange(raw.size) == 0
    axes = made.reference.start(raw[0], np.array([aim]))
    wanted = np.array([made.reference.step(axes, raw[k : k + 1], np.array([aim]))[0] for k in range(raw.size)])
    got = Target(made, tmp_path).run(words, first)
    assert np.count_nonzero(got != wanted.view(np.uint32)) == 0 and np.unique(got).size > 100

    def turned(files):
        assert files["axis.c"].count("reference - y") == 1
        return files | {"axis.c": files["axis.c"].replace("reference - y", "y - reference")}

    assert (Target(made, tmp_path, turned).run(words, first) != got).mean() > 0.5
