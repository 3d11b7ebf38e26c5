"""The report shows the residual against the signal that it follows, over a part of the record in which that is seen."""

import re
from dataclasses import replace

import numpy as np
import pytest
from report_example import study

from workbench.report import figures
from workbench.report.dependence import coordinates, explained, over_motion
from workbench.report.residual import REVERSALS, residual, window


@pytest.fixture(scope="module")
def result():
    return study()


def following(result, law):
    """Return the study with a declared model whose residual is law(series), and a perfect extended one."""
    trace = result.trace
    left = {n: replace(s, predicted=s.measured - law(s)) for n, s in trace.before.series.items()}
    none = {n: replace(s, predicted=s.measured) for n, s in trace.before.series.items()}
    before, after = replace(trace.before, series=left), replace(trace.after, series=none)
    return replace(result, trace=replace(trace, before=before, after=after))


@pytest.mark.parametrize(
    ("name", "law"),
    [
        ("Velocity", lambda s: 0.01 * np.exp(-(s.velocity**2)) * np.sign(s.velocity)),
        ("Position", lambda s: 0.01 * s.position**3),
        ("Acceleration", lambda s: 1e-4 * np.gradient(s.velocity, s.time)),
        ("Rate of the torque", lambda s: 1e-3 * np.gradient(s.measured, s.time)),
    ],
)
def test_the_signal_that_the_residual_follows_is_named_and_on_top(result, name, law):
    here = following(result, law)
    figure = over_motion(here, here.trace.before, here.trace.after, ["orbit"])
    assert re.search(rf"{name} alone explains (100|9\d)\u00a0% of the residual power", figure.alt)
    assert "0.0\u00a0% of it is left" in figure.alt
    labels = re.findall(r">([^<]*) \([^<]*\)</text>", figure.svg().decode())
    assert [label for label in labels if label != "residual"][0] == name.lower()


def test_noise_follows_nothing(result):
    rng = np.random.default_rng(0)
    here = following(result, lambda s: rng.normal(size=s.time.size))
    assert "No one signal of the motion" in over_motion(here, here.trace.before, None, ["orbit"]).alt


def test_a_periodic_cause_is_shown_within_its_period(result):
    here = following(result, lambda s: 0.01 * np.sin(60 * s.position))
    cause = here.trace.causes[0]
    order = replace(cause.parameters[0], parameter="order", value=60.0)
    here = replace(here, trace=replace(here.trace, causes=(replace(cause, parameters=(order,)),)))
    name, values, _ = coordinates(here, ["orbit"])[-1]
    assert name == "position within one period of order 60"
    assert 0 <= values.min() and values.max() <= 2 * np.pi / 60
    assert "Position within one period of order 60 alone" in over_motion(here, here.trace.before, None, ["orbit"]).alt


def test_what_is_explained_is_a_share_of_power():
    x = np.linspace(-1, 1, 6000)
    assert explained(x, np.sign(x)) == pytest.approx(1.0)
    assert explained(x, np.tile([1.0, -1.0], 3000)) == pytest.approx(0.0, abs=1e-3)
    assert explained(np.zeros(10), np.zeros(10)) == 0.0


def test_the_excerpt_is_where_the_declared_model_errs_most(result):
    series = result.trace.before.series["orbit"]
    wrong = np.where((series.time > 4.0) & (series.time < 4.5), 1.0, 1e-3)
    part = window(replace(series, predicted=series.measured - wrong))
    assert series.time[part][0] <= 4.0 and series.time[part][-1] >= 4.45
    turns = np.count_nonzero(np.diff(np.sign(series.velocity[part])))
    assert REVERSALS - 2 <= turns <= 3 * REVERSALS


@pytest.mark.parametrize("still", [True, False])
def test_short_and_still_records_have_a_report_too(result, still):
    def short(s):
        one = replace(s, keep=slice(10, 60))
        return replace(one, velocity=np.zeros(s.time.size), position=np.zeros(s.time.size)) if still else one

    trace = result.trace
    fits = [replace(f, series={n: short(s) for n, s in f.series.items()}) for f in (trace.before, trace.after)]
    here = replace(result, trace=replace(trace, before=fits[0], after=fits[1]))
    assert all(b.svg().startswith(b"<svg") for b in residual(here).blocks[1:])


def test_bands_hold_the_middle_of_each_bin():
    x = np.repeat(np.linspace(0, 1, 60), 100)
    r = np.tile(np.linspace(-1, 1, 100), 60)
    centre, low, middle, high = figures.bands(x, r)
    assert centre.size > 25
    assert np.allclose(middle, 0, atol=0.05) and np.allclose(low, -0.8, atol=0.05) and np.allclose(high, 0.8, atol=0.05)


def test_of_few_samples_a_bin_holds_enough_to_be_drawn_and_noise_explains_next_to_nothing():
    rng = np.random.default_rng(2)
    x, r = rng.uniform(-1.0, 1.0, 127), rng.normal(size=127)
    assert explained(x, r) < 0.2
    centre, *_ = figures.bands(x, r)
    assert centre.size >= 3


def test_where_an_axis_sticks_nothing_counts_in_a_figure_as_in_no_error(result):
    """What holds an axis at rest is no law of motion: neither the excerpt nor the rms in its heading is of it."""
    series = result.trace.before.series["orbit"]
    sticks = (series.time > 2.0) & (series.time < 2.5)
    wrong = np.where(sticks, 100.0, np.where((series.time > 4.0) & (series.time < 4.5), 1.0, 1e-3))
    stuck = replace(series, predicted=series.measured - wrong, counts=~sticks)
    assert series.time[window(stuck)][0] > 2.5
    trace = result.trace
    before = replace(trace.before, series={"orbit": stuck})
    here = replace(result, trace=replace(trace, before=before, causes=()))
    figure = residual(here).blocks[1]
    assert "without the samples at which the axis sticks or the log has a gap" in figure.caption
    assert f"{stuck.squares.rms * 1e3:.3g}"[:3] in figure.alt and stuck.squares.rms < 1.0
