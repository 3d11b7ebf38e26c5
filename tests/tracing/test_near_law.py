"""Free virgin curves in the place of declared friction, and data-sheet values within their tolerance."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, Record, Source
from workbench.tracing import selection
from workbench.tracing.candidates import CORRECTION, Offer
from workbench.tracing.criteria import Criteria
from workbench.tracing.data_sheet import within_tolerance
from workbench.tracing.decide import Verdict
from workbench.tracing.discs import on_the_shaft
from workbench.tracing.in_turn import later
from workbench.tracing.near_law import FURTHEST, count_at, heights, laws, lengthened
from workbench.tracing.plausible import implausible
from workbench.tracing.selection import curved
from workbench.tracing.state import State
from workbench.tracing.tracing import trace

SOURCE = Source(Path("made"), "", "made", {})
COUNT = 1e-6
PLANT = Plant(ONE_MASS) + find("inertia")(inertia=0.01) + find("viscous_friction") + find("coulomb_friction")


def inverses(force, start: float = 0.0, seconds: float = 6.0):
    """InverseDynamics over slow and fast sines whose drive is inertia, viscous friction and force(t, q, dir)."""
    t = start + np.arange(round(1000 * seconds)) / 1000.0
    w, slow = 2 * np.pi * 3.0, 2 * np.pi * 0.4
    q = 0.3 * np.sin(slow * t) + 0.05 * np.sin(w * t)
    v = 0.3 * slow * np.cos(slow * t) + 0.05 * w * np.cos(w * t)
    a = -0.3 * slow**2 * np.sin(slow * t) - 0.05 * w**2 * np.sin(w * t)
    drive = 0.01 * a + 0.05 * v + force(t, q, np.sign(v))
    made = Record("made", IDENTIFICATION, t, {"torque": drive, "position": q}, {}, SOURCE, {"position": COUNT})
    return inverse_dynamics([made], 100.0)


@pytest.mark.parametrize(("count", "found"), [(1e-8, 1e-8), (0.0, 6.9e-7)], ids=["known", "not known"])
def test_a_length_is_held_against_the_encoder_s_own_count_however_fine_that_is(count, found):
    """A cobot's joint gave way over eight counts of 2e-7 of its travel, and that was no presliding: a millionth of the travel was taken for the count."""
    (seen,) = inverses(lambda t, q, way: 0.1 * way)
    record = replace(seen.motion.record, resolution={"position": count} if count else {})
    assert count_at("axis", inverse_dynamics([record], 100.0)) == pytest.approx(found, rel=0.05)


@pytest.mark.parametrize(("name", "values", "loose", "force"), [
    ("gravity", {"mgl": 1.0, "phase": 0.4}, ("phase",), lambda q: 1.3 * np.sin(q + 0.4)),
    ("cogging", {"amplitude": 0.3, "phase": 0.4, "order": 40.0}, ("phase", "phase_2"), lambda q: 0.4 * np.sin(40.0 * q + 0.4)),
    ("cable_spring", {"stiffness": 1.0, "rest": 0.05}, ("rest",), lambda q: 1.3 * (q - 0.05)),
])  # fmt: skip
def test_an_effect_whose_size_alone_is_from_a_data_sheet_holds_it_and_is_traced_where_it_is_wrong(name, values, loose, force):  # fmt: skip
    """Its phase, or where it rests, is free, so that its numbers stay those that a campaign writes."""
    effect = find(name)(at="axis").declared(values, {n: n not in loose for n in find(name).outside}, "here")
    size = next(iter(values))
    drawn = np.random.default_rng(3).standard_normal
    found = trace(PLANT + effect, inverses(lambda t, q, way: 0.3 * way + force(q) + 0.01 * drawn(t.size)))
    assert found.before.plant[effect.key].parameters[size].value == values[size]
    assert [(c.effect, c.kind) for c in found.causes] == [(name, CORRECTION)]
    assert found.after.plant[effect.key].parameters[size].value == pytest.approx(1.3 * values[size], rel=0.05)


