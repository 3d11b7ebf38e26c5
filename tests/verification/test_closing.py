"""The loop closed with what was found: what the declared model promises, what becomes of it, and what knowing it gives."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from report_example import trace as example

from workbench.campaign import Campaign
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.plant import ONE_MASS, TWO_MASS, Limits, Plant
from workbench.record import VALIDATION, Record, Source
from workbench.report.closed_loop import absent, heading
from workbench.report.closed_loop import closed_loop as chapter_of
from workbench.report.contents import Callout, Figure, Table
from workbench.verification.assumed import judge, loop_of
from workbench.verification.closed_loop import DECLARED, EXTENDED, as_dict, close, rise_of
from workbench.verification.closing import closed_loop, lacking, record_of

FRICTION = (find("viscous_friction")(viscous=0.01), find("coulomb_friction")(coulomb=0.1))


def plant(inertia: float = 2e-3) -> Plant:
    return Plant(ONE_MASS, (find("inertia")(inertia=inertia), *FRICTION), limits=Limits(drive=3.0))


def record(reference: bool = True) -> Record:
    t = np.arange(0, 2, 1e-3)
    q = np.sin(2 * np.pi * t) ** 2
    channels = {"torque": np.zeros(t.size), "position": q} | ({"reference": q} if reference else {})
    units = dict.fromkeys(channels, "rad") | {"torque": "N*m"}
    return Record("moves", VALIDATION, t, channels, units, Source(Path("x"), "0" * 64, "csv", {}), {"position": 1e-5})


@pytest.fixture(scope="module")
def heavier():
    """An axis twice as heavy as declared."""
    return close(plant(1e-3), plant(2e-3), record())


def test_gains_tuned_on_a_lighter_axis_overshoot_and_those_that_know_do_not(heavier):
    assert heavier.promised.overshoot < 0.0025 and heavier.tuned_on_extended.overshoot < 0.0025
    assert heavier.tuned_on_declared.overshoot > 0.01
    assert heavier.change["overshoot"] == heavier.tuned_on_extended.overshoot - heavier.tuned_on_declared.overshoot < 0
    assert heavier.tuned_on_extended.time_1pct < heavier.tuned_on_declared.time_1pct
    assert heavier.followed.position > 0 and heavier.followed.drive > 0.01


def test_where_nothing_was_missing_nothing_changes():
    same = close(plant(), plant(), record())
    assert set(same.change.values()) == {0.0}
    assert same.followed.position == same.followed.drive == 0.0
    assert same.followed.largest[DECLARED] == same.followed.largest[EXTENDED] > 0


def test_the_step_stays_within_the_records_travel(heavier):
    assert 0 < heavier.start < heavier.start + heavier.step < 1
    q = heavier.signals[EXTENDED, EXTENDED][0]
    assert q[0] == heavier.start and q[-1] == pytest.approx(heavier.start + heavier.step, abs=1e-3)


def test_without_a_reference_the_step_alone_is_simulated():
    assert close(plant(), plant(), record(reference=False)).followed is None


def test_the_loop_runs_at_the_rate_of_the_record():
    loop = loop_of(record())
    assert loop.sample_time == pytest.approx(1e-3) and loop.substeps == 4 and loop.resolution == 1e-5


def test_what_a_campaign_lacks_is_said():
    assert lacking(plant(), record()) == ""
    assert "state actuator_limit" in lacking(replace(plant(), limits=Limits()), record())
    assert "no record" in lacking(plant(), None)
    assert "actuator_limit" in absent(lacking(replace(plant(), limits=Limits()), record())).blocks[0].text


def test_the_loop_is_closed_along_the_validation_record_whose_name_comes_first():
    a, b = (replace(record(), name=n) for n in "ab")
    campaign = Campaign(Path("x"), "t", plant(), (b, replace(a, role="identification"), replace(a, name="c")), 60.0)
    assert record_of(campaign).name == "b" and record_of(replace(campaign, records=campaign.records[1:2])) is None


def test_a_trace_says_why_its_loop_is_not_closed():
    nothing = Plant(ONE_MASS, FRICTION, limits=Limits(drive=3.0))
    for declared, why in ((replace(plant(), limits=Limits()), "actuator_limit"), (nothing, "no inertia")):
        campaign = Campaign(Path("x"), "t", declared, (record(),), 60.0)
        sentence = closed_loop(campaign, example())
        assert sentence.startswith("The loop is not closed") and why in sentence


def elastic(load: float = 2e-3) -> Plant:
    """Two masses on a spring with a little damping, friction on the motor's."""
    masses = (find("inertia")(at="motor", inertia=1e-3), find("inertia")(at="load", inertia=load))
    joint = (find("linear_stiffness")(at="joint", stiffness=600.0), find("linear_damping")(at="joint", damping=0.1))
    return Plant(TWO_MASS, (*masses, *joint, *(e(at="motor") for e in FRICTION)), limits=Limits(drive=3.0))


