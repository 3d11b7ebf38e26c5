"""Other laws of a class, parts of a composite, and starts at a resonance."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record, Source
from workbench.tracing import free_law, greedy, otherwise, ranking, tracing
from workbench.tracing.candidates import WHOLE, Offer
from workbench.tracing.evidence import CORRECTION
from workbench.tracing.judge import STANDARD
from workbench.tracing.spellings import spellings_of
from workbench.tracing.starts import resonances
from workbench.tracing.state import State
from workbench.tracing.tracing import trace

SOURCE = Source(Path("made"), "", "made", {})
COUNT, DT = 1e-6, 1e-3
PLANT = Plant(ONE_MASS) + find("inertia")(inertia=0.01) + find("viscous_friction") + find("coulomb_friction")


def recorded(name: str, role: str, speed: float, force, seconds: float = 12.0, over=lambda q: 0.0 * q) -> Record:
    """A record of slow and fast sines, up to about `speed`, whose drive is inertia, friction, force(v) and over(q), with noise."""
    t = DT * np.arange(round(seconds / DT))
    waves = [(0.6 * speed, 2.1), (0.3 * speed, 7.3), (0.1 * speed, 23.0)]
    q = sum(s / w * np.sin(w * t + k) for k, (s, w) in enumerate(waves))
    v = sum(s * np.cos(w * t + k) for k, (s, w) in enumerate(waves))
    a = sum(-s * w * np.sin(w * t + k) for k, (s, w) in enumerate(waves))
    rng = np.random.default_rng(len(name))
    drive = 0.01 * a + 0.02 * v + 0.3 * np.sign(v) + force(v) + over(q) + 0.01 * rng.normal(size=t.size)
    read = COUNT * np.round(q / COUNT)
    channels = {"torque": drive, "position": read, "reference": q}
    return Record(name, role, t, channels, {}, SOURCE, {"position": COUNT})


def test_friction_that_levels_off_is_carried_to_speeds_that_were_not_fitted():
    """-v|v| bends as it does where it was fitted and turns to a drive beyond; a power of speed goes on."""
    levels = lambda v: 0.5 * np.sign(v) * np.abs(v) ** 0.5  # noqa: E731
    records = [recorded(n, r, s, levels, 6.0) for n, r, s in (("a", IDENTIFICATION, 1.0), ("bb", VALIDATION, 2.5))]
    found = trace(PLANT, inverse_dynamics(records, 50.0))
    cause = found.causes[0]
    assert (found.verdict, cause.effect, cause.form) == ("cause", "nonlinear_viscous_friction", "power_law_friction")
    assert "Its law is that of power law friction" in cause.sentence and cause.share_validation > 0.9
    assert {e.parameter: e.value for e in cause.parameters}["exponent"] == pytest.approx(0.5, abs=0.1)


def test_a_weight_that_is_a_spring_over_the_stroke_that_was_fitted_is_named_by_a_longer_one():
    """Beside a constant force a spring says as much with one value less; validation, four times as long, carries it, and a weight far better."""
    over = lambda q: 0.1 + 0.3 * np.sin(q - 0.35)  # noqa: E731
    still = lambda v: 0.0 * v  # noqa: E731
    fitted, longer = (
        recorded("a", IDENTIFICATION, 0.5, still, 6.0, over),
        recorded("bb", VALIDATION, 2.5, still, 6.0, over),
    )
    plant, only = PLANT + find("constant_offset"), {"gravity", "cable_spring"}
    assert trace(plant, inverse_dynamics([fitted], 50.0), only=only).causes[0].effect == "linear_stiffness"
    found = trace(plant, inverse_dynamics([fitted, longer], 50.0), only=only)
    assert [c.effect for c in found.causes] == ["gravity"] and found.extended.validation < 0.03


def test_a_spring_and_a_cogging_are_two_effects_though_one_curve_over_place_takes_both(monkeypatch):
    over = lambda q: 0.12 * np.sin(40.0 * q + 0.4) + 0.03 * np.sin(80.0 * q) + 0.4 * (q - 0.05)  # noqa: E731
    records = [recorded(n, IDENTIFICATION, s, lambda v: 0.0 * v, over=over) for n, s in (("a", 1.0), ("bb", 0.7))]
    state = State(PLANT, inverse_dynamics(records, 50.0))
    judgements = ranking.step(state, lambda _: None, Offer(only={"cogging", "cable_spring"}))
    best = judgements[0]
    assert (best.candidate.effect, free_law.free_law(state, judgements, best, [], STANDARD)) == ("cogging", None)
    monkeypatch.setattr(free_law, "two_say_it", lambda *_: False)
    curve = free_law.free_law(state, judgements, best, [], STANDARD)
    assert (curve.candidate.effect, curve.candidate.name) == ("force_over_position", "cogging")


def test_a_wrong_weight_and_a_cogging_are_two_though_one_curve_over_place_takes_both(monkeypatch):
    """A data sheet's value that is wrong is no law more: a curve of two dozen knots does not take its place."""
    over = lambda q: 0.62 * np.sin(q + 0.35) + 0.05 * np.sin(9.0 * q + 0.4)  # noqa: E731
    records = [recorded(n, IDENTIFICATION, s, lambda v: 0.0 * v, over=over) for n, s in (("a", 4.0), ("bb", 2.5))]
    plant = PLANT + find("gravity")(cosine=0.55 * np.sin(0.35), sine=0.55 * np.cos(0.35), fixed=True)
    state = State(plant, inverse_dynamics(records, 50.0))
    judgements = ranking.step(state, lambda _: None, Offer(only={"cogging", "cable_spring", "gravity"}))
    best = judgements[0]
    assert (best.candidate.key, best.candidate.kind) == ("gravity@axis", CORRECTION)
    assert free_law.free_law(state, judgements, best, [], STANDARD) is None
    monkeypatch.setattr(free_law, "two_say_it", lambda *_: False)
    assert free_law.free_law(state, judgements, best, [], STANDARD).candidate.effect == "force_over_position"


