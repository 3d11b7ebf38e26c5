"""The study of harmonic-drive models: its two laws by what the review prints, and its rule for verdicts."""

import importlib
from pathlib import Path

import numpy as np
import pytest

from workbench.definition import find
from workbench.kernel.step import build
from workbench.study.running import steps_of

FOLDER = Path(__file__).resolve().parents[2] / "studies" / "harmonic_drive_models"
VALUES = {"torque": 1.2, "x0": 3.5e-3, "share": 0.5, "c": 2.4, "friction": 0.05, "reversal": 2e-4}
LOOP = np.concatenate([np.linspace(a, b, 400) for a, b in ((0, 2.5e-3), (2.5e-3, -2.5e-3), (-2.5e-3, 2.5e-3))])


@pytest.fixture(scope="module")
def study():
    """The study's own modules, by name."""
    steps = steps_of(FOLDER)
    return {n: importlib.import_module(f"{steps.__name__}.{n}") for n in ("laws", "saying", "axes")}


def torque(effect, x, values):
    return values["torque"] * build(effect).run({"q": x}, values)[0]


def test_the_torque_of_two_compliances_gives_the_printed_deflection_back(study):
    v = VALUES
    found = torque(study["laws"].compliances_in_series(), LOOP, v) / v["torque"]
    behind, rubbed = 0.0, []
    for q in LOOP:
        behind = min(max(behind, q - v["reversal"]), q + v["reversal"])
        rubbed.append(v["friction"] * (q - behind) / v["reversal"])
    x_f, x_w = (1 - v["share"]) * v["x0"], v["share"] * v["x0"] / v["c"]
    carried = found - rubbed
    printed = x_f * np.arctan(found) + x_w * np.sign(carried) * -np.expm1(-v["c"] * np.abs(carried))
    assert np.abs(printed - LOOP).max() < 1e-15


def test_without_friction_two_compliances_are_the_catalogue_s(study):
    v = VALUES | {"friction": 0.0}
    known = {"torque": 1.2, "x_f": 0.5 * v["x0"], "x_w": 0.5 * v["x0"] / v["c"], "c": v["c"]}
    found = torque(study["laws"].compliances_in_series(), LOOP, v)
    assert found == pytest.approx(torque(find("multi_body_compliance"), LOOP, known), abs=1e-9)


def test_the_friction_between_two_compliances_takes_work_of_a_closed_loop(study):
    cycle = LOOP[400:]
    effect = study["laws"].compliances_in_series()
    rubs, smooth = (
        np.trapezoid(torque(effect, LOOP, VALUES | {"friction": f})[400:], cycle) for f in (VALUES["friction"], 0.0)
    )
    assert smooth == pytest.approx(0.0, abs=1e-9) and rubs > 1e-4


def test_waves_that_do_not_fade_are_the_catalogue_s_kinematic_error(study):
    q, motor = np.linspace(-2e-3, 2e-3, 50), np.linspace(-0.4, 0.4, 50)
    own, known = study["laws"].waves_under_load((2.0, 1.0), 30.0), find("kinematic_error")
    values = {n: p.value for n, p in own.parameters.items()} | {"sine_1": 1e-4, "cosine_1": 2e-5}
    one = {n: p.value for n, p in known.parameters.items()} | {"sine": 1e-4, "cosine": 2e-5, "order": 60.0}
    signals = {"q": q, "motor_q": motor}
    assert build(own).run(signals, values)[0] == pytest.approx(build(known).run(signals, one)[0], abs=1e-15)
    faded = build(own).run(signals, values | {"fading": 0.25})[0] - q
    assert faded[0] == pytest.approx((build(own).run(signals, values)[0] - q)[0] / 2.0, rel=1e-9)


def test_each_axis_has_the_effects_that_it_holds_and_no_other_optional_one(study):
    axes = study["axes"]
    for axis in axes.AXES:
        plant = axes.bare(axes.assumed(axis))
        assert all(key in plant for key, p in axes.HELD[axis].items() if any(p.values()))
        assert ("stribeck_friction" in plant) == (axis == axes.STRIBECK)
        assert ("compliances_in_series" in plant) == (axis == axes.SERIES)


def test_records_without_an_effect_neither_bear_a_statement_out_nor_refute_it(study):
    s = study["saying"]
    assert [s.verdict(*a) for a in ((True, True), (False, True), (False, False))] == [
        "borne out",
        "not borne out",
        "not in these records",
    ]
    silent = s.Statement("it falls", "carried", s.NOT_HELD, "nothing of it.")
    told = s.Statement("it falls", "made", s.NOT_BORNE_OUT, "it stays.")
    (one,) = s.decisive([silent, told])
    assert (one.records, one.verdict) == ("made", s.NOT_BORNE_OUT) and one.numbers.endswith("nothing of it.")
    assert s.decisive([silent]) == [silent]
