"""Every effect holds what it says; and effects made wrong on purpose are each caught by the check that is for it."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from workbench.conformance import PROPERTIES, check_effect, checks
from workbench.conformance.memory import masing_stack
from workbench.definition import FORCE, SENSOR, Effect, catalogue, find
from workbench.effects.creep import creep
from workbench.effects.elementary import absolute, exp, sign0
from workbench.effects.fading import fading_memory
from workbench.effects.hysteresis import maxwell_slip
from workbench.effects.periodic import cogging
from workbench.effects.play import play_bank
from workbench.parameter import Parameter

BUILT = (
    *catalogue().values(),
    replace(cogging(3), name="cogging_of_three"),
    replace(creep(3), name="creep_of_three"),
    replace(fading_memory(2), name="fading_memory_of_two"),
    maxwell_slip((2e-4, 1e-3)),
    play_bank((2e-4, 1e-3)),
    replace(find("kinematic_error")(at="sensor.position"), name="kinematic_error_at_the_sensor"),
)


@pytest.mark.parametrize("check", [c for e in BUILT for c in checks(e)], ids=str)
def test_it_holds(check):
    result = check()
    assert result.passed, result.sentence
    assert result.sentence.startswith(f"{check.effect.name}, {check.property}: ") and result.sentence.endswith(".")


def made(step, parameters, **given) -> Effect:
    """An effect of the test's own; what is not given is right."""
    said = {"name": "own", "cause": "test", "formula": "test", "source": "test", "port": FORCE, "reads": ("q",)}
    return Effect(step=step, parameters=parameters, **(said | given))


def k(unit: str = "F/x", **given) -> dict[str, Parameter]:
    return {"k": Parameter(1.0, unit, "test", **given)}


def spring(**given) -> Effect:
    return made(lambda s, z, p: ({}, p.k * s.q), k(**given.pop("k", {})), **({"linear": ("k",)} | given))


def dahl(s, z, p):
    way = sign0(s.dq)
    after = way + (z.z - way) * exp(-absolute(s.dq) / p.x0)
    return {"z": after}, p.k * after


MEMORY = {"states": {"z": 1}, "reads": ("dq",), "linear": ("k",)}
DAHL = k("F") | {"x0": Parameter(1e-3, "x", "test", lower=1e-9, scale="stroke")}


def slips(s, z, p):
    x = ca.fmin(ca.fmax(z.z + s.dq, -p.x0), p.x0)
    return {"z": x}, p.k * x