def test_stribecks_friction_and_an_asymmetry_are_two_effects_though_one_curve_over_speed_takes_both(monkeypatch):
    """The one is the same in both directions, the other is the difference between them."""
    force = lambda v: 0.3 * np.exp(-np.abs(v / 0.1)) * np.sign(v) + 0.08 + 0.1 * np.abs(v)  # noqa: E731
    records = [recorded(n, IDENTIFICATION, s, force) for n, s in (("a", 1.0), ("bb", 0.4))]
    state = State(PLANT, inverse_dynamics(records, 50.0))
    judgements = ranking.step(state, lambda _: None, Offer(only={"coulomb_asymmetry", "stribeck_friction"}))
    best = judgements[0]
    assert best.candidate.effect in ("coulomb_asymmetry", "stribeck_friction")
    assert free_law.free_law(state, judgements, best, [], STANDARD) is None
    monkeypatch.setattr(free_law, "two_say_it", lambda *_: False)
    assert free_law.free_law(state, judgements, best, [], STANDARD).candidate.effect == "friction_over_speed"


def test_an_asymmetry_and_a_square_of_speed_are_two_effects_whatever_leads(monkeypatch):
    """Something else led before a syringe pump's asymmetry, which with a square of speed is the whole curve."""
    force = lambda v: 0.15 + 0.15 * np.abs(v) + 2.0 * v * np.abs(v)  # noqa: E731
    records = [recorded(n, IDENTIFICATION, s, force) for n, s in (("a", 1.0), ("bb", 0.4))]
    state = State(PLANT, inverse_dynamics(records, 50.0))
    offer = Offer(only={"coulomb_asymmetry", "nonlinear_viscous_friction", "constant_offset"})
    judgements = ranking.step(state, lambda _: None, offer)
    other = next(j for j in judgements if j.candidate.effect == "constant_offset")
    led = free_law.free_law(state, judgements, other, [], STANDARD)
    assert (led.candidate.effect, led.candidate.stands) == ("coulomb_asymmetry", "")
    monkeypatch.setattr(free_law, "two_say_it", lambda *_: False)
    assert free_law.free_law(state, judgements, other, [], STANDARD).candidate.effect == "friction_over_speed"


