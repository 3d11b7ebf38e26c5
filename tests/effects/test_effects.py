"""Effects: what is declared is checked, the neutral ones change nothing, and closed forms are met."""

import random
import re
from bisect import bisect
from dataclasses import replace
from functools import cache
from math import exp, pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from workbench import definition as fx
from workbench.border import Border
from workbench.definition import COMMAND, FORCE, SENSOR, TIME, Effect, catalogue, find
from workbench.effects.direction import stop_direction
from workbench.effects.hysteresis import knots, maxwell_slip, presliding_hysteresis
from workbench.errors import WorkbenchError
from workbench.inverse.balances import required
from workbench.inverse.dynamics import InverseDynamics
from workbench.kernel.step import build, check_linear
from workbench.motion import motion
from workbench.parameter import Parameter
from workbench.plant import ONE_MASS, Plant, places
from workbench.record import Record, Source
from workbench.units import effect_unit, to_si

ARCHITECTURE = Path(__file__).resolve().parents[2] / "docs" / "architecture" / "catalogue-on-paper.md"


def made(step, linear=("gain",), **others) -> Effect:
    parameters = {"gain": Parameter(1.0, "F", "gain"), "other": Parameter(2.0, "F", "other")}
    return Effect("made", "", "", "", FORCE, parameters, step, linear=linear, reads=("v", "dir"), **others)


# --- linearity is checked, not believed -------------------------------------------------------------------------------


@pytest.mark.parametrize("name", catalogue())
def test_every_effect_of_the_catalogue_is_what_it_declares(name):
    check_linear(find(name))


@pytest.mark.parametrize(
    ("step", "linear", "sentence"),
    [
        (lambda s, z, p: ({}, p.gain * p.gain * s.v), ("gain",), "its output is not linear in gain."),
        (lambda s, z, p: ({}, p.gain * p.other * s.v), ("gain", "other"), "its output is not linear in gain, other."),
        (lambda s, z, p: ({}, p.gain * s.v + s.dir), ("gain",), "its output is not zero where gain are zero."),
        (lambda s, z, p: ({}, p.gain * s.v + p.other), ("gain",), "its output is not zero where gain are zero."),
    ],
)
def test_a_wrong_declaration_is_refused_with_a_sentence(step, linear, sentence):
    with pytest.raises(WorkbenchError, match=f"^effect 'made': {sentence}"):
        build(made(step, linear))


def test_a_linear_parameter_in_a_state_is_refused():
    effect = made(lambda s, z, p: ({"x": z.x + p.gain * s.v}, p.gain * z.x), states={"x": 1})
    with pytest.raises(WorkbenchError, match=r"a linear parameter \(gain\) enters its states"):
        build(effect)


def test_an_effect_that_is_linear_indeed_is_taken():
    assert build(made(lambda s, z, p: ({}, p.gain * s.v * p.other))).columns == ("gain",)


# --- names and bounds -------------------------------------------------------------------------------------------------


def test_unknown_names_are_refused_with_the_nearest():
    with pytest.raises(WorkbenchError, match="unknown effect 'stribeck_fricton'; did you mean 'stribeck_friction'"):
        find("stribeck_fricton")
    with pytest.raises(WorkbenchError, match="unknown parameter 'drops'; did you mean 'drop'"):
        find("stribeck_friction")(drops=1.0)
    with pytest.raises(WorkbenchError, match="unknown port 'forc'; did you mean 'force'"):
        replace(find("inertia"), port="forc")
    with pytest.raises(WorkbenchError, match="unknown signal 'temprature'; did you mean 'temperature'"):
        replace(find("inertia"), reads=("temprature",))
    with pytest.raises(WorkbenchError, match="unknown signal 'direction'"):
        replace(find("inertia"), provides=("direction",))
    with pytest.raises(WorkbenchError, match="linear parameter 'inerta' is not declared; did you mean 'inertia'"):
        replace(find("inertia"), linear=("inerta",))
    with pytest.raises(WorkbenchError, match="here: effect 'gravity' has no parameter 'sine'; known: mgl, phase"):
        find("gravity").declared({"sine": 1.0}, {}, "here")


