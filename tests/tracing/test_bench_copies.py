"""Copies of complete campaigns whose declaration lacks an effect that shows, or holds a wrong value: what their truth says of them."""

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks._trace_copies import SHOWS, WRONG, copied
from benchmarks._trace_families import cases, known
from workbench.campaign import Campaign
from workbench.definition import find
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record

COMPLETE = {"missing": [], "nrmse_declared": 0.01, "nrmse_true": 0.01}


def campaign() -> Campaign:
    """An axis of an inertia and of viscous friction, which show, and of an offset that does not."""
    t = 1e-3 * np.arange(4000)
    records = []
    for name, role, w in (("a", IDENTIFICATION, 9.0), ("b", VALIDATION, 7.0)):
        q, v, a = 0.3 * np.sin(w * t), 0.3 * w * np.cos(w * t), -0.3 * w**2 * np.sin(w * t)
        drive = 0.02 * a + 0.1 * v + 1e-4 + 1e-3 * np.random.default_rng(1).standard_normal(t.size)
        records.append(Record(name, role, t, {"torque": drive, "position": q}))
    plant = Plant(ONE_MASS) + find("inertia") + find("viscous_friction") + find("constant_offset")
    return Campaign(Path("made"), "made", plant, tuple(records), 60.0)


@pytest.mark.parametrize("name", ["q1", "q2", "q3"])
def test_what_is_left_out_is_an_effect_that_shows_whatever_is_drawn_first(name):
    found, truth = copied(campaign(), "less", COMPLETE, name)
    assert truth["missing"] == ["viscous_friction"] and "viscous_friction@axis" not in {
        e.key for e in found.plant.effects
    }
    assert truth["nrmse_declared"] ** 2 - truth["nrmse_true"] ** 2 >= SHOWS**2
    assert found.records is not None and {e.name for e in found.plant.effects} == {"inertia", "constant_offset"}


def test_a_wrong_value_is_held_and_is_wrong_by_what_is_drawn():
    found, truth = copied(campaign(), "wrong", COMPLETE, "q1")
    inertia = found.plant["inertia@axis"].parameters["inertia"]
    assert truth["missing"] == ["inertia"] and inertia.fixed
    assert min(abs(inertia.value / 0.02 - w) for w in WRONG) < 1e-3
    assert copied(campaign(), "wrong", COMPLETE, "q1")[0].plant == found.plant


def test_a_campaign_of_which_nothing_shows_stays_complete():
    made = campaign()
    bare = Campaign(made.folder, made.title, made.plant.without("viscous_friction@axis"), made.records[:1], 60.0)
    found, truth = copied(bare, "less", COMPLETE, "q1")
    assert (found, truth) == (bare, COMPLETE)


def test_complete_campaigns_alone_have_copies_that_lack_something(monkeypatch, tmp_path):
    for name in ("q1", "q2"):
        (tmp_path / "campaigns_q" / name).mkdir(parents=True)
        (tmp_path / "campaigns_q" / name / "campaign.toml").touch()
    answers = {"q1": COMPLETE, "q2": {**COMPLETE, "missing": ["cogging"]}}
    (tmp_path / "campaigns_q" / "truth.json").write_text(json.dumps(answers), encoding="utf-8")
    monkeypatch.setenv("WORKBENCH_DATA", str(tmp_path))
    assert [(c.family, c.name) for c in cases(["q:less", "q:wrong"], 1, 1)] == [("q:less", "q1"), ("q:wrong", "q1")]
    assert known("q:wrong") and not known("q:right") and not known("bench:wrong")
