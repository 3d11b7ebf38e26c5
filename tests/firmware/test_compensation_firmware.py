"""A compensation as firmware: C and Python in every bit, and the force of the law that was simulated, in both arithmetics."""

import ctypes
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from firmware_bench import need_compiler

from workbench.compensation import Compensator, compensated, predicted
from workbench.control import fixed_pd
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.firmware import firmware, host
from workbench.firmware.compensation_make import compensation_firmware
from workbench.plant import ONE_MASS, TWO_MASS, Limits, Plant
from workbench.record import IDENTIFICATION
from workbench.simulation import Loop
from workbench.simulation.recorded import record_of

COUNT = 4.8e-6
LOOP = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, COUNT)
FRICTION = find("presliding_hysteresis")(h0=0.15, x0=1e-3, d=0.9)
PLANT = Plant(
    ONE_MASS,
    (
        find("inertia")(inertia=0.0074), FRICTION, find("stribeck_friction")(drop=0.08, speed=0.05),
        find("viscous_friction")(viscous=0.02), find("cogging")(s1=0.1, order=6.0),
        find("gravity")(sine=0.05, cosine=0.02),
    ),
    limits=Limits(3.3, 20.9),
)  # fmt: skip
NAMED = {
    "friction": ("presliding_hysteresis", "stribeck_friction", "viscous_friction"),
    "everything": ("presliding_hysteresis", "stribeck_friction", "viscous_friction", "cogging", "gravity"),
}
ARITHMETICS = ("float32", "fixed")
CASES = [("everything", "reference"), ("everything", "measured"), ("friction", "measured")]


@cache
def made(name: str, arithmetic: str, source: str):
    return compensation_firmware(
        Compensator.of(PLANT, NAMED[name], source=source), LOOP, PLANT, arithmetic, travel=(-2.0, 2.0)
    )


