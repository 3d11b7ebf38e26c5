"""What each record says by itself: its spread, and findings where records disagree or do not excite a parameter."""

import numpy as np
import pytest
from test_identify import BAND, H0, B, J, believed, coloured, estimate, moved, recorded, smooth, torque

from workbench.definition import find
from workbench.identification.by_record import own_estimates
from workbench.identification.fit import identify
from workbench.identification.problem import Problem
from workbench.identification.solve import solve
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import Plant
from workbench.study import results

VISCOUS = "viscous_friction@axis.viscous"


def kinds(fit, kind: str) -> dict:
    return {f.subject: f for f in fit.findings if f.kind == kind}


def records(viscous: tuple[float, ...], noise: float = 0.02, seed: int = 3) -> list:
    """Records of a smooth axis, each with its own viscous friction, under coloured noise."""
    rng, made = np.random.default_rng(seed), []
    for k, b in enumerate(viscous):
        t, q, v, a = moved(k + 40)
        made.append(recorded(t, q, J * a + b * v + 0.02 + coloured(rng, t.size, noise), f"r{k}"))
    return made


def test_the_spread_is_that_of_fits_to_each_record():
    """A plant without shape parameters: the own estimate is the fit of that record, to rounding."""
    made = records((B, 1.2 * B, 0.9 * B))
    fit = identify(smooth(), inverse_dynamics(made, BAND))
    alone = [identify(smooth(), inverse_dynamics([r], BAND)) for r in made]
    assert set(fit.spread) == {"inertia@axis.inertia", VISCOUS, "constant_offset@axis.offset"}
    for name, (low, high) in fit.spread.items():
        values = [estimate(f, name.split(".")[1]).value for f in alone]
        assert (low, high) == pytest.approx((min(values), max(values)), rel=1e-6)
    assert alone[0].spread == {}
    assert results.model(fit)["by_record"] == {n: list(ends) for n, ends in fit.spread.items()}


def test_the_spread_holds_the_truth_with_friction_of_memory():
    made = []
    for k in (1, 2, 3):
        t, q, v, a = moved(k)
        made.append(recorded(t, q, torque(q, v, a) + coloured(np.random.default_rng(k), t.size, 0.02), f"r{k}"))
    fit = identify(believed(), inverse_dynamics(made, BAND))
    low, high = fit.spread["presliding_hysteresis@axis.h0"]
    assert low < estimate(fit, "h0").value < high and low == pytest.approx(H0, rel=0.1) == high
    assert not kinds(fit, "records disagree") and not kinds(fit, "excitation missing")


def test_records_that_differ_are_said_to():
    found = kinds(identify(smooth(), inverse_dynamics(records((B, 1.5 * B, B)), BAND)), "records disagree")
    assert list(found) == [VISCOUS]
    finding = found[VISCOUS]
    assert "'r1'" in finding.sentence and finding.evidence["times_allowed"] > 1.0 and finding.remedy
    assert finding.evidence["highest"] == pytest.approx(1.5 * B, rel=0.1)


def test_records_that_agree_are_seldom_said_to_differ():
    """At most one in twenty fits, by the bound on the pairs; 20 fits of three records."""
    said = [
        kinds(identify(smooth(), inverse_dynamics(records((B,) * 3, seed=k), BAND)), "records disagree")
        for k in range(20)
    ]
    assert sum(map(bool, said)) <= 2


def test_differences_too_small_to_matter_are_not_said():
    """Of 2 %, and sure: almost no noise."""
    fit = identify(smooth(), inverse_dynamics(records((B, 1.02 * B), noise=1e-5), BAND))
    assert fit.spread[VISCOUS] == pytest.approx((B, 1.02 * B), rel=5e-3)
    assert not kinds(fit, "records disagree")


def test_a_record_that_knows_next_to_nothing_has_no_say():
    """One record at constant speed beside one that moves: its inertia would be anything."""
    t, q, v, a = moved(50)
    rng = np.random.default_rng(5)
    steady = recorded(t, 2.0 * t, 2.0 * B + 0.02 + coloured(rng, t.size, 0.02), "steady")
    moving = recorded(t, q, J * a + B * v + 0.02 + coloured(rng, t.size, 0.02), "moving")
    inverses = inverse_dynamics([steady, moving], BAND)
    fit = identify(smooth(), inverses)
    assert "inertia@axis.inertia" not in fit.spread
    problem = Problem(smooth(), inverses)
    owns = {o.record: o for o in own_estimates(problem, solve(problem), problem.free_linear)}
    j = [n.parameter for n in problem.free_linear].index("inertia")
    assert np.isnan(owns["steady"].value[j]) and owns["moving"].value[j] == pytest.approx(J, rel=0.05)