WRONG = {
    "an exponential of the library": ("bits", made(lambda s, z, p: ({}, p.k * ca.exp(s.q)), k(), linear=("k",))),
    "a square that is called linear": ("linear", made(lambda s, z, p: ({}, p.k * p.k * s.q), k(), linear=("k",))),
    "a linear parameter in a state": (
        "linear",
        made(lambda s, z, p: ({"z": z.z + p.k * s.dq}, p.k * s.q), k(), **MEMORY | {"reads": ("q", "dq")}),
    ),
    "a reading that is never true": (
        "neutral",
        made(
            lambda s, z, p: ({}, s.q * (1.0 + p.k) + 1e-9),
            k("1"),
            port=SENSOR,
            places=("sensor",),
            at="sensor.position",
        ),
    ),
    "a root at rest": (
        "derivatives",
        made(lambda s, z, p: ({}, p.k * ca.sqrt(ca.fabs(s.v))), k("F"), linear=("k",), reads=("v",)),
    ),
    "a derivative that floor hides": (
        "derivatives",
        made(lambda s, z, p: ({}, p.k * (s.q + 1e-7 * ca.floor(1e7 * s.q))), k(), linear=("k",)),
    ),
    "a distance kept in hundreds": (
        "single precision",
        made(lambda s, z, p: ({"z": z.z + s.dq + (z.z == 0.0) * 1e7}, p.k * (z.z - 1e7) * (z.z > 0.0)), k(), **MEMORY),
    ),
    "a friction that follows the measured drive": (
        "prediction",
        made(lambda s, z, p: ({}, p.k * absolute(s.u) * s.dir), k("1"), linear=("k",), reads=("u", "dir")),
    ),
    "a friction that drives": (
        "passive",
        made(lambda s, z, p: ({}, -p.k * s.v), k("F*s/x"), linear=("k",), reads=("v",), holds=("passive",)),
    ),
    "a play as a friction": ("passive", replace(find("play"), holds=("passive",))),
    "a creep without time": ("rate independent", replace(find("creep"), holds=("rate independent",))),
    "a square that is called odd": (
        "odd",
        made(lambda s, z, p: ({}, p.k * s.q * s.q), k("F/x^2"), linear=("k",), holds=("odd",)),
    ),
    "a spring that is called even": ("even", spring(holds=("even",))),
    "a damper that is called conservative": (
        "conservative",
        made(lambda s, z, p: ({}, p.k * s.v), k("F*s/x"), linear=("k",), reads=("v",), holds=("conservative",)),
    ),
    "fading memory with Masing's rule": ("masing", made(dahl, DAHL, **MEMORY, holds=("masing",))),
    "fading memory that wipes out": ("wiping out", made(dahl, DAHL, **MEMORY, holds=("masing",))),
    "LuGre with Masing's rule": ("masing", replace(find("lugre_friction"), holds=("masing",))),
    "LuGre that wipes out": ("wiping out", replace(find("lugre_friction"), holds=("masing",))),
    "a virgin curve of another height": (
        "virgin curve",
        replace(find("presliding_hysteresis"), virgin=lambda x, p: 2.0 * p.h0 * (1.0 - exp(-x / p.x0))),
    ),
    "a loop with another description": (
        "describing function",
        made(slips, DAHL, **MEMORY, virgin=lambda x, p: p.k * (x / (x + p.x0)), holds=("masing",)),
    ),
    "two parameters for one": (
        "recovered",
        made(lambda s, z, p: ({}, (p.k + p.c) * s.q), k() | {"c": Parameter(1.0, "F/x", "test")}, linear=("k", "c")),
    ),
    "a unit that nobody knows": ("units", spring(k={"unit": "F/furlong"})),
    "a cause that is not said": ("described", spring(cause="")),
    "a place that is none": ("described", spring(places=("axis", "moon"))),
    "a claim that is not checked": ("described", spring(holds=("beautiful",))),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_a_wrong_effect_is_caught_by_the_check_that_is_for_it(wrong):
    expected, effect = WRONG[wrong]
    failed = {r.property: r.sentence for r in check_effect(effect) if not r.passed}
    assert expected in failed, failed
    assert failed[expected].startswith(f"{effect.name}, {expected}: ")


def test_the_spring_on_which_wrong_effects_are_built_is_right():
    assert all(r.passed for r in check_effect(spring(holds=("conservative", "odd"))))


def test_every_property_is_checked_on_some_effect_and_caught_on_another():
    assert {c.property for e in BUILT for c in checks(e)} == set(PROPERTIES)
    assert {expected for expected, _ in WRONG.values()} == set(PROPERTIES)


def test_an_effect_that_raises_fails_its_checks_and_stops_nothing():
    broken = made(lambda s, z, p: ({}, p.missing * s.q), k())
    results = {r.property: r for r in check_effect(broken)}
    assert results["described"].passed and not results["bits"].passed
    assert "cannot be evaluated: AttributeError" in results["bits"].sentence


def test_the_stack_of_turning_points_is_the_stop_operator():
    random = np.random.default_rng(2)
    path = np.concatenate([[0], np.cumsum(2 * random.choice([-1, 1], 3000) * (random.random(3000) < 0.95))]).astype(int)
    virgin = np.minimum(np.arange(np.abs(path).max() + 1), 20.0)
    w, expected = 0.0, [0.0]
    for step in np.diff(path):
        w = min(max(w + step, -20.0), 20.0)
        expected.append(w)
    np.testing.assert_array_equal(masing_stack(path, virgin), expected)
