"""What changed between two campaigns: known changes are found, of nothing changed little is said."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import rig
from made_motions import sines
from rig.motions import RECORDS
from scipy.signal import lfilter

from workbench.cli import main
from workbench.definition import find
from workbench.difference import compare
from workbench.difference.changes import holm
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant, freed
from workbench.record import IDENTIFICATION, Record, Source

RATE, BAND, NOISE = 250.0, 30.0, 0.01
TRUTH = {"inertia": 0.0026, "viscous": 0.011, "h0": 0.15, "a": 50.0}


def plant() -> Plant:
    """The model of both campaigns, a little off."""
    effects = (
        find("inertia")(inertia=0.0027, fixed=True), find("viscous_friction")(viscous=0.012),
        find("presliding_hysteresis")(h0=0.14, x0=1 / 55.0),
    )  # fmt: skip
    return freed(Plant(ONE_MASS, effects))


def measured(seed: int, memory: float = 0.05, seconds: float = 8.0, **changed: float):
    """InverseDynamics over two records in closed form: sines slow and fast, the rig's friction, and noise with a memory in s."""
    is_now, rng, records = TRUTH | changed, np.random.default_rng(seed), []
    t = np.arange(round(seconds * RATE)) / RATE
    for name in ("one", "two"):
        q, v, a = sines(rng, t)
        keep = np.exp(-1 / (memory * RATE))
        noise = lfilter([NOISE * np.sqrt(1 - keep**2)], [1, -keep], rng.standard_normal(t.size))
        u = is_now["inertia"] * a + is_now["viscous"] * v + is_now["h0"] * rig.masing(q - q[0], is_now["a"]) + noise
        channels = {"torque": u, "position": q}
        records.append(Record(name, IDENTIFICATION, t, channels, {}, Source(Path("r"), "", "", {})))
    return inverse_dynamics(records, BAND)


@pytest.mark.parametrize(
    ("changed", "moved"),
    [
        ({"viscous": 0.0145}, {"viscous"}),
        ({"h0": 0.13, "a": 65.0}, {"h0", "a"}),
        ({"inertia": 0.0028, "viscous": 0.0075}, {"inertia", "viscous"}),
    ],
)
def test_the_parameters_that_were_changed_are_said_to_have_moved_and_no_others(changed, moved):
    found = compare(plant(), measured(1), measured(2, **changed))
    assert {c.parameter for c in found.moved} == moved and {c.parameter for c in found.changes} == set(TRUTH)
    for c in found.moved:
        assert abs((c.after - c.before) - (changed[c.parameter] - TRUTH[c.parameter])) < c.half
        assert ("rose" in c.sentence) == (changed[c.parameter] > TRUTH[c.parameter])
    assert found.sentence.startswith(f"{len(moved)} of 4") and found.together < 0.01


@pytest.mark.parametrize("memory", [0.02, 0.2])
def test_of_campaigns_between_which_nothing_changed_one_in_twenty_shows_a_change(memory):
    """More than 7 of 40 come once in a thousand times at a chance of 5 %."""
    alarms = [bool(compare(plant(), measured(2 * k, memory), measured(2 * k + 1, memory)).moved) for k in range(40)]
    assert sum(alarms) <= 7


def test_a_change_below_what_the_records_show_is_said_with_what_would_have_shown():
    found = compare(plant(), measured(1), measured(2, viscous=0.01101))
    (viscous,) = (c for c in found.changes if c.parameter == "viscous")
    assert not viscous.moved and "would have shown" in viscous.sentence and viscous.half < 0.003


def test_holms_correction_is_that_of_the_textbook():
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == [1.0, 1.0] and holm([]) == []


def test_a_parameter_without_effect_on_one_side_is_not_compared():
    absent = plant() + find("gravity")(sine=0.01)
    still = compare(absent, measured(1), measured(2))
    assert {"mgl", "phase"} <= {c.parameter for c in still.changes}
    one = compare(plant() + find("constant_offset")(), measured(1), measured(2))
    assert "offset" in {c.parameter for c in one.changes} and not one.undetermined


# --- the command --------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def campaigns(tmp_path_factory):
    """Campaigns of one axis of the rig, each on motions of its own: as it is, again, repaired; and of another model."""
    folder, how = tmp_path_factory.mktemp("campaigns"), rig.Measuring(short=True)
    axis = rig.Axis(0.0026, 0.011, 0.15, 650.0)
    for k, (name, now) in enumerate(
        {"before": axis, "again": axis, "repaired": axis._replace(viscous=0.0095, h0=0.12)}.items()
    ):
        base = rig.plain(now)
        made = rig.runs(base.machine, k, how, RECORDS)
        rig.bring(folder / name, name, base, made, RECORDS, how, np.random.default_rng(k))
    shutil.copytree(folder / "before", folder / "other")
    text = (folder / "other" / "campaign.toml").read_text()
    (folder / "other" / "campaign.toml").write_text(text + '\n[[effects]]\neffect = "gravity"\nat = "axis"\n')
    return folder


def told(campaigns, capsys, tmp_path, before: str, after: str) -> tuple[str, dict]:
    assert main(["diff", str(campaigns / before), str(campaigns / after), "--out", str(tmp_path / "out")]) == 0
    return capsys.readouterr().out, json.loads((tmp_path / "out" / "diff.json").read_text())


def test_a_repair_is_told_by_what_moved(campaigns, capsys, tmp_path):
    said, content = told(campaigns, capsys, tmp_path, "before", "repaired")
    moved = {c["parameter"]: c for c in content["changes"] if c["moved"]}
    assert set(moved) == {"viscous", "h0"}
    assert moved["h0"]["after"] == pytest.approx(0.12, rel=0.02)
    assert moved["viscous"]["after"] == pytest.approx(0.0095, rel=0.02)
    assert "fell from" in said and content["doubts"] == []


def test_the_same_axis_again_shows_no_change(campaigns, capsys, tmp_path):
    said, content = told(campaigns, capsys, tmp_path, "before", "again")
    assert not any(c["moved"] for c in content["changes"]) and "did not move" in said


def test_motions_that_differ_are_said(campaigns, capsys, tmp_path):
    slow = tmp_path / "slow"
    shutil.copytree(campaigns / "again", slow)
    text = (slow / "campaign.toml").read_text()
    head, *records = text.split("[[records]]")
    kept = [r for r in records if "staircase" not in r and "multisine" not in r]
    (slow / "campaign.toml").write_text("[[records]]".join([head, *kept]))
    said, content = told(campaigns, capsys, tmp_path, "before", str(slow))
    assert len(content["doubts"]) >= 2 and "not alike" in said


def test_different_models_are_refused_with_the_effects_that_differ(campaigns, capsys, tmp_path):
    assert main(["diff", str(campaigns / "before"), str(campaigns / "other"), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "gravity@axis" in said and "other" in said and not (tmp_path / "out").exists()