@pytest.mark.parametrize("name", ["kinematic_error", "encoder_eccentricity"])
def test_a_wave_of_a_reading_whose_size_is_held_and_whose_phase_is_free_keeps_its_size(name):
    values, held = {"amplitude": 1e-3, "phase": 0.4}, {n: n != "phase" for n in find(name).outside}
    if name == "kinematic_error":
        values["order"] = 40.0
    wave = find(name)(at="sensor.position").declared(values, held, "here")
    seen = inverses(lambda t, q, way: 0.3 * way)
    assert identify(PLANT + wave, seen).plant[wave.key].parameters["amplitude"].value == 1e-3
    assert implausible(wave, PLANT + wave, PLANT, seen) == ""
    if name == "kinematic_error":  # a disc's exists on a rotary axis only
        assert on_the_shaft(wave, replace(PLANT, rotary=False) + wave) == "encoder_eccentricity"


def stops(q: np.ndarray, length: float, level: float) -> np.ndarray:
    """Force of one spring that slips at a length."""
    x, found = 0.0, np.empty(q.size)
    for i, dq in enumerate(np.diff(q, prepend=q[0])):
        x = min(max(x + dq, -length), length)
        found[i] = level * x / length
    return found


def test_a_curve_goes_on_where_its_longest_element_carries_much():
    length = 0.015  # of a travel of 0.7: beyond the first reach of a hundredth
    seen = inverses(lambda t, q, way: stops(q, length, 0.5))
    declared = State(PLANT, seen)
    known = laws(declared.plant, seen)
    short = curved(declared, known, Criteria())
    longer = lengthened(known, short.plant, seen)
    travel = float(np.ptp(seen[0].motion.q))
    assert known[0].slips[-1] < length < longer[0].slips[-1] == pytest.approx(FURTHEST * travel)
    there = curved(declared, longer, Criteria())
    assert there.errors.total < 0.2 * short.errors.total
    held = heights(there.plant[longer[0].key])
    assert sum(held.values()) == pytest.approx(0.5, rel=0.05)


def test_a_lubricant_that_warms_up_thins_by_more_than_what_rubs_dry_and_is_a_drift_of_friction():
    """A positioner whose Coulomb friction fell by a fifth and its viscous friction by a half had "none of the known effects"."""

    def warms(t, q, way):
        v = np.gradient(q, t)
        return (0.3 - 0.06 * (1.0 - np.exp(-t / 20.0))) * way - 0.03 * (1.0 - np.exp(-t / 20.0)) * v

    rng = np.random.default_rng(3)
    seen = [
        p for s in (0.0, 15.0, 40.0) for p in inverses(lambda *a: warms(*a) + 0.003 * rng.normal(size=a[0].size), s)
    ]
    found = trace(PLANT, seen)
    (cause,) = found.causes
    assert (found.verdict, cause.effect, cause.form) == ("cause", "friction_drift", "warming_friction")
    values = {e.parameter: e.value for e in cause.parameters}
    truth = {"rate": -0.003, "viscous_rate": -0.0015, "settling": 0.05}
    assert {n: values[n] for n in truth} == pytest.approx(truth, rel=0.1)


def test_a_drift_that_settles_is_found_with_its_rate():
    seen = [
        p for s in (0.0, 40.0) for p in inverses(lambda t, q, way: (0.5 + 0.2 * (1.0 - np.exp(-t / 20.0))) * way, s)
    ]
    fit = identify(PLANT + find("friction_drift")(settling=0.02), seen)
    told = {e.parameter: e.value for e in fit.estimates}
    assert told["settling"] == pytest.approx(0.05, rel=0.1) and told["rate"] == pytest.approx(0.01, rel=0.1)


@pytest.mark.parametrize("begun", [5000.0, 1.7e9])
def test_a_drift_is_found_on_a_bench_clock_that_does_not_begin_at_zero(begun):
    """Of a clock that stands at an hour, or at the seconds since 1970, exp(-t/20 s) is nothing: an antenna whose grease warms up was "unknown"."""
    rng = np.random.default_rng(4)

    def warms(t, q, way):
        return (0.3 - 0.1 * (1.0 - np.exp(-(t - begun) / 20.0))) * way + 0.003 * rng.normal(size=t.size)

    seen = [p for s in (0.0, 15.0, 40.0) for p in inverses(warms, begun + s)]
    found = trace(PLANT, seen, only={"friction_drift", "stribeck_friction", "sensor_trend"})
    (cause,) = found.causes
    values = {e.parameter: e.value for e in cause.parameters}
    assert (found.verdict, cause.effect) == ("cause", "friction_drift")
    assert values["settling"] == pytest.approx(0.05, rel=0.1) and values["rate"] == pytest.approx(-0.005, rel=0.1)
    assert found.extended.plant["friction_drift@axis"].parameters["since"].value == begun