@pytest.mark.parametrize("beside", ["nonlinear_viscous_friction", "cogging"])
def test_the_curve_of_a_class_takes_no_formula_s_place_beside_another_of_its_class(monkeypatch, beside):
    here = {c.effect: c for c in WHOLE.candidates(PLANT)}
    j, k = (SimpleNamespace(candidate=here[n]) for n in ("coulomb_asymmetry", beside))
    last = SimpleNamespace(plant=here["coulomb_asymmetry"].plant)
    choice = SimpleNamespace(
        offer=Offer(), less=lambda *_: last, judged=lambda *_: [], confirmed=SimpleNamespace(added=[j, k]),
        selected=SimpleNamespace(answer=SimpleNamespace(last=last)),
    )  # fmt: skip
    monkeypatch.setattr(otherwise, "_curves", lambda *_: ["curve"])
    monkeypatch.setattr(otherwise, "_fitted", lambda state, found, *_: found)
    monkeypatch.setattr(otherwise, "absurd", lambda *_: False)
    assert otherwise._laws(choice, j) == ([] if beside == "nonlinear_viscous_friction" else ["curve"])


def test_a_composite_bears_the_name_of_the_part_that_is_missing():
    named = {s.effect: s.name for s in WHOLE.candidates(PLANT) if s.instead}
    assert named["friction_behind_gap"] == "backlash"  # the friction is declared
    assert named["lugre_friction"] == "lugre_friction"  # of its parts either may be what Coulomb friction lacks
    bare = Plant(ONE_MASS) + find("inertia")(inertia=0.01)
    assert {s.effect: s.name for s in WHOLE.candidates(bare)}["friction_behind_gap"] == "friction_behind_gap"


def test_friction_over_a_root_of_speed_is_no_two_laws(monkeypatch):
    """-v|v| and a peak at low speed say together what one power of speed says, where no free form has said it."""
    monkeypatch.setattr(greedy, "free_law", lambda *_: None)
    root = lambda v: 0.8 * np.sign(v) * np.abs(v) ** 0.45  # noqa: E731
    records = [recorded(n, r, 1.0, root) for n, r in (("a", IDENTIFICATION), ("bb", VALIDATION))]
    found = trace(PLANT, inverse_dynamics(records, 50.0), only=("nonlinear_viscous_friction", "stribeck_friction"))
    assert found.added == ("nonlinear_viscous_friction",)
    assert found.causes[0].form == "power_law_friction" and found.after.validation < 0.05


@pytest.mark.parametrize("exponent", [0.6, 0.85, 0.9], ids=["at once", "after it", "in place of two"])
def test_viscous_friction_that_is_not_quite_in_proportion_to_speed_is_viscous_friction(exponent):
    """None is declared, and the one that is there goes with a power of speed: whichever way the search comes to it, its name is the same."""
    plant = Plant(ONE_MASS) + find("inertia")(inertia=0.01) + find("coulomb_friction")
    power = lambda v: 0.8 * np.sign(v) * np.abs(v) ** exponent - 0.02 * v  # noqa: E731
    records = [recorded(n, r, 1.0, power, 6.0) for n, r in (("a", IDENTIFICATION), ("bb", VALIDATION))]
    names = ("viscous_friction", "nonlinear_viscous_friction", "stribeck_friction")
    found = trace(plant, inverse_dynamics(records, 50.0), only=names)
    assert found.added == ("viscous_friction",) and found.ranked[0].effect == "viscous_friction"
    assert found.causes[0].form == "power_law_friction" and found.after.validation < 0.05


def test_a_lesser_curve_that_validation_does_not_carry_gives_way_and_a_lesser_formula_stays():
    """A curve over speed goes astray beyond the speeds that were fitted; in a formula's place it would take what is left of the greatest."""
    here = {c.effect: c for c in WHOLE.candidates(PLANT)}
    cogging, curve, spring = (
        SimpleNamespace(candidate=c)
        for c in (here["cogging"], replace(here["stribeck_friction"], stands="stribeck_friction"), here["cable_spring"])
    )
    weighed = [SimpleNamespace(effect=n) for n in ("cogging", "stribeck_friction", "cable_spring")]
    confirmed = SimpleNamespace(added=[cogging, curve, spring], weighed=weighed)
    choice = SimpleNamespace(largest=(cogging, weighed[0]), confirmed=confirmed)
    assert [j for j, _ in otherwise._that_may_give_way(choice)] == [cogging, curve]
    assert otherwise._that_may_give_way(SimpleNamespace(largest=None, confirmed=confirmed)) == []


