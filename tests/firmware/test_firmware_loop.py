"""The compiled firmware in the loop: it moves axes as the law in float64 does, and a study's axes are driven by it."""

import json

import numpy as np
import pytest
from firmware_bench import COUNT, Gains, every, need_compiler

from workbench.cli import main
from workbench.compensation import Compensator, compensated
from workbench.control import fixed_pd, pi_cascade, scheduled_pd
from workbench.definition import find
from workbench.design.climb import Climb, Climbed
from workbench.design.families.family import Family
from workbench.design.ladder import all_rungs, climbed, ladder
from workbench.design.regret import References, regret
from workbench.firmware import firmware, quantisation
from workbench.firmware.comparison import same_bits
from workbench.firmware.document import document
from workbench.firmware.image import read
from workbench.firmware.loop import run_firmware
from workbench.firmware.on_ladder import compiled_regrets
from workbench.firmware.verification import judged
from workbench.plant import ONE_MASS, TWO_MASS, Limits, Plant
from workbench.robustness import worst
from workbench.robustness.cases import Varied
from workbench.robustness.distribution import Distribution
from workbench.robustness.workload import Work
from workbench.simulation import Loop, ScenarioArrays, simulate
from workbench.task.task import Task

LOOP = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, COUNT)
ARITHMETICS = ("float32", "fixed")
EFFECTS = (
    find("inertia")(inertia=0.0074),
    find("viscous_friction")(viscous=0.02),
    find("presliding_hysteresis")(h0=0.15, x0=1.6e-3),
)
AXIS = Plant(ONE_MASS, EFFECTS, limits=Limits(3.3, 20.9))
TO = 20000 * COUNT  # a whole number of counts


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize("controller", [scheduled_pd(Gains), fixed_pd(900.0, 5.0), pi_cascade(60.0, 5.0, 300.0, 12.0)])
def test_the_firmware_moves_an_axis_as_the_law_does(controller, arithmetic):
    need_compiler()
    scenarios = ScenarioArrays(4, target=TO, noise=2e-3, phase=np.array([0.1, 0.4, 0.6, 0.9]), seed=np.arange(1, 5))
    law = simulate(AXIS, LOOP, controller, scenarios, 0.4)
    run = run_firmware(firmware(controller, LOOP, AXIS, arithmetic), AXIS, LOOP, scenarios, 0.4)
    assert np.abs(law.final_error - run.final_error).max() < 2.0 * COUNT
    assert np.abs(law.time_1pct - run.time_1pct).max() < (1e-4 if arithmetic == "float32" else 1e-3)  # of 103 ms
    assert run.peak_torque.max() <= 3.3


def test_a_gain_table_is_on_its_ladder_as_compiled_what_its_law_is_there():
    need_compiler()
    task = Task(AXIS, LOOP, TO, 0.4)
    on = ladder(task, 0.15, scenarios=((1.0, 1.0),), sizes=3)
    numbers = np.array([1.0])
    family = Family(
        "table", ("scale",), numbers / 2, numbers * 2, numbers,
        lambda points, lanes: scheduled_pd(Gains, scale=np.repeat(points[:, 0], lanes)), lambda points: points[:, 0],
    )  # fmt: skip
    law = climbed(on, family, numbers[None], all_rungs(on, numbers[None]))[0]
    known = References(law[..., 0], law[..., 1], 0.0 * law[..., 0], np.empty(law.shape[:2]), law[..., 0], np.empty(0))
    best = Climb(family, 1, numbers, 1.0, law)
    held = compiled_regrets(Climbed(on, (best,), known, regret(on, law, known)), task)
    assert list(held) == ["in float32", "in fixed point"]
    for found, most in zip(
        held.values(), (1.02, 1.2), strict=True
    ):  # ten counts under a load end 9 samples later in fixed point
        assert found.worst[0] < most and found.worst[1] < 1.03 and found.worst[2] < 0.01