@pytest.mark.parametrize("name", catalogue())
def test_values_outside_physical_bounds_are_refused(name):
    effect = find(name)
    for n, p in effect.parameters.items():
        for beyond in (np.nextafter(p.lower, -np.inf), np.nextafter(p.upper, np.inf)):
            if np.isfinite(beyond):
                with pytest.raises(WorkbenchError, match=f"{name}.{n} is .* outside its physical bounds"):
                    effect(**{n: float(beyond)})
        for no_number in (np.nan, np.inf, -np.inf):
            with pytest.raises(WorkbenchError, match="a finite number is needed"):
                effect(**{n: no_number})
        assert p.lower <= p.value <= p.upper
    for n, p in effect.outside.items():
        if np.isfinite(p.lower) and p.lower == 0.0:
            with pytest.raises(WorkbenchError, match=f"here: {name}.{n} is -1, outside its physical bounds"):
                effect.declared({n: -1.0}, {}, "here")


@pytest.mark.parametrize("rotary", [True, False])
@pytest.mark.parametrize("name", catalogue())
def test_units_resolve_on_rotary_and_linear_axes(name, rotary):
    effect = find(name)
    for parameters in (effect.parameters, effect.outside):
        powers = {n: p.value for n, p in parameters.items() if p.unit == "1"}
        for n, p in parameters.items():
            unit = effect_unit(p.unit, rotary, powers)
            assert to_si(1.0, unit, unit, f"{name}.{n}") == 1.0
            assert not re.search(r"\bF\b|\bx\b", unit)


@pytest.mark.parametrize("name", catalogue())
def test_every_effect_explains_itself(name):
    effect = find(name)
    assert effect.name == name and effect.cause and effect.formula and effect.source
    assert all(p.meaning for p in (*effect.parameters.values(), *effect.outside.values()))


# --- the border -------------------------------------------------------------------------------------------------------


def assert_outside_again(name: str, values: dict[str, float], angles: tuple[str, ...] = ()):
    effect = find(name).declared(values, {}, "here")
    for n, p in effect.outside.items():
        if n in angles:
            assert np.cos(p.value - values[n]) == pytest.approx(1.0, abs=1e-9)
        else:
            assert p.value == pytest.approx(values[n], rel=1e-9)


AMPLITUDE, PHASE = st.floats(1e-6, 1e3), st.floats(-pi, pi)


@settings(deadline=None)
@given(AMPLITUDE, PHASE, AMPLITUDE, PHASE, st.floats(1.0, 500.0))
def test_cogging_comes_out_as_it_went_in(a, p, a2, p2, order):
    values = {"amplitude": a, "phase": p, "amplitude_2": a2, "phase_2": p2, "order": order}
    assert_outside_again("cogging", values, ("phase", "phase_2"))


@settings(deadline=None)
@given(AMPLITUDE, PHASE)
def test_gravity_comes_out_as_it_went_in(mgl, phase):
    assert_outside_again("gravity", {"mgl": mgl, "phase": phase}, ("phase",))


@settings(deadline=None)
@given(AMPLITUDE, st.floats(1e-6, 1e3) | st.floats(-1e3, -1e-6))
def test_a_cable_comes_out_as_it_went_in(stiffness, rest):
    assert_outside_again("cable_spring", {"stiffness": stiffness, "rest": rest})


@settings(deadline=None)
@given(st.floats(0.0, 1e3), st.floats(1e-2, 1e7), st.floats(0.3, 1.0))
def test_hysteresis_comes_out_as_it_went_in(h0, a, d):
    assume(a ** (-1 / d) >= 1e-12)  # the least presliding length
    assert_outside_again("presliding_hysteresis", {"h0": h0, "a": a, "d": d})


@settings(max_examples=20, deadline=None)
@given(st.data())
@pytest.mark.parametrize("name", [n for n, e in catalogue().items() if e.border])
def test_a_border_undoes_itself(name, data):
    """Outside, inside and outside again, for every effect with a border, at values about its defaults."""
    effect = find(name)
    values = {}
    for n, p in effect.border.parameters.items():
        near = abs(p.value) or 1.0
        values[n] = data.draw(st.floats(max(p.lower, 0.3 * near), min(p.upper, 3.0 * near)), label=n)
    inside = effect.border.inward(values)
    assume(all(effect.parameters[n].lower <= v <= effect.parameters[n].upper for n, v in inside.items()))
    again = effect.border.inward(effect.border.outward(inside))
    assert again == pytest.approx(inside, rel=1e-9, abs=1e-12)
    assert set(inside) == set(effect.parameters) and set(effect.border.outward(inside)) == set(effect.border.parameters)


