"""The EMPS benchmark: its printed figures to the last digit, and what the workbench finds on the same records."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import measured

from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.output_error.free_run import refine_free_run
from workbench.plant import ONE_MASS, Plant
from workbench.record import ROLES
from workbench.study import configuration
from workbench.study.configuration import MissingData
from workbench.study.running import run, steps_of

FOLDER = Path(__file__).resolve().parents[2] / "studies" / "emps"
PRINTED = {
    "symmetric": {"mass": 95.1089, "viscous": 203.5034, "coulomb": 20.3935, "offset": -3.1648,
                  "identification_error": 0.040834, "validation_error": 0.059824},
    "asymmetric": {"mass": 95.1540, "viscous_forward": 166.7061, "viscous_backward": 240.4236,
                   "coulomb_forward": 20.1440, "coulomb_backward": 20.6277, "identification_error": 0.031117},
}  # fmt: skip


def load():
    return configuration.load(FOLDER)


@pytest.fixture(scope="module")
def study():
    measured("emps")
    return load()


@pytest.fixture(scope="module")
def records(study):
    return {role: steps_of(FOLDER).record(study, role) for role in ROLES}


def test_the_study_says_which_data_it_needs(monkeypatch, tmp_path):
    monkeypatch.delenv("WORKBENCH_DATA", raising=False)
    with pytest.raises(MissingData, match="set WORKBENCH_DATA"):
        load().measured("identification")
    monkeypatch.setenv("WORKBENCH_DATA", str(tmp_path))
    with pytest.raises(MissingData, match="DATA_EMPS_PULSES.mat: there is no such file"):
        load().measured("validation")
    (tmp_path / "emps").mkdir()
    (tmp_path / "emps" / "DATA_EMPS.mat").write_bytes(b"another file")
    with pytest.raises(WorkbenchError, match="obtain the original file"):
        load().measured("identification")


def test_every_printed_figure_has_a_requirement_of_half_its_last_digit():
    bounds = {r.name: r for r in load().requirements}
    for model, figures in PRINTED.items():
        for name in figures:
            assert bounds[f"{model}_{name}_deviation"].at_most == (5e-7 if name.endswith("error") else 5e-5)


def test_records_are_read_in_si(records):
    one = records["identification"]
    assert one.time.size == 24841 and one.dt == pytest.approx(1e-3, rel=1e-9)
    assert dict(one.units) == {"position": "m", "force": "N", "reference": "m"}
    assert dict(records["validation"].units) == {"position": "m", "force": "N", "reference": "m", "injected": "N"}
    assert np.abs(one.channels["position"]).max() == pytest.approx(0.24, abs=0.02)
    assert one.channels["force"][0] == pytest.approx(35.15065188 * 2.53862809, rel=1e-8)
    assert one.source.reader == "mat"


@pytest.mark.parametrize("model", PRINTED)
def test_the_published_protocol_gives_every_printed_digit(records, model):
    found = steps_of(FOLDER).published(records, model == "asymmetric")
    for name, printed in PRINTED[model].items():
        assert round(found[name], 6 if name.endswith("error") else 4) == printed, name


def test_printed_asymmetric_friction_is_the_plant_of_its_four_coefficients():
    steps, found = steps_of(FOLDER), PRINTED["asymmetric"]
    declared = Plant(
        ONE_MASS, tuple(map(find, ("inertia", "viscous_friction", "coulomb_friction", "constant_offset"))), rotary=False
    )
    at = {e.name: next(iter(e.parameters.values())).value for e in steps.printed_asymmetric(found, declared).effects}
    for sign, way in ((1.0, "forward"), (-1.0, "backward")):
        assert at["viscous_friction"] + sign * at["viscous_asymmetry"] == pytest.approx(found[f"viscous_{way}"])
        assert at["coulomb_friction"] + sign * at["constant_offset"] == pytest.approx(found[f"coulomb_{way}"])


def test_of_a_day_only_the_level_of_friction_is_fitted():
    plant = Plant(ONE_MASS, tuple(map(find, ("inertia", "viscous_friction", "coulomb_friction"))), rotary=False)
    held = steps_of(FOLDER).level_alone(plant)
    assert [n for e in held.effects for n, p in e.parameters.items() if not p.fixed] == ["coulomb"]


def test_the_level_of_friction_wanders_within_the_identification_record(records):
    effects = ("inertia", "viscous_friction", "coulomb_friction", "constant_offset", "viscous_asymmetry")
    one = inverse_dynamics([records["identification"]], 40.0)
    found = refine_free_run(identify(Plant(ONE_MASS, tuple(map(find, effects)), rotary=False), one).plant, one)
    within = steps_of(FOLDER).wander(found, one[0].motion)
    assert within.own < 1e-3 < 5e-3 < within.other
    assert 0.2 < np.subtract(*within.level("constant_offset")) < 0.4
    # an offset alone drifts dF/b all the time: rms of a line that ends at T/b, b of both directions, is T/(b sqrt 3)
    b = found["viscous_friction"].parameters["viscous"].value
    assert within.per_newton == pytest.approx(24.84 / b / 3**0.5, rel=0.5)


def test_a_plant_without_a_lag_has_no_hold_to_take_off():
    plant = Plant(ONE_MASS, (find("inertia"),), rotary=False)
    assert steps_of(FOLDER).without_hold(plant, 1e-3) is plant


def test_only_the_identification_record_is_fitted(records):
    other = records["validation"]
    moved = replace(other, channels={**other.channels, "force": 2 * other.channels["force"]})
    found = [steps_of(FOLDER).published(records | {"validation": r}, False) for r in (other, moved)]
    assert [f["mass"] for f in found] == [found[0]["mass"]] * 2
    assert found[0]["validation_error"] != found[1]["validation_error"]


def test_the_study_passes_its_checks_and_says_what_symmetric_friction_lacks(study, tmp_path):
    ran = run(str(FOLDER), tmp_path / "out")
    assert ran.passed, "\n".join(ran.lines)
    content = json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8"))
    figures = {name: f["value"] for name, f in content["figures"].items()}
    assert len(content["published"]) == 12
    lacked = {"viscous_asymmetry", "actuator_lag", "film_friction"}  # presliding is a refinement
    assert set(figures["added"].split(", ")) == lacked
    assert (
        figures["validation_error_after"]
        <= 0.028
        < figures["validation_error_asymmetric"]
        < figures["validation_error_before"]
    )
    # Each step lowers the error on the record that nothing was fitted to.
    errors = [figures["validation_error_before"], *(s["validation"] for s in content["evidence"])]
    assert errors == sorted(errors, reverse=True)
    assert (
        figures["validation_error_after"] < errors[-1] < 1.05 * figures["validation_error_after"]
    )  # refinements beside
    # What is not borne out: a Coulomb part of the asymmetry, Stribeck's drop, drift, load; the ripple does not carry over.
    gains = {t["effect"]: (t["gain"], t["scatter"], t["validation"]) for t in content["explanations"]}
    for name in (
        "coulomb_asymmetry dry",
        "stribeck_friction",
        "friction_drift",
        "load_dependent_friction",
        "cable_spring",
    ):
        gain, scatter, left = gains[name]
        assert gain < 3 * scatter or left > figures["validation_error_after"], name
    gain, scatter, left = gains["cogging turn"]
    assert gain > 3 * scatter and left > figures["validation_error_after"]
    # Noise is small; the two days differ by more than the traced model leaves.
    assert (
        figures["repeat_floor_identification"] < 0.006 and figures["record_floor"] > figures["validation_error_after"]
    )
    assert figures["pulse_height"] == pytest.approx(1.014, abs=5e-4) and figures["controller_error_validation"] < 0.003
    # The ripple is in both records, and its phase is not the same: it helps on neither what it was not fitted to.
    (_, one, first, wide), (_, other, second, wider) = (r.values() for r in content["ripple"])
    assert 0.6 < min(one, other) <= max(one, other) < 1.1 and abs(first - second) > wide + wider
    assert figures["validation_error_ripple"] > figures["validation_error_lag"]
    # The loop: the traced model gives the recorded force back better than the symmetric one, on both records.
    assert figures["controller_error_identification"] < 0.0025
    loops = {r.pop("model"): r for r in content["closed_loop"]}
    assert all(loops["as traced"][role] < loops["the same parameters, simulated here"][role] < p
               for role, p in (("identification", 0.0585), ("validation", 0.0894)))  # fmt: skip
    # The free run: chosen on DATA_EMPS alone, and what of it the day's friction is; said as such.
    *runs, chosen, day, own = content["free_run"]
    fitted = [r for r in runs if r["fitted"] == "DATA_EMPS"]
    assert chosen == min(fitted, key=lambda r: r["identification"]) and figures[
        "free_run_error_validation"
    ] == pytest.approx(chosen["validation"])
    assert own["validation"] <= day["validation"] < 0.4 * chosen["validation"] and "PULSES" in day["fitted"]
    # What PULSES comes to is foretold by DATA_EMPS: the law holds on each half, the level of friction does not hold from half to half.
    assert figures["free_run_error_half"] < 1e-3 < 5e-3 < figures["free_run_error_other_half"] < 9e-3
    html = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    for words in ("Three protocols side by side", "dynoNet", "2.64 mm", "5.98", "5.85", "8.94"):
        assert words in html, words
    assert "12 of 12 printed figures are reproduced to their last digit." in html