def limited(name: str, role: str, seconds: float, scale: float) -> Record:
    """A record of heavy motion whose drive gives a quarter of what it is asked for beyond a knee."""
    t = DT * np.arange(round(seconds / DT))
    waves = [(0.6 * scale, 3.1, 0.5), (0.5 * scale, 9.0, 1.0), (0.3 * scale, 23.0, 2.0)]
    q = sum(s / w * np.sin(w * t + k * len(name)) for s, w, k in waves)
    v = sum(s * np.cos(w * t + k * len(name)) for s, w, k in waves)
    a = sum(-s * w * np.sin(w * t + k * len(name)) for s, w, k in waves)
    acts = 0.01 * a + 0.02 * v + 0.03 * np.sign(v)
    asked = np.sign(acts) * (np.abs(acts) + 3.0 * np.maximum(np.abs(acts) - 0.095, 0.0))
    drive = asked + 0.002 * np.random.default_rng(len(name)).normal(size=t.size)
    channels = {"torque": drive, "position": COUNT * np.round(q / COUNT), "reference": q}
    return Record(name, role, t, channels, {}, SOURCE, {"position": COUNT})


def test_what_a_formula_leaves_of_its_law_is_taken_by_the_curve_of_its_class(monkeypatch):
    """A drive with a knee saturates by no power of the command: the formula names it and leaves a tenth."""
    rows = (("a", IDENTIFICATION, 8.0, 1.0), ("bb", IDENTIFICATION, 8.0, 0.7), ("ccc", VALIDATION, 6.0, 0.9))
    inverses = inverse_dynamics([limited(*row) for row in rows], 50.0)
    plant = PLANT.swap(find("inertia")(inertia=0.01, fixed=True))
    curve = trace(plant, inverses)
    monkeypatch.setattr(tracing, "as_a_curve", lambda choice: choice)
    formula = trace(plant, inverses)
    named = [[(c.effect, c.form) for c in found.causes] for found in (curve, formula)]
    assert named == [[("torque_constant_saturation", "drive_over_command")], [("torque_constant_saturation", "")]]
    assert curve.extended.validation < 0.07 < 0.1 < formula.extended.validation


def test_a_curve_over_place_beside_a_spring_that_is_declared_is_that_ones_stiffness():
    """A bumper that yields little by little; where none is declared, what pulls from one side is a cable."""
    records = [recorded("a", IDENTIFICATION, 1.0, lambda v: 0.0 * v, 2.0)]
    for spring, name in (
        (find("linear_stiffness")(at="axis", stiffness=1.0), "piecewise_stiffness"),
        (None, "cable_spring"),
    ):
        state = State(PLANT + spring if spring else PLANT, inverse_dynamics(records, 50.0))
        assert free_law._nearest("force over position", "axis", state) == name
        assert free_law._nearest("friction over position", "axis", state) == ""


def test_a_body_on_a_spring_may_be_counted_in_a_mass_from_a_data_sheet():
    free = WHOLE.candidates(PLANT)
    held = WHOLE.candidates(PLANT.swap(find("inertia")(inertia=0.01, fixed=True)))
    assert "flexible_part" not in {s.effect for s in free}
    assert {s.name for s in held if s.effect == "flexible_part"} == {"flexible_mode"}


def test_a_sharp_resonance_is_where_a_search_starts():
    """A part that swings at 38 Hz, damped by 2 %: none of the six even values of the band is near it."""
    frequency, t = 38.0, DT * np.arange(20_000)
    rng = np.random.default_rng(1)
    a = lfilter(*(np.ones(4) / 4, [1.0]), rng.normal(size=t.size))
    q = DT**2 * np.cumsum(np.cumsum(a))
    q -= np.polyval(np.polyfit(t, q, 5), t)
    record = Record("made", IDENTIFICATION, t, {"position": q, "torque": a.copy()}, {}, SOURCE, {"position": 1e-9})
    (seen,) = inverse_dynamics([record], 60.0)
    w = 2.0 * np.pi * frequency * DT
    swings = lfilter([1.0], [1.0, -2.0 * np.cos(w) * np.exp(-0.02 * w), np.exp(-0.04 * w)], seen.motion.a)
    first = resonances((seen,), (swings,))[0]
    assert first == pytest.approx(frequency, abs=1.0)