def moved(n: int, source: str, pace: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Positions in counts and fractions of 2^-16 (an encoder has none): slow and fast, over many reversals."""
    t = pace * LOOP.sample_time * np.arange(n)
    q = (0.4 * np.sin(2 * np.pi * 1.3 * t) + 2e-3 * np.sin(2 * np.pi * 11.0 * t)) / pace
    fine = np.floor(q / COUNT * 65536.0).astype(np.int64)
    return fine >> 16, (fine & 65535) * (source == "reference")


@cache
def built(name: str, arithmetic: str, source: str):
    """The compiled C of one compensation."""
    need_compiler()
    one = made(name, arithmetic, source)
    kind = "float" if one.reference.dtype == np.float32 else "int32_t"
    bench = f"""#include "compensation.h"
static wb_compensation_table table;
static wb_compensation_state state;
int load(const uint8_t *bytes, size_t size);
int load(const uint8_t *bytes, size_t size) {{ return (int)wb_compensation_load(&table, bytes, size, NULL); }}
void run(const uint32_t *in, {kind} *out, uint32_t n);
void run(const uint32_t *in, {kind} *out, uint32_t n)
{{
    wb_compensation_inputs now;
    uint32_t i;
    for (i = 0u; i < n; ++i) {{
        now.position = in[2u * i];
        now.fraction = in[2u * i + 1u];
        if (i == 0u) {{
            wb_compensation_start(&state, &table, &now);
        }}
        out[i] = wb_compensation_step(&state, &table, &now);
    }}
}}
"""
    return host.compiled(one.files | {"bench.c": bench})


def driven(library, one, whole, part) -> np.ndarray:
    """Forces of the compiled C along positions, as it returns them."""
    data = one.image.bytes()
    assert library.load(data[:-1] + b"?", len(data)) == 6  # damaged
    assert library.load(data, len(data)) == 0
    words = np.stack([whole & 0xFFFFFFFF, part], axis=1).astype(np.uint32)
    out = np.zeros(len(words), one.reference.dtype)
    library.run(words.ctypes.data_as(ctypes.c_void_p), out.ctypes.data_as(ctypes.c_void_p), len(words))
    return out


def followed(one, whole, part) -> np.ndarray:
    axes = one.reference.start(whole[:1] & 0xFFFFFFFF, part[:1])
    pairs = zip(whole & 0xFFFFFFFF, part, strict=True)
    return np.concatenate([one.reference.step(axes, w, p) for w, p in pairs])


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize(("name", "source"), CASES)
def test_c_and_python_agree_in_every_bit(name, source, arithmetic):
    one = made(name, arithmetic, source)
    whole, part = moved(400, source, 40.0)
    got = driven(built(name, arithmetic, source), one, whole, part)
    assert np.array_equal(got.view(np.uint32), followed(one, whole, part).view(np.uint32))


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize(("name", "source"), CASES)
def test_the_force_is_that_of_the_law_that_was_simulated(name, source, arithmetic):
    one = made(name, arithmetic, source)
    whole, part = moved(8000, source)
    q = COUNT * (whole + part / 65536.0)
    t = LOOP.sample_time * np.arange(q.size)
    channels = {"torque": 0 * t, "position": q, "reference": q}
    record = record_of("r", IDENTIFICATION, PLANT, t, channels, {"position": COUNT}, "")
    named = Compensator.of(PLANT, NAMED[name], source=source)
    law = predicted(named, record, velocity_filter=LOOP.velocity_filter)
    force = one.reference.real(driven(built(name, arithmetic, source), one, whole, part))
    assert np.abs(force - law)[2:].max() < 4e-3 * np.abs(law).max()  # each table is within 1e-3 of its effect


def test_it_is_a_torque_that_the_laws_own_firmware_adds():
    """In fixed point, what is handed over has the scale of the law's `added`."""
    law = firmware(fixed_pd(900.0, 5.0), LOOP, PLANT, "fixed")
    assert made("friction", "fixed", "measured").reference.scales.limit.bits == law.reference.scales.row("added").bits


def test_a_jump_of_the_encoder_takes_the_force_away_until_the_next_start():
    one = made("everything", "float32", "measured")
    whole, part = moved(500, "measured")
    whole = np.where(np.arange(whole.size) < 300, whole, whole + 2_000_000)
    force = followed(one, whole, part)
    assert np.any(force[:300]) and not np.any(force[300:])


@pytest.mark.parametrize(
    ("names", "options", "said"),
    [
        (("presliding_hysteresis",), {"source": "observer", "mass": 0.01, "bandwidth": 50.0}, "observer lives in"),
        (("cogging",), {}, "travel"),
    ],
)
def test_what_has_no_firmware_is_refused_with_a_sentence(names, options, said):
    with pytest.raises(WorkbenchError, match=said):
        compensation_firmware(Compensator.of(PLANT, names, **options), LOOP, PLANT)


def test_a_compensation_reads_the_encoder_that_closes_its_laws_loop():
    effects = (find("inertia")(at="motor", inertia=0.005), find("inertia")(at="load", inertia=0.004),
               find("linear_stiffness")(at="joint", stiffness=4000.0), find("presliding_hysteresis")(at="load", h0=0.1, x0=1e-3))  # fmt: skip
    plant = Plant(TWO_MASS, effects, limits=Limits(3.3, 20.9))
    named = Compensator.of(plant, ["presliding_hysteresis"], source="measured")
    both = compensated(fixed_pd(900.0, 5.0), named)
    loop = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, COUNT, COUNT, "position")
    with pytest.raises(WorkbenchError, match="encoder of the load"):
        firmware(both, loop, plant)
    made = firmware(both, replace(loop, feedback="load_position"), plant)
    assert made.compensation.reads and "compensation.c" in made.files


def test_a_friction_that_needs_an_exponential_in_its_memory_is_refused():
    plant = Plant(ONE_MASS, (find("inertia")(inertia=0.01), find("lugre_friction")()), limits=Limits(3.3, 20.9))
    with pytest.raises(WorkbenchError, match="exponential"):
        compensation_firmware(Compensator.of(plant, ("lugre_friction",)), LOOP, plant)
