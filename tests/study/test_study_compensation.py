"""[compensation] of a study: what is asked for, what it is worth, and what is said where it cannot be had."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from workbench.cancellation.following import Slow, bears, worth
from workbench.compensation import Compensator, compensated
from workbench.control import fixed_pd
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.exporting.leaving import leave
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.simulation import Loop
from workbench.study import configuration
from workbench.study.compensation import compensation
from workbench.task.task import Task

LOOP = Loop(5e-4, 2, 5e-4, 5e-4, 1e-6)
SPRING = find("stop")(stiffness=2000.0, radius=1e-4)
PLANT = Plant(ONE_MASS, (find("inertia")(inertia=0.01), SPRING), limits=Limits(3.0))
PD = fixed_pd(60.0, 0.5)
TEXT = """
title = "t"
question = "q"
[compensation]
effects = ["stop"]
controller = "fixed PD"
amplitude = {{ value = 10.0, unit = "mrad" }}
frequency = {{ value = 0.5, unit = "Hz" }}
{more}
"""


def study(tmp_path, more=""):
    (tmp_path / "study.toml").write_text(TEXT.format(more=more), encoding="utf-8")
    return configuration.load(tmp_path)


def judged(tmp_path, more="", model=None):
    task = Task(PLANT, LOOP, 0.1, 0.1)
    return compensation(study(tmp_path, more), task, {"fixed PD": lambda lanes: PD}, lambda _: None, model)


def test_a_slow_motion_begins_smoothly_and_ends_where_it_began():
    r = Slow(0.01, 0.5).reference(LOOP)
    assert (
        r[0] == 0.0
        and abs(r[-1]) < 1e-4
        and np.abs(np.diff(r, 2)).max() < 1e-6
        and r.max() == pytest.approx(0.01, rel=1e-3)
    )


def test_its_worth_is_the_error_without_over_that_with_it(tmp_path):
    part = judged(tmp_path)
    assert part.figures["compensation_following_ratio"] > 5.0
    assert part.figures["compensation_over_true"] == 1.0
    assert 1.0 < part.figures["compensation_following_ratio_off"] < part.figures["compensation_following_ratio"]
    assert part.units["following_error_alone"] == "rad"
    (chapter,) = part.chapters
    table = next(b for b in chapter.blocks if hasattr(b, "rows"))
    assert len(table.rows) == 4 and "times" in table.rows[1][2]


def test_a_model_that_is_off_is_held_against_the_true_law(tmp_path):
    model = PLANT.swap(SPRING(stiffness=1800.0))
    part = judged(tmp_path, 'source = "measured"', model)
    assert part.figures["compensation_over_true"] < 0.8 and part.figures["compensation_following_ratio_true"] > 5.0


def test_what_is_misspelt_is_said(tmp_path):
    with pytest.raises(WorkbenchError, match="source"):
        judged(tmp_path, 'source = "guess"')
    with pytest.raises(WorkbenchError, match="no controller 'fixed PD'"):
        compensation(study(tmp_path), Task(PLANT, LOOP, 0.1, 0.1), {"PI cascade": lambda lanes: PD}, lambda _: None)


def test_a_controller_that_does_not_follow_is_refused():
    with pytest.raises(WorkbenchError, match="does not follow"):
        worth(PLANT, LOOP, fixed_pd(0.1, 0.1), Compensator.of(PLANT, ("stop",), source="reference"), Slow(1e-3, 0.5))


def test_a_loop_that_friction_alone_holds_up_is_found():
    """Without any damping of its own a double integrator swings under a position loop."""
    named = Compensator.of(PLANT, ("stop",), source="measured")
    assert bears(PLANT, LOOP, PD, named, Slow(0.01, 0.5))
    assert not bears(PLANT, LOOP, fixed_pd(60.0, -0.02), named, Slow(0.01, 0.5))


def test_its_margin_stands_beside_its_worth(tmp_path):
    task = Task(PLANT, LOOP, 0.1, 0.1)
    factories = {"fixed PD": lambda lanes: PD}
    part = compensation(
        study(tmp_path), task, factories, lambda _: None, margins=lambda *given: dict.fromkeys(given[2], 1.5)
    )
    assert part.figures["compensation_sensitivity"] == part.figures["compensation_sensitivity_off"] == 1.5
    (chapter,) = part.chapters
    table = next(b for b in chapter.blocks if hasattr(b, "rows"))
    assert table.columns[-1] == "Ms" and {row[-1] for row in table.rows} == {"1.50"}


def test_what_leaves_a_study_holds_the_law_and_its_compensation_in_both_arithmetics(tmp_path):
    plant = Plant(
        ONE_MASS,
        (find("inertia")(inertia=0.01), find("presliding_hysteresis")(h0=0.1, x0=1e-3)),
        limits=Limits(3.0, 20.0),
    )
    named = Compensator.of(plant, ("presliding_hysteresis",), source="reference")
    one = SimpleNamespace(controller=lambda lanes: compensated(fixed_pd(np.full(lanes, 60.0), 0.5), named))
    leave(
        {"fixed PD, compensated": one},
        "fixed PD, compensated",
        plant,
        LOOP.sample_time,
        tmp_path,
        task=Task(plant, LOOP, 0.1, 0.1),
    )
    (entry,) = json.loads((tmp_path / "contents.json").read_text(encoding="utf-8"))["controllers"]
    assert entry["recommended"] and entry["compensation"]["effects"] == ["presliding_hysteresis@axis"]
    files = [*entry["files"], *entry["compensation"]["float32"], *entry["compensation"]["fixed"]]
    assert all((tmp_path / f).is_file() for f in files) and any(f.endswith("compensation.c") for f in files)