def test_a_law_that_goes_astray_from_block_to_block_gives_way_to_one_of_its_class_that_does_not():
    """-v|v| of slow blocks is wrong at fast ones, by how much is a matter of the blocks; a power of speed is right at all of them."""
    root = lambda v: 0.5 * np.sign(v) * np.abs(v) ** 0.5  # noqa: E731
    state = State(
        PLANT, inverse_dynamics([recorded(n, IDENTIFICATION, s, root, 6.0) for n, s in (("a", 0.4), ("bb", 2.0))], 50.0)
    )
    judgements = ranking.step(state, lambda _: None, Offer(only={"nonlinear_viscous_friction"}))
    first = replace(judgements[0], score=replace(judgements[0].score, earns=False))
    steady = free_law.steadier(state, [first], STANDARD)
    assert (steady.candidate.effect, steady.candidate.name) == ("power_law_friction", "nonlinear_viscous_friction")
    assert steady.score.earns and steady.errors.total < 0.3 * first.errors.total
    assert steady.state is not None
    little = replace(first, score=replace(first.score, gain=STANDARD.plain))
    assert [free_law.steadier(state, js, STANDARD) for js in ([], judgements, [little])] == [None, None, None]


def test_a_weight_beside_a_cable_is_asked_whether_it_is_what_a_cable_stiffens_by():
    """The larger of two laws of one class need have no other spelling: the lesser one's is asked in the place of both."""
    plant = PLANT + find("gravity") + find("cable_spring")
    here = {c.effect: c for c in WHOLE.candidates(PLANT)}
    added = [SimpleNamespace(candidate=here[n]) for n in ("gravity", "cable_spring")]
    weighed = [SimpleNamespace(size=lambda _, s=s: s) for s in (0.08, 0.02)]
    larger, lesser = added
    assert otherwise._of_one_class(SimpleNamespace(added=added, weighed=weighed)) == (lesser, larger)
    assert "hardening_cable" in {e.name for e in spellings_of(lesser.candidate)}
    hardens = lambda q: 0.8 * (q - 0.1) + 12.0 * (q - 0.1) ** 3  # noqa: E731
    records = [
        recorded(n, r, s, lambda v: 0.0 * v, over=hardens)
        for n, r, s in (("a", IDENTIFICATION, 1.0), ("bb", VALIDATION, 0.8))
    ]
    inverses = inverse_dynamics(records, 50.0)
    alone = identify(PLANT + find("hardening_cable")(rest=0.05), inverses)
    assert alone.validation < 1.02 * identify(plant, inverses).validation
    rest = alone.plant["hardening_cable@axis"].parameters
    assert (rest["rest"].value, rest["cubic"].value) == (pytest.approx(0.1, abs=0.01), pytest.approx(12.0, rel=0.05))


@pytest.mark.parametrize("absurd", [False, True])
def test_a_law_with_values_that_no_machine_has_takes_no_two_others_place(monkeypatch, absurd):
    here = {c.effect: c for c in WHOLE.candidates(PLANT)}
    two = [SimpleNamespace(candidate=here[n]) for n in ("cable_spring", "gravity")]
    last = SimpleNamespace(plant={two[0].candidate.key: find("cable_spring")})
    selected = SimpleNamespace(answer=SimpleNamespace(last=last))
    choice = SimpleNamespace(
        offer=Offer(), selected=selected, less=lambda *_: object(), judged=lambda *_: [], criteria=STANDARD
    )
    monkeypatch.setattr(otherwise, "absurd", lambda j, state: absurd)
    monkeypatch.setattr(otherwise, "_fitted", lambda *_: ["one law"])
    assert otherwise._laws(choice, *two) == ([] if absurd else ["one law"])