def test_without_acceleration_inertia_is_said_to_lack_excitation():
    rng, t = np.random.default_rng(9), moved(1)[0]
    made = [recorded(t, s * t, B * s + 0.02 + 0.002 * rng.normal(size=t.size), f"r{s}") for s in (1.0, -2.0, 3.0)]
    found = kinds(identify(smooth(), inverse_dynamics(made, BAND)), "excitation missing")
    assert list(found) == ["inertia@axis.inertia"]
    assert "acceleration" in found["inertia@axis.inertia"].remedy


@pytest.mark.parametrize(("speeds", "lacking"), [((1.0, 2.0), {"h0", "x0"}), ((1.0, -2.0), {"x0"})])
def test_without_reversals_friction_with_memory_is_said_to_lack_excitation(speeds, lacking):
    """Both ways in separate records give its height, but only a reversal within one shows how it gets there."""
    rng, t = np.random.default_rng(9), moved(1)[0]
    made = []
    for k, s in enumerate(speeds):
        v = s * (1 + 0.5 * np.sin(3 * t + k))
        q = s * (t - 0.5 * (np.cos(3 * t + k) - np.cos(k)) / 3)
        a = s * 1.5 * np.cos(3 * t + k)
        u = J * a + B * v + H0 * np.sign(s) + 0.002 * rng.normal(size=t.size)
        made.append(recorded(t, q, u, f"r{k}"))
    found = kinds(identify(believed(), inverse_dynamics(made, BAND)), "excitation missing")
    assert {s.split(".")[1] for s in found} == lacking
    assert all("reverses" in f.remedy for f in found.values())


def test_a_small_effect_that_is_well_determined_lacks_nothing():
    """Below the noise, yet known: many samples."""
    t, q, v, a = moved(11, 8.0)
    u = J * a + B * v + 0.02 + 0.004 * np.sin(q) + 0.01 * np.random.default_rng(1).normal(size=t.size)
    fit = identify(smooth() + find("gravity"), inverse_dynamics([recorded(t, q, u)], BAND))
    assert "gravity@axis.sine" not in kinds(fit, "excitation missing")


def swinging(phases: tuple[float, ...], mgl: float = 0.3) -> list:
    rng, made = np.random.default_rng(8), []
    for k, phase in enumerate(phases):
        t, q, v, a = moved(k + 40)
        noise = coloured(rng, t.size, 0.02)
        made.append(recorded(t, q, J * a + B * v + mgl * np.sin(q + phase) + noise, f"r{k}"))
    return made


def weighted() -> Plant:
    return Plant("one mass", (find("inertia")(inertia=J), find("viscous_friction"), find("gravity")(cosine=-0.1)))


def test_the_spread_is_of_the_parameters_that_are_declared():
    fit = identify(weighted(), inverse_dynamics(swinging((0.4, 0.4, 0.4)), BAND))
    assert {n for n in fit.spread if n.startswith("gravity")} == {"gravity@axis.mgl", "gravity@axis.phase"}
    for name, truth in (("mgl", 0.3), ("phase", 0.4)):
        low, high = fit.spread[f"gravity@axis.{name}"]
        assert low <= estimate(fit, name).value <= high and low == pytest.approx(truth, rel=0.2) == high
    assert set(fit.spread) <= {f"{e.effect}@{e.at}.{e.parameter}" for e in fit.estimates}


def test_a_phase_near_a_half_turn_has_no_spread_of_a_whole_one():
    low, high = identify(weighted(), inverse_dynamics(swinging((np.pi - 0.02, np.pi + 0.02)), BAND)).spread[
        "gravity@axis.phase"
    ]
    assert high - low < 0.2


def test_records_disagree_on_what_is_declared():
    found = kinds(identify(weighted(), inverse_dynamics(swinging((0.2, 0.2, 1.4)), BAND)), "records disagree")
    assert "gravity@axis.phase" in found and not any("sine" in n for n in found)
    finding = found["gravity@axis.phase"]
    assert finding.evidence["lowest"] == pytest.approx(0.2, abs=0.05)
    assert finding.evidence["highest"] == pytest.approx(1.4, abs=0.05)
