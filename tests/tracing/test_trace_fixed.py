"""A fixed value never moves unless the trace says so, with the value that it was declared with."""

from pathlib import Path

import numpy as np
import pytest
from conftest import measured

from workbench.campaign import load
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, TWO_MASS, Plant
from workbench.record import IDENTIFICATION, Record, Source
from workbench.tracing.candidates import ADDITION, CORRECTION
from workbench.tracing.full_rate import valued
from workbench.tracing.headline import _what_of
from workbench.tracing.output import as_dict
from workbench.tracing.result import Cause, Trace
from workbench.tracing.tracing import trace


def folders() -> list[Path]:
    """Every campaign of the measured data."""
    return sorted(
        f.parent for part in ("campaigns", "campaigns_d", "measured") for f in measured(part).glob("*/campaign.toml")
    )


def moved(found: Trace, declared: Plant) -> dict[str, float]:
    """Return "effect@place.parameter" -> declared value, of what was fixed and is not what it was, and is named nowhere."""
    named = {f"{c.effect}@{c.at}.{n}": value for c in found.causes for n, value in c.was.items()}
    after = {f"{e.effect}@{e.at}.{e.parameter}": e.value for e in found.after.estimates}
    held = {f"{e.key}.{n}": p.value for e in declared.effects for n, p in e.outside.items() if p.fixed}
    assert all(held[key] == value for key, value in named.items())
    return {key: value for key, value in held.items() if key in after and after[key] != value and key not in named}


def shifted(plant: Plant) -> Plant:
    """Return the plant with everything free and, within its bounds, of another value."""
    for e in plant.effects:
        values = {n: float(np.clip(1.1 * p.value + 1e-3, p.lower, p.upper)) for n, p in e.parameters.items()}
        plant = plant.swap(e(fixed=False, **values))
    return plant


def test_values_are_taken_over_of_what_is_free_and_of_nothing_else():
    plant = Plant(ONE_MASS) + find("inertia")(inertia=2.0, fixed=True) + find("viscous_friction")(viscous=0.1)
    found = valued(plant, shifted(plant))
    assert found["inertia"].parameters["inertia"].value == 2.0
    assert found["viscous_friction"].parameters["viscous"].value == pytest.approx(0.111)


def test_no_fixed_value_of_any_campaign_moves_where_values_are_taken_over(monkeypatch):
    """Plants alone are asked for: in place of each campaign's records, which take seconds to read, stands one of no axis."""
    t = 1e-5 * np.arange(9)
    none = Record("none", IDENTIFICATION, t, {"position": t, "torque": t}, {}, Source(Path("none"), "", "made", {}))
    monkeypatch.setattr("workbench.campaign.records", lambda *_: ((none,), ()))
    held = 0
    for folder in folders():
        try:
            plant = load(folder).plant
        except WorkbenchError:
            continue
        taken = valued(plant, shifted(plant))
        for e in plant.effects:
            for n, p in e.parameters.items():
                if p.fixed:
                    held += 1
                    assert taken[e.key].parameters[n].value == p.value, f"{folder.name}: {e.key}.{n}"
    assert held > 10


@pytest.mark.parametrize(
    ("name", "added"), [("campaigns/c10", True), ("campaigns_d/d27", True), ("measured/kr300_axis3_JmJl", False)]
)
def test_a_trace_moves_no_fixed_value_that_it_does_not_name(name, added):
    """Inertias are declared fixed: of the first two campaigns wrongly so, of the third a load encoder is late."""
    campaign = load(measured(name))
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    found = trace(campaign.plant, inverses, most=2, only=("inertia", "clock_skew", "stribeck_friction"))
    assert moved(found, campaign.plant) == {}
    assert ("inertia" in found.added) == added
    for c in as_dict(found, {})["causes"]:
        assert c["kind"] == (CORRECTION if c["effect"] == "inertia" else ADDITION)
        told = {n: p["was"] for n, p in c["parameters"].items() if "was" in p}
        declared = (
            campaign.plant[f"inertia@{c['at']}"].parameters["inertia"].value if c["effect"] == "inertia" else None
        )
        assert told == ({"inertia": declared} if c["effect"] == "inertia" else {})