def test_two_masses_are_moved_too():
    need_compiler()
    effects = (find("inertia")(at="motor", inertia=0.005), find("inertia")(at="load", inertia=0.004),
               find("linear_stiffness")(at="joint", stiffness=4000.0), find("linear_damping")(at="joint", damping=0.5))  # fmt: skip
    plant = Plant(TWO_MASS, effects, limits=Limits(3.3, 20.9))
    loop = Loop(2.5e-4, 4, 0.0, 2.5e-4, 0.5 * COUNT, COUNT, "load_position")
    c = scheduled_pd(Gains, "frozen", motor_speed=True, scale=0.2)
    law = simulate(plant, loop, c, ScenarioArrays(1, target=TO), 0.4)
    made = firmware(c, loop, plant)
    run = run_firmware(made, plant, loop, ScenarioArrays(1, target=TO), 0.4)
    for arithmetic in ARITHMETICS:  # every sample, by both encoders
        own = firmware(c, loop, plant, arithmetic)
        driven = run_firmware(own, plant, loop, ScenarioArrays(1, target=TO), 0.4)
        samples, same = same_bits(own, driven, np.array([TO]))
        assert same == samples == 1600 and np.ptp(driven.trajectories["other"]) > 1000.0
    assert np.isfinite(law.time_1pct).all()
    assert np.abs(law.final_error - run.final_error).max() < 2.0 * COUNT
    assert np.abs(law.time_1pct - run.time_1pct).max() < 1e-4


def outputs(folder) -> None:
    """What a study with robustness leaves behind, of a small task."""
    varied = (
        Varied("friction", Distribution("uniform", 0.7, 1.3)),
        Varied("inertia", Distribution("uniform", 0.8, 1.2)),
    )
    task = Task(AXIS, LOOP, TO, 0.25, noise=2e-3)
    compensated_pd = compensated(
        fixed_pd(900.0, 5.0), Compensator.of(AXIS, ["presliding_hysteresis"], source="reference")
    )
    both = {"scheduled PD (following)": scheduled_pd(Gains), "fixed PD, compensated": compensated_pd}
    work = Work(task, both, varied)
    (folder / "firmware" / "float32").mkdir(parents=True)
    (folder / "firmware" / "float32" / "axis.c").write_text("of the study itself")
    (folder / "robustness").mkdir(parents=True)
    worst.write(work, (), folder / "robustness" / worst.FILE)


def test_verify_drives_a_studys_axes_and_writes_what_it_found(tmp_path, capsys):
    need_compiler()
    outputs(tmp_path / "axis")
    assert main(["verify", str(tmp_path / "axis"), "--firmware", "--draws", "3"]) == 0
    said = capsys.readouterr().out
    assert "scheduled" in said and "equal" in said
    found = json.loads((tmp_path / "axis" / "firmware" / "verified" / "verify.json").read_text())["compared"]
    assert len(found) == 4 and all(c["good"] and c["same"] == c["samples"] > 0 for c in found)
    for c in found:
        place = tmp_path / "axis" / "firmware" / "verified" / c["files"]
        assert (place / "compensation.bin").is_file() == ("compensated" in c["controller"])
        assert read((place / "axis.bin").read_bytes()).plant == AXIS.digest
        assert {"axis.c", "axis.h", "axis.hex", "axis.json", "axis.a2l", "axis_table.h"} <= {
            p.name for p in place.iterdir()
        }


def test_a_table_says_the_verdict_of_the_study_that_it_was_made_by(tmp_path):
    assert judged(tmp_path) == 0
    for checks, traced, said in (
        ([True, True], "cause", 5),
        ([True, False], "unknown", 14),
        ([], "nothing_missing", 8),
    ):
        text = json.dumps({"checks": [{"passed": p} for p in checks], "verdict": traced})
        (tmp_path / "results.json").write_text(text)
        assert judged(tmp_path) == said
    made = firmware(fixed_pd(900.0, 5.0), LOOP, AXIS, verdict=5)
    assert document(made)["verdict"] == "requirements met; trace: cause"


def test_verify_says_what_is_missing(tmp_path, capsys):
    assert main(["verify", str(tmp_path), "--firmware"]) == 2
    assert "run the study first" in capsys.readouterr().err
    outputs(tmp_path / "axis")
    assert main(["verify", str(tmp_path / "axis"), "--firmware", "--controller", "scheduled PD"]) == 2
    assert "scheduled PD (following)" in capsys.readouterr().err
    assert main(["verify", str(tmp_path / "axis"), "--firmware", "--draws", "0"]) == 2


@pytest.mark.parametrize("name", every())
def test_what_a_number_loses_is_no_more_than_half_a_unit(name):
    for arithmetic in ARITHMETICS:
        made = firmware(*every()[name], arithmetic)
        for q in quantisation.numbers(made):
            gain = " at knot " in q.name
            assert q.error < (2.0**-24 if arithmetic == "float32" else 2.0**-9 if gain else 1e-4) * 1.01, q
        grains = {g.name: g for g in quantisation.grains(made)}
        if arithmetic == "fixed":
            assert grains["u_c"].least < 3.3 * 2.0**-12 and all(g.largest / g.least <= 2.0**31 for g in grains.values())
        else:
            assert not grains