def test_a_data_sheet_value_is_searched_within_its_tolerance_and_offered_beyond_it():
    sheet = PLANT.swap(find("inertia")(inertia=0.0099, fixed=True))
    loose, told = within_tolerance(sheet, 0.01)
    p = loose["inertia@axis"].parameters["inertia"]
    assert not p.fixed and (p.lower, p.upper) == pytest.approx((0.0099 * 0.99, 0.0099 * 1.01)) and p.value == 0.0099
    offered = [s for s in Offer(stands_for=told).candidates(loose) if s.kind == CORRECTION]
    assert [s.key for s in offered] == ["inertia@axis"]
    free = offered[0].plant["inertia@axis"].parameters["inertia"]
    assert not free.fixed and free.upper > 1.0


def test_what_is_free_has_no_tolerance():
    loose, told = within_tolerance(PLANT, 0.01)
    assert loose == PLANT and told == {}


def test_what_is_not_borne_out_is_asked_again_behind_the_others():
    one, two = object(), object()
    cause, not_borne = Verdict("cause", ("cause",)), ("not borne out", "cause")
    assert later([one, two], Verdict("cause", not_borne)) == [[two, one]]
    assert later([one, two], Verdict("cause", ("cause", "not borne out"))) == later([one], cause) == []
    three = Verdict("cause", (*not_borne, "cause"))
    assert later([one, two, "three"], three) == [[two, one, "three"], [two, "three", one]]


@pytest.mark.parametrize("odd", [False, True])
def test_a_formula_of_values_that_no_machine_has_is_not_what_a_curve_is(monkeypatch, odd):
    """A friction that forgets over kilometres in the place of a presliding curve: then the declared law is nearly right, and no more is said."""
    seen = inverses(lambda t, q, way: stops(q, 1e-3, 0.5))
    declared = State(PLANT, seen)
    known = laws(declared.plant, seen)
    there = curved(declared, known, Criteria())
    monkeypatch.setattr(selection, "absurd", lambda j, state: odd)
    answer, refined = selection._of_declared_laws(
        selection.Answer([], there), known, [], lambda _: None, Offer(), Criteria()
    )
    assert (len(answer.added), [law.key for law in refined]) == ((0, [known[0].key]) if odd else (1, []))


def asperities(q: np.ndarray, length: float, level: float) -> np.ndarray:
    """Force of forty springs that slip at lengths spread so that their virgin curve is level (1 - exp(-x/length))."""
    edges = length * np.geomspace(1e-2, 10.0, 41)
    slips, width = np.sqrt(edges[1:] * edges[:-1]), np.diff(edges)
    share = slips / length**2 * np.exp(-slips / length) * width
    x, found = np.zeros(slips.size), np.empty(q.size)
    for i, dq in enumerate(np.diff(q, prepend=q[0])):
        x = np.clip(x + dq, -slips, slips)
        found[i] = level * share @ (x / slips)
    return found


def test_a_curve_that_is_a_spring_is_the_stiffness_of_the_data_sheet():
    """A curve's elements that hardly slip take what a declared stiffness of 1.0 N*m/rad lacks of 1.2."""
    seen = inverses(lambda t, q, way: asperities(q, 2e-2, 0.5) + 1.2 * q)
    sheet = find("linear_stiffness")(at="axis", stiffness=1.0, fixed=True)
    plant = PLANT.without("coulomb_friction@axis") + find("presliding_hysteresis")(h0=0.5, x0=2e-2) + sheet
    declared = State(plant, seen)
    known = laws(declared.plant, seen)
    there = curved(declared, known, Criteria())
    answer, refined = selection._of_declared_laws(
        selection.Answer([], there), known, [], lambda _: None, Offer(), Criteria()
    )
    ((found,), values) = answer.added, answer.last.plant[sheet.key].parameters
    assert (found.candidate.key, found.candidate.kind, refined) == (sheet.key, CORRECTION, ())
    assert values["stiffness"].value == pytest.approx(1.2, rel=0.02)