# --- a value that is nearly right ------------------------------------------------------------------------------------


def turning(role: str, seed: int, force=lambda q: 0.0) -> Record:
    """An axis of 0.01 kg*m^2 in fast and slow motion, with a little noise."""
    t = np.arange(8000) / 1000.0
    q = sum(a * np.sin(2 * np.pi * f * t + seed + f) for a, f in ((0.5, 0.4), (0.2, 1.7), (0.1, 4.1)))
    v = np.gradient(q, 1e-3)
    noise = 0.004 * np.random.default_rng(seed).normal(size=t.size)
    drive = 0.01 * np.gradient(v, 1e-3) + 0.05 * v + force(q) + noise
    return Record(role, role, t, {"torque": drive, "position": q}, {}, Source(Path("made"), "", "made", {}))


@pytest.mark.parametrize(
    ("force", "verdict", "missing"),
    [(lambda q: 0.0, "nothing_missing", ()), (lambda q: 0.1 * np.sin(q + 0.4), "cause", ("gravity",))],
)
def test_a_value_that_is_off_by_little_stays_and_is_a_refinement_with_what_it_would_be(force, verdict, missing):
    plant = Plant(ONE_MASS) + find("inertia")(inertia=0.0102, fixed=True) + find("viscous_friction")
    records = [turning("identification", 0, force), turning("validation", 1, force)]
    found = trace(plant, inverse_dynamics(records, 40.0))
    assert (found.verdict, found.added) == (verdict, missing)
    assert found.after.plant["inertia@axis"].parameters["inertia"].value == 0.0102
    assert moved(found, plant) == {}
    (value,) = [r for r in found.refinements if r.effect == "inertia"]
    assert (value.kind, value.was) == (CORRECTION, {"inertia": 0.0102})
    assert value.parameters[0].value == pytest.approx(0.01, rel=2e-3)
    assert "in the place of 0.0102" in value.sentence
    assert "what lies beyond the 1 % that such a value is known to takes too little for a cause" in value.sentence
    (told,) = [r for r in as_dict(found, {})["refinements"] if r["effect"] == "inertia"]
    assert told["parameters"]["inertia"]["was"] == 0.0102


# --- how it is said --------------------------------------------------------------------------------------------------


def test_a_verdict_says_missing_of_an_addition_and_a_wrong_value_of_a_correction_with_places_where_names_are_alike():
    plant = Plant(TWO_MASS)
    for e in (find("inertia")(at="motor"), find("inertia")(at="load"), find("backlash")):
        plant += e
    motor, load_side = (Cause("inertia", at, "", (), 0.5, 0.5, kind=CORRECTION) for at in ("motor", "load"))
    gap = Cause("backlash", "joint", "", (), 0.5, 0.5)
    assert _what_of([motor], plant) == "inertia at the motor is declared with a wrong value"
    assert _what_of([motor, load_side], plant) == (
        "inertia at the motor and inertia at the load are declared with wrong values"
    )
    assert (
        _what_of([motor, gap], plant) == "backlash is missing, and inertia at the motor is declared with a wrong value"
    )
    assert _what_of([gap], plant.without("inertia@load")) == "backlash is missing"


@pytest.mark.parametrize(
    ("effect", "place", "said"),
    [
        ("kinematic_error", "sensor.position", "kinematic error of 2 orders is missing"),
        ("cable_spring", "axis", "cable spring is missing"),
    ],
)
def test_a_wave_found_twice_has_two_orders_and_a_curve_found_twice_is_one(effect, place, said):
    found = [Cause(name, place, "", (), 0.5, 0.5) for name in (effect, f"{effect} 2")]
    assert _what_of(found, Plant(ONE_MASS) + find("inertia")) == said