def test_of_two_masses_the_load_goes_the_step():
    one = record()
    channels = {**one.channels, "load_position": one.channels["position"]}
    found = close(elastic(1e-3), elastic(), replace(one, channels=channels))
    assert (
        found.promised.overshoot < 0.0025
        and found.tuned_on_extended.overshoot < 0.0025 < found.tuned_on_declared.overshoot
    )
    q = found.signals[EXTENDED, EXTENDED][0]
    assert q[-1] == pytest.approx(found.start + found.step, abs=1e-3)


def test_a_plant_that_cannot_be_tuned_for_is_refused_with_a_sentence():
    loose = elastic().without("linear_stiffness@joint")
    with pytest.raises(WorkbenchError, match="joint with a stiffness"):
        judge(loose, loop_of(record()), 1.0)


def test_rise_is_from_a_tenth_to_nine_tenths():
    time = np.linspace(0, 10, 101)
    q = np.stack([1 + 0.2 * time, 1 + 0.05 * time], axis=1)  # reach 3 and 1.5
    np.testing.assert_allclose(rise_of(time, q, 1.0, np.array([2.0, 2.0])), [4.0, np.inf])


def test_where_nothing_changes_the_title_says_so(heavier):
    level = replace(heavier, responses=(heavier.promised, heavier.tuned_on_declared, heavier.tuned_on_declared))
    assert heading(example(), level) == "Gains tuned with Stribeck friction in the model step as those tuned without"
    never = replace(
        heavier,
        responses=(heavier.promised, replace(heavier.tuned_on_declared, time_1pct=np.inf), heavier.tuned_on_extended),
    )
    assert "1 % time" in heading(example(), never) and heading(example(), never).endswith("instead of never")


def test_it_is_json_whatever_comes_of_it(heavier):
    never = replace(heavier.tuned_on_declared, time_1pct=float("inf"))
    text = json.dumps(
        as_dict(replace(heavier, responses=(heavier.promised, never, heavier.tuned_on_extended))), allow_nan=False
    )
    content = json.loads(text)
    assert content["responses"][1]["time_1pct"] is None and content["change"]["time_1pct"] is None
    assert content["gains"]["extended"]["kvp"] > 0 and content["followed"]["record"] == "moves"


def test_the_chapter_says_what_knowing_is_worth(heavier):
    chapter = chapter_of(example(), heavier)
    (said,) = [b.text for b in chapter.blocks if isinstance(b, Callout)]
    assert "Stribeck friction" in said and "an overshoot of 0." in said and "instead of" in said
    table = next(b for b in chapter.blocks if isinstance(b, Table))
    assert [r[:2] for r in table.rows] == [
        ("declared model", "declared model"), ("declared model", "extended model"), ("extended model", "extended model"),
    ]  # fmt: skip
    figure = next(b for b in chapter.blocks if isinstance(b, Figure))
    assert "With Stribeck friction in the model the" in figure.alt and "instead of" in figure.alt
    svg = figure.svg().decode()
    for label in (
        "error, absolute (rad)",
        "command (N\u00b7m)",
        "time (s)",
        "tuned on the declared, run on the extended",
    ):
        assert label in svg
