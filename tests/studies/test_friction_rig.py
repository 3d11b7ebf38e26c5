"""The friction rig: what its loops lack beside Coulomb friction, and what is not offered as a cause."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import measured

from workbench.definition import find
from workbench.motion import motion
from workbench.record import IDENTIFICATION, Record, Source
from workbench.study.running import run, steps_of

FOLDER = Path(__file__).resolve().parents[2] / "studies" / "friction_rig"


def test_the_study_passes_its_checks_and_says_what_coulomb_friction_lacks(tmp_path):
    measured("friction_rig")
    ran = run(str(FOLDER), tmp_path / "out")
    assert ran.passed, "\n".join(ran.lines)
    content = json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8"))
    figures = {name: f["value"] for name, f in content["figures"].items()}
    assert figures["added"] == "presliding_length"  # an asymmetry and a wave over the stroke are refinements of it
    assert figures["validation_error_after"] < 0.036 and figures["validation_error_whole_band"] < 0.036
    # one spring that is not the same in both directions beats a bank of springs that are
    assert figures["validation_error_uneven"] < 0.04 < 0.05 < figures["validation_error_bank"]
    assert figures["dwell_correlation"] < -0.99 and figures["force_above_logged"] < 1e-3
    assert figures["repeat_floor_validation"] < figures["record_floor"] < figures["validation_error_after"]


@pytest.mark.parametrize("level", [2.0, 0.0])
def test_a_contact_whose_friction_a_curve_says_has_no_stiffness_stated(level):
    """A curve that was added may leave nothing of the declared level, over which a stiffness and an asymmetry are stated."""
    estimate = lambda effect, parameter, value: SimpleNamespace(effect=effect, parameter=parameter, value=value)  # noqa: E731
    of = (
        estimate("coulomb_friction", "coulomb", level),
        estimate("presliding_length", "length", 5e-5),
        estimate("coulomb_asymmetry", "coulomb_difference", -0.2),
    )
    said = steps_of(FOLDER).meanings(of)
    stated = [said["presliding_length"], said["coulomb_asymmetry"]]
    assert all(("no stiffness is stated" in text) is (level == 0.0) and "nan" not in text for text in stated)
    assert ("4e+04 N/m" in stated[0], "10 % softer" in stated[1]) == (level > 0.0, level > 0.0)


def test_nothing_of_a_drive_is_a_candidate():
    for name in steps_of(FOLDER).CONTACT:
        effect = find(name)
        assert effect.port in ("force", "sensor", "angle", "time") and effect.at != "command"
        assert not {"u", "tau", "a"} & set(effect.reads), name


def test_the_slope_from_dwell_to_dwell_is_found():
    """A stage that stops shorter by 5 um/N where force is larger, on ten strokes whose friction varies."""
    dt, rng, position, force = 0.005, np.random.default_rng(1), [], []
    for _ in range(10):
        for end, way in ((200e-6, 1.0), (0.0, -1.0)):
            friction = way * (2.0 + 0.2 * rng.normal())
            stop = end - 5e-6 * friction
            begun = position[-1][-1] if position else 0.0
            position += [np.linspace(begun, stop, 200), np.full(200, stop)]
            force += [np.full(400, friction)]
    q, f = np.concatenate(position), np.concatenate(force)
    channels = {"position": q, "force": f}
    source = Source(Path("synthetic"), "", "synthetic", {})
    record = Record("made", IDENTIFICATION, dt * np.arange(q.size), channels, {}, source)
    study = steps_of(FOLDER)
    for means in study.dwells(motion(record, 80.0), 0.0).values():
        slope, correlation = study.slope(means)
        assert slope == pytest.approx(-2e5, rel=1e-3) and correlation < -0.999 and len(means) >= 9