@pytest.mark.parametrize("name", [n for n, e in catalogue().items() if e.border])
def test_a_border_is_there_at_the_defaults(name):
    effect = find(name)
    assert isinstance(effect.border, Border)
    assert effect.outside.keys() == effect.border.parameters.keys()


def test_holding_an_outside_value_holds_what_is_inside():
    held = find("gravity").declared({"mgl": 0.1, "phase": 0.2}, {"mgl": True, "phase": True}, "here")
    assert all(p.fixed for p in held.parameters.values())
    free = find("gravity").declared({"mgl": 0.1, "phase": 0.2}, {}, "here")
    assert not any(p.fixed for p in free.parameters.values())


# --- neutral effects change nothing -----------------------------------------------------------------------------------


def record(seed: int = 0) -> Record:
    n = 400
    rng = np.random.default_rng(seed)
    time = 30.0 + 1e-3 * np.arange(n)
    position = np.cumsum(np.cumsum(rng.normal(size=n))) * 1e-5
    channels = {"torque": rng.normal(size=n), "position": position, "temperature": 300.0 + time, "normal": 5.0 + time}
    return Record("r", "identification", time, channels, {}, Source(Path("r"), "", "", {}), {"position": 1e-6})


def declared() -> Plant:
    plant = Plant(ONE_MASS) + find("inertia")(inertia=2e-3) + find("viscous_friction")(viscous=0.01)
    return plant + find("presliding_hysteresis")(h0=0.15, x0=1e-3)


NEUTRAL = [n for n, e in catalogue().items() if e.linear and not e.provides and "axis" in places(ONE_MASS, e)]


@pytest.mark.parametrize("name", NEUTRAL)
def test_an_effect_with_zero_amplitudes_changes_no_result(name):
    effect = find(name)(at="axis", **dict.fromkeys(find(name).linear, 0.0))
    passes = InverseDynamics(motion(record(), 100.0))
    plant = declared()
    plant = plant.without(name) if name in plant else plant
    np.testing.assert_array_equal(required(passes, plant + effect), required(passes, plant))


# --- the catalogue as the architecture states it ----------------------------------------------------------------------


def table() -> dict[str, tuple[str, list[str]]]:
    """Effect name -> (cell of the port, cell of what it reads as words), from the table of the catalogue."""
    text = ARCHITECTURE.read_text(encoding="utf-8")
    found = {}
    for line in text.splitlines():
        cells = [c.strip() for c in line.strip("|").split("|")]
        if line.startswith("| ") and len(cells) == 6 and cells[0] != "effect":
            for name in cells[0].split(", "):
                found[name] = (cells[1], re.findall(r"[a-z_]+", cells[2]))
    return found


def test_the_table_of_the_catalogue_is_read():
    rows = table()
    assert len(rows) > 25 and rows["inertia"] == ("force", ["a"]) and rows["cubic_stiffness"][1] == ["q"]


@pytest.mark.parametrize("name", [n for n in table() if n in catalogue()])
def test_every_effect_has_the_port_and_reads_that_the_table_states(name):
    effect = find(name)
    port, words = table()[name]
    assert effect.port in re.findall(r"\w+", port)
    may = {w for w in words if w in fx.SIGNALS}
    assert set(effect.reads) <= may
    if "or" not in words:
        assert set(effect.reads) == may
    if "provides dir" in port:
        assert "dir" in effect.provides


# --- hysteresis -------------------------------------------------------------------------------------------------------


def turning_points(moves, x0: float, d: float = 1.0) -> np.ndarray:
    """Friction of height one along increments, by the analytic virgin curve and a stack of turning points (Masing)."""

    def y(x):
        return -np.expm1(-((abs(x) / x0) ** d)) * np.sign(x)

    stack: list[tuple[float, float]] = []  # (position, force), outermost first
    x = force = 0.0
    way = 0.0
    out = []
    for move in moves:
        if move * way < 0:
            stack.append((x, force))
        way = np.sign(move) or way
        x += move
        while stack:
            closing = stack[-2][0] if len(stack) > 1 else -stack[0][0]
            if (x - closing) * way <= 0:
                break
            del stack[-2:]
        force = stack[-1][1] + 2 * y((x - stack[-1][0]) / 2) if stack else y(x)
        out.append(force)
    return np.array(out)


presliding = cache(presliding_hysteresis)  # a build is known again by its step, and every definition makes one


def bank(elements: int, x0: float = 1e-3, d: float = 1.0):
    """Return (k, D) of a bank of height one."""
    effect = presliding(elements)
    constants = build(effect).constants({"h0": 1.0, "x0": x0, "d": d})
    return np.split(constants[1:], 2)


