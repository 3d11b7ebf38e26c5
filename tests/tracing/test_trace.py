"""The trace, on campaigns of a rig that shares no code with the workbench: right causes, no false ones, "unknown" said."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import rig

from workbench.campaign import Campaign, load
from workbench.definition import find
from workbench.identification.cross_validation import HeldOut, gain
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, TWO_MASS, Plant
from workbench.tracing import full_rate
from workbench.tracing.candidates import WHOLE
from workbench.tracing.full_rate import is_confirmed
from workbench.tracing.output import as_dict, write
from workbench.tracing.result import CAUSE, NOTHING, UNKNOWN, Trace
from workbench.tracing.tracing import trace

# What is missing, and the seed of its rig: axis, motions, noise and the effect's shape all differ.
CAUSES = {
    "stribeck_friction": 101,
    "cogging": 102,
    "transport_delay": 103,
    "inertia": 104,
    "coulomb_asymmetry": 105,
    "nonlinear_viscous_friction": 106,
    "constant_offset": 107,
    "cable_spring": 108,
    "gravity": 109,
    "actuator_lag": 110,
}
ALONE = ("stribeck_friction", "cable_spring")


def traced(campaign: Campaign, **options) -> Trace:
    return trace(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth), **options)


# A handful of candidates, where it is not the choice among all that is tested
FEW = {"constant_offset", "coulomb_asymmetry", "gravity", "inertia", "stribeck_friction", "transport_delay"}


def made(folder, seed: int, *missing: str, size: float = 2.0, **options) -> tuple[Campaign, dict]:
    truth = rig.campaign(folder, seed, missing, size, short=True, **options)
    return load(folder), truth


# --- the rig ------------------------------------------------------------------------------------------------------------


def test_friction_of_the_rig_is_the_virgin_curve_and_its_double():
    out = np.linspace(0.0, 3e-3, 301)
    back = np.linspace(3e-3, -4e-3, 701)[1:]
    force = rig.masing(np.concatenate([out, back]), 650.0)
    np.testing.assert_allclose(force[:301], -np.expm1(-650.0 * out), atol=1e-12)
    top = force[300]
    inner = back >= -3e-3
    np.testing.assert_allclose(force[301:][inner], top - 2 * -np.expm1(-650.0 * (3e-3 - back[inner]) / 2), atol=1e-12)
    np.testing.assert_allclose(
        force[301:][~inner], np.expm1(650.0 * back[~inner]), atol=1e-12
    )  # the virgin curve again


def test_the_rig_repeats_itself_and_differs_by_seed(tmp_path):
    once = rig.campaign(tmp_path / "a", 5, ("cogging",), short=True)
    again = rig.campaign(tmp_path / "b", 5, ("cogging",), short=True)
    other = rig.campaign(tmp_path / "c", 6, ("cogging",), short=True)
    assert once == again != other
    for file in (tmp_path / "a").iterdir():
        assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes()


@pytest.mark.parametrize("size", [0.5, 2.0])
def test_an_effect_of_the_rig_is_as_large_as_asked(tmp_path, size):
    """What is left by the declared model is noise and effect, size * LEVEL times the noise, in squares."""
    campaign, truth = made(tmp_path, 7, "stribeck_friction", size=size)
    left = (
        identify(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth)).identification
        / truth["floor"]["identification"]
    )
    assert left == pytest.approx(np.hypot(1.0, size * rig.LEVEL), rel=0.15)


# --- causes -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CAUSES)
def test_the_missing_effect_is_named_first_and_alone(tmp_path, name):
    campaign, truth = made(tmp_path, CAUSES[name], name)
    found = traced(campaign, most=2 if name in ALONE else 1)  # a second round finds nothing more to add
    assert found.verdict == CAUSE
    assert found.ranked[0].effect == name
    assert found.added == (name,)
    assert found.after.identification < 1.15 * truth["floor"]["identification"]
    assert found.after.validation < 1.2 * truth["floor"]["validation"]
    cause = found.causes[0]
    assert cause.share_identification > 0.9
    assert found.sentence.endswith(".") and cause.sentence.endswith(".")
    assert ("declared with a wrong value" in cause.sentence) == (name == "inertia")


@pytest.mark.parametrize(
    ("name", "parameter", "within"), [("transport_delay", "delay", 0.05), ("stribeck_friction", "drop", 0.1)]
)
def test_the_parameters_of_a_cause_are_those_of_the_rig(tmp_path, name, parameter, within):
    campaign, truth = made(tmp_path, 111, name)
    found = traced(campaign, most=1, only=FEW)
    estimate = next(e for e in found.causes[0].parameters if e.parameter == parameter)
    assert estimate.value == pytest.approx(truth["parameters"][name][parameter], rel=within)
    assert estimate.low < estimate.value < estimate.high


@pytest.mark.parametrize("seed", [201, 202])
def test_nothing_is_added_where_nothing_is_missing(tmp_path, seed):
    campaign, truth = made(tmp_path, seed)
    found = traced(campaign)
    assert found.verdict == NOTHING and found.added == () and found.causes == ()
    assert not any(c.earns for c in found.ranked)
    assert found.sentence.startswith("Nothing is missing")
    for role in rig.ROLES:  # the stated floor is that of the noise which the rig has put in
        assert found.floor[role] == pytest.approx(truth["floor"][role], rel=0.15)


@pytest.mark.parametrize(("name", "seed"), [("window_friction", 5), ("slip_moments", 6)])
def test_a_cause_outside_the_catalogue_is_unknown(tmp_path, name, seed):
    campaign, truth = made(tmp_path, seed, name)
    assert truth["missing"] == ["unknown"]
    found = traced(campaign)
    assert found.verdict == UNKNOWN and found.added == ()
    assert "no effect of the catalogue explains" in found.sentence
    coordinate, spans = truth["where"]
    assert found.unknown["coordinate"] == coordinate and found.unknown["share"] > 0.8
    if coordinate == "position":
        tenth = 0.1 * max(np.ptp(r.channels["position"]) for r in campaign.records if r.role == "identification")
        assert (found.unknown["low"], found.unknown["high"]) == pytest.approx(spans[0], abs=tenth)
        assert found.unknown["direction"] == "forward"
    else:
        said = found.unknown["spans"]
        moments = [0.5 * (low + high) for low, high in spans]
        during = [
            m
            for m in moments
            if any(r.time[0] < m < r.time[-1] for r in campaign.records if r.role == "identification")
        ]
        assert np.mean([any(low - 0.02 < m < high + 0.02 for low, high in said) for m in during]) > 0.9
        assert np.sum(np.diff(said)) < 2.0 * np.sum(np.diff(spans))


# --- the same answer, however it is asked ---------------------------------------------------------------------------------


def answer(found: Trace) -> dict:
    """All that trace.json would say, apart from the order in which the declared model is listed."""
    said = as_dict(found, {})
    return said | {"model": sorted(said["model"], key=lambda e: (e["effect"], e["parameter"]))}


def test_neither_the_order_of_effects_nor_that_of_records_matters(tmp_path):
    campaign, _ = made(tmp_path, 112, "gravity")
    backwards = replace(
        campaign, plant=replace(campaign.plant, effects=campaign.plant.effects[::-1]), records=campaign.records[::-1]
    )
    assert answer(traced(campaign, most=1, only=FEW)) == answer(traced(backwards, most=1, only=FEW))


def test_validation_chooses_no_effect_but_says_whether_one_is_borne_out(tmp_path):
    campaign, _ = made(tmp_path, 113, "coulomb_asymmetry")
    spoilt = [
        replace(r, channels={**r.channels, "torque": r.drive[::-1] * 2.0}) if r.role == "validation" else r
        for r in campaign.records
    ]
    one, two = traced(campaign, most=1, only=FEW), traced(replace(campaign, records=tuple(spoilt)), most=1, only=FEW)
    assert one.steps == two.steps and one.added == ("coulomb_asymmetry",)
    assert two.added == () and {f.kind for f in two.findings} & {"not borne out", "dressing"}
    assert one.before.identification == two.before.identification


# --- parts ----------------------------------------------------------------------------------------------------------------


def test_candidates_are_what_is_not_declared_and_what_is_held():
    plant = Plant("one mass") + find("inertia")(inertia=2e-3, fixed=True) + find("viscous_friction")
    kinds = {s.key: s.kind for s in WHOLE.candidates(plant)}
    assert kinds["inertia@axis"] == "correction" and "viscous_friction@axis" not in kinds
    assert kinds["stribeck_friction@axis"] == "addition" and "linear_stiffness@joint" not in kinds
    keys = [s.key for s in WHOLE.candidates(plant)]
    assert keys == [s.key for s in WHOLE.candidates(replace(plant, effects=plant.effects[::-1]))]
    free = plant.swap(find("inertia")(inertia=2e-3, fixed=False))
    assert "inertia@axis" not in [s.key for s in WHOLE.candidates(free)]
    assert "gravity@axis" not in [s.key for s in WHOLE.candidates(replace(free, rotary=False))]


def test_a_gain_in_proportion_has_no_scatter():
    before = np.array([1.0, 2.0, 4.0, 8.0])
    g, scatter = gain(HeldOut(before), HeldOut(0.25 * before))
    assert g == 0.75 and scatter == pytest.approx(0.0, abs=1e-15)
    g, scatter = gain(HeldOut(np.ones(4)), HeldOut(np.array([0.0, 0.0, 1.0, 1.0])))
    assert g == 0.5 and scatter == pytest.approx(np.sqrt(4 / 3 * 4 * 0.25) / 4)
    assert gain(HeldOut(np.ones(1)), HeldOut(np.zeros(1))) == (1.0, float("inf"))


def test_a_trace_is_written_as_it_says(tmp_path):
    campaign, _ = made(tmp_path / "campaign", 114, "constant_offset")
    found = traced(campaign, most=1, only=FEW)
    out = tmp_path / "out"
    out.mkdir()
    write(found, out)
    said = json.loads((out / "trace.json").read_text())
    assert said["verdict"] == "cause" and said["added"] == ["constant_offset"] == said["ranked"][:1]
    assert said["causes"][0]["parameters"]["offset"]["unit"] == "N*m"
    assert set(said["predictions"]) == {r.name for r in campaign.records}
    for record in campaign.records:
        rows = np.loadtxt(out / said["predictions"][record.name], delimiter=",", skiprows=1)
        np.testing.assert_allclose(rows[:, 0], record.time, atol=1e-6)
        np.testing.assert_allclose(rows[:, 1], found.after.predictions[record.name], rtol=1e-7, atol=1e-9)


def test_a_candidate_without_a_value_on_the_records_is_ranked_and_harms_nothing(tmp_path, monkeypatch):
    """A law outside its domain gives NaN; the trace says so and goes on."""
    import casadi as ca

    from workbench.tracing import candidates, ranking
    from workbench.tracing.state import State

    rig.campaign(tmp_path, 5, missing=("stribeck_friction",), short=True)
    campaign = load(tmp_path)
    real = find("stribeck_friction")

    def step(s, z, p):
        return {}, p.drop * ca.sqrt(-1.0 - s.v * s.v) * s.dir

    broken = replace(real, name="broken_friction", step=step)
    monkeypatch.setattr(candidates, "catalogue", lambda: {"broken_friction": broken, "stribeck_friction": real})
    judgements = ranking.step(
        State(campaign.plant, inverse_dynamics(campaign.records[:1], campaign.bandwidth)), lambda _: None
    )
    found = {j.score.effect: j.score for j in judgements}
    assert found["broken_friction"].gain == 0.0 and "no value" in found["broken_friction"].sentence
    best = judgements[0]
    assert best.score.effect == "stribeck_friction" and best.score.earns and best.state is not None


def test_the_package_is_called_with_a_fit(tmp_path):
    import workbench

    campaign, _ = made(tmp_path, 111, "transport_delay")
    found = workbench.trace(workbench.identify(campaign), most=1, only=FEW)
    assert found.verdict == CAUSE and found.added == ("transport_delay",)


@pytest.mark.parametrize(
    ("kind", "error", "cost", "borne"),
    [
        (ONE_MASS, 0.19, 1.0, True),
        (ONE_MASS, 0.21, 0.1, False),  # the drive itself has the last word
        (TWO_MASS, 0.19, 1.0, True),
        (TWO_MASS, 0.205, 0.9, True),  # it shows in the load's balance
        (TWO_MASS, 0.205, 0.99, False),
        (TWO_MASS, 0.22, 0.5, False),
    ],
)
def test_whole_records_bear_an_effect_out_by_the_drive_or_of_two_masses_by_both_balances(kind, error, cost, borne):
    def fit(identification, cost):
        return SimpleNamespace(plant=SimpleNamespace(kind=kind), identification=identification, details={"cost": cost})

    assert is_confirmed(fit(0.2, 1.0), fit(error, cost)) == borne


def test_starts_of_a_fit_are_searched_only_where_the_one_before_them_is_not_enough(monkeypatch):
    """The first has its end from the search; the two others, of which none is known, are searched together."""
    searched = []
    monkeypatch.setattr(full_rate, "_end", lambda plant, whole: searched.append(plant) or f"end of {plant}")
    monkeypatch.setattr(full_rate, "shared", lambda f, items: map(f, items))
    ends = full_rate._ended([("a", "known"), ("b", None), ("c", None)], [])
    assert (next(ends), searched) == (("a", "known"), [])
    assert list(ends) == [("b", "end of b"), ("c", "end of c")]
    assert searched == ["b", "c"]