def friction(effect: Effect, moves, **values) -> np.ndarray:
    given = {n: p.value for n, p in effect.parameters.items()} | values
    columns = build(effect).run({"dq": np.asarray(moves, dtype=float)}, given)
    return sum(given[n] * c for n, c in zip(effect.linear, columns, strict=False))


@settings(max_examples=40, deadline=None)
@given(st.floats(0.3, 1.0), st.floats(1e-7, 1.0))
def test_elements_are_stiff_and_reach_the_height_exactly(d, x0):
    k, slip = bank(24, x0, d)
    assert np.all(k >= 0) and np.all(np.diff(slip) > 0)
    assert k @ slip == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(("elements", "bound"), [(16, 2e-3), (32, 5e-4)])
def test_the_virgin_curve_is_met_within_its_bound(elements, bound):
    """The bound h0/(2 N^2) of equidistributed knots (de Boor 1978)."""
    moves = np.full(40_000, 1e-3 * 10 / 40_000)
    curve = -np.expm1(-np.cumsum(moves) / 1e-3)
    found = friction(presliding(elements), moves, h0=1.0)
    assert np.abs(found - curve).max() <= bound
    assert len(knots(elements)) <= elements + 3


@pytest.mark.parametrize("elements", [16, 24])
@pytest.mark.parametrize("seed", range(3))
def test_masing_wiping_out_and_return_points_over_random_reversals(elements, seed):
    rng = np.random.default_rng(seed)
    strokes = rng.exponential(1e-3, 60) * np.where(rng.random(60) < 0.2, 4.0, 1.0)
    moves = np.concatenate([way * np.full(40, s / 40) for way, s in zip(np.resize([1, -1], 60), strokes, strict=True)])
    found = friction(presliding(elements), moves, h0=0.15)
    expected = 0.15 * turning_points(moves, 1e-3)
    assert np.abs(found - expected).max() <= 3 / elements**2 * 0.15


def test_an_inner_loop_is_forgotten_once_it_closes():
    out, back = np.full(100, 2e-5), np.full(30, -2e-5)
    plain = friction(presliding(), np.concatenate([out, out]), h0=1.0)
    with_loop = friction(presliding(), np.concatenate([out, back, -back, out]), h0=1.0)
    np.testing.assert_allclose(with_loop[-100:], plain[-100:], atol=1e-12)
    assert with_loop[159] == pytest.approx(with_loop[99], abs=1e-12)  # the return point


def test_after_a_reversal_the_curve_is_stretched_by_two():
    moves = np.concatenate([np.full(100, 3e-5), np.full(200, -3e-5)])
    found = friction(presliding(), moves, h0=1.0)
    virgin = np.concatenate([[0.0], found[:100]])
    np.testing.assert_allclose(found[99] - found[99::2][:101], 2 * virgin[:101], atol=1e-9)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.floats(-3e-3, 3e-3), min_size=1, max_size=12), st.integers(2, 40))
def test_only_the_path_counts_not_the_time_it_took(moves, parts):
    slow = np.repeat(np.array(moves) / parts, parts)
    fast = friction(presliding(), moves, h0=1.0)
    np.testing.assert_allclose(friction(presliding(), slow, h0=1.0)[parts - 1 :: parts], fast, atol=1e-10)


@settings(max_examples=40, deadline=None)
@given(st.lists(st.floats(-3e-3, 3e-3), min_size=2, max_size=20), st.floats(0.3, 1.0))
def test_a_closed_cycle_takes_energy(moves, d):
    """From the second round on, when the friction has settled, the work over a round is not negative."""
    moves = np.array([*moves, -sum(moves)])
    assume(np.abs(moves).sum() > 0)
    fine = np.tile(np.repeat(moves / 50, 50), 3)
    force = friction(presliding(), fine, h0=1.0, d=d)
    before = np.concatenate([[0.0], force[:-1]])
    work = (0.5 * (force + before) * fine).reshape(3, -1).sum(axis=1)
    assert work[1] >= -1e-9 and work[2] == pytest.approx(work[1], abs=1e-9)
    assert np.abs(force).max() <= 1.0 + 1e-12


def test_the_loop_of_a_stop_is_a_parallelogram():
    """Area 4 k D (A - D) for a cycle of amplitude A > D."""
    stop = maxwell_slip((1e-3,))
    quarter = np.full(250, 4e-3 / 250)
    cycle = np.concatenate([quarter, -quarter, -quarter, quarter])
    moves = np.concatenate([quarter, *[np.concatenate([-quarter, -quarter, quarter, quarter])] * 2])
    force = friction(stop, moves, k1=50.0)
    before = np.concatenate([[0.0], force[:-1]])
    area = float(np.sum(0.5 * (force + before)[-cycle.size :] * moves[-cycle.size :]))
    assert area == pytest.approx(4 * 50.0 * 1e-3 * (4e-3 - 1e-3), rel=0.01)
    assert np.abs(force).max() == pytest.approx(50.0 * 1e-3)


def test_coulomb_friction_with_a_presliding_length_is_one_element_of_maxwell_slip():
    """To the last bit but rounding: a spring Fc/r that slips at Fc."""
    plant = Plant(ONE_MASS) + find("inertia")(inertia=0.0) + find("coulomb_friction")(coulomb=0.15)
    passes = InverseDynamics(motion(record(3), 100.0))
    built = required(passes, plant + find("presliding_length")(length=1e-4))
    one = required(passes, Plant(ONE_MASS) + maxwell_slip((1e-4,))(k1=1500.0))
    np.testing.assert_allclose(built, one, rtol=1e-12, atol=1e-15)
    assert np.abs(one).max() == pytest.approx(0.15) and np.abs(np.abs(one) - 0.15).max() > 0.05


def test_friction_of_a_film_rises_from_viscous_to_its_limit():
    film = build(find("film_friction"))
    v = np.array([-1.0, -1e-6, 0.0, 1e-6, 1e-2, 1.0])
    force = 3.0 * film.run({"v": v}, {"limit": 3.0, "speed": 1e-2})[0]
    np.testing.assert_allclose(force, 3.0 * np.tanh(v / 1e-2), rtol=1e-12)
    assert force[-1] == pytest.approx(3.0) and force[3] == pytest.approx(3e-4, rel=1e-6)


def test_the_asymmetry_of_viscous_friction_is_that_part_of_coulomb_asymmetry():
    v = np.linspace(-2.0, 2.0, 41)
    whole = build(find("coulomb_asymmetry"))
    both = whole.run({"dir": np.sign(v), "v": v}, {"coulomb_difference": 0.0, "viscous_difference": 0.7})
    part = build(find("viscous_asymmetry")).run({"v": v}, {"viscous_difference": 0.7})
    np.testing.assert_array_equal(part[0], both[1])


def test_the_direction_without_hysteresis_turns_within_two_counts():
    direction = build(stop_direction(2e-6)).run(
        {"dq": np.array([1e-6, 1e-6, 1e-6, -1e-6, -1e-6, -1e-6, -1e-6])}, {"width": 2e-6}
    )
    np.testing.assert_allclose(direction[-1], [0.5, 1.0, 1.0, 0.5, 0.0, -0.5, -1.0], atol=1e-12)


# --- closed forms -----------------------------------------------------------------------------------------------------


def output(name: str, signals: dict, **values) -> np.ndarray:
    effect = find(name).declared(values, {}, "here")
    inside = {n: p.value for n, p in effect.parameters.items()}
    columns = build(effect).run({n: np.asarray(s, dtype=float) for n, s in signals.items()}, inside)
    return sum(inside[n] * c for n, c in zip(effect.linear, columns, strict=False))


V = np.linspace(-3, 3, 61)


def test_stribeck_friction_falls_with_the_square_of_speed():
    found = output("stribeck_friction", {"v": V, "dir": np.sign(V)}, drop=0.05, speed=0.4)
    np.testing.assert_allclose(found, 0.05 * np.exp(-((V / 0.4) ** 2)) * np.sign(V), atol=1e-15)
    at_speed = output("stribeck_friction", {"v": [0.4], "dir": [1.0]}, drop=1.0, speed=0.4)
    assert at_speed[0] == pytest.approx(exp(-1), rel=1e-14)


def test_cogging_is_two_waves_with_their_phases():
    q = np.linspace(-2, 2, 101)
    found = output("cogging", {"q": q}, amplitude=0.02, phase=0.7, amplitude_2=0.005, phase_2=2.0, order=60.0)
    np.testing.assert_allclose(found, 0.02 * np.sin(60 * q + 0.7) + 0.005 * np.sin(120 * q + 2.0), atol=1e-15)


def test_the_other_static_effects_are_their_formulas():
    q = np.linspace(-2, 2, 101)
    d = np.linspace(-1, 1, 61)
    np.testing.assert_allclose(output("gravity", {"q": q}, mgl=0.1, phase=0.3), 0.1 * np.sin(q + 0.3), atol=1e-15)
    np.testing.assert_allclose(output("cable_spring", {"q": q}, stiffness=2.0, rest=0.4), 2.0 * (q - 0.4), atol=1e-15)
    np.testing.assert_allclose(
        output("nonlinear_viscous_friction", {"v": V}, quadratic=0.3), 0.3 * V * np.abs(V), rtol=1e-15
    )
    np.testing.assert_allclose(
        output("coulomb_asymmetry", {"v": V, "dir": d}, coulomb_difference=0.02, viscous_difference=0.003),
        0.02 * np.abs(d) + 0.003 * np.abs(V), atol=1e-17,
    )  # fmt: skip
    np.testing.assert_array_equal(output("inertia", {"a": V}, inertia=0.003), 0.003 * V)
    np.testing.assert_array_equal(output("viscous_friction", {"v": V}, viscous=0.01), 0.01 * V)
    np.testing.assert_array_equal(output("coulomb_friction", {"dir": d}, coulomb=0.15), 0.15 * d)


@pytest.mark.parametrize("ratio", [0.05, 1.0, 20.0])
def test_a_lag_answers_a_ramp_exactly(ratio):
    """u = t from rest: u' = t - T (1 - exp(-t/T)), exact because the command is linear between samples."""
    T, dt = 1.0, ratio
    t = dt * np.arange(0, 40)
    found = build(find("actuator_lag")).run({"u": t, "dt": dt}, {"time_constant": T}, states=np.zeros(2))[0]
    np.testing.assert_allclose(found, t - T * -np.expm1(-t / T), rtol=1e-12, atol=1e-12)


# --- the catalogue ----------------------------------------------------------------------------------------------------


def test_the_catalogue_is_in_the_order_of_its_names_and_frozen():
    names = list(catalogue())
    assert names == sorted(names)
    assert bisect(names, "inertia") and {"inertia", "stribeck_friction", "cogging"} <= set(names)
    with pytest.raises(TypeError):
        catalogue()["mine"] = find("inertia")


def test_an_effect_is_not_changed_by_use():
    effect = find("inertia")
    other = effect(inertia=3.0, fixed=True)
    assert effect.parameters["inertia"].value == 0.0 and not effect.parameters["inertia"].fixed
    assert other.parameters["inertia"].value == 3.0 and other.parameters["inertia"].fixed
    assert not other.free("inertia").parameters["inertia"].fixed
    with pytest.raises(TypeError):
        effect.parameters["inertia"] = other.parameters["inertia"]


def test_every_effect_can_act_somewhere():
    for name, effect in catalogue().items():
        where = [p for kind in ("one mass", "two mass") for p in places(kind, effect)]
        assert where, f"{name} has no place on any plant."
        if effect.port in (COMMAND, SENSOR, TIME):
            assert not {"axis", "motor", "load", "joint"} & set(where)


def test_names_are_drawn_at_random_from_the_catalogue_and_composed():
    """Any three forces of an axis compose, in any order, and ask for the same drive to the last bits of their sum."""
    forces = [n for n in NEUTRAL if not set(find(n).reads) & {"temperature", "normal"}]
    passes = InverseDynamics(motion(record(1), 100.0))
    for seed in range(5):
        chosen = random.Random(seed).sample(forces, 3)
        small = [{p: 0.01 for p in find(n).linear if find(n).parameters[p].lower <= 0.01} for n in chosen]
        effects = [find(n)(at="axis", **values) for n, values in zip(chosen, small, strict=True)]
        totals = []
        for order in (effects, effects[::-1]):
            plant = Plant(ONE_MASS) + find("presliding_hysteresis")(h0=0.1)
            for e in order:
                plant = plant + e
            totals.append(required(passes, plant))
        np.testing.assert_allclose(totals[0], totals[1], rtol=1e-9, atol=1e-12)


def test_a_weight_with_its_sign_turned_is_one_half_a_turn_away():
    border = find("gravity").border
    assert border.parameters["mgl"].at(-0.3).value == -0.3
    turned, plain = (border.inward({"mgl": m, "phase": p}) for m, p in ((-0.3, 0.7), (0.3, 0.7 - pi)))
    assert turned == pytest.approx(plain) and border.outward(turned)["mgl"] == pytest.approx(0.3)
