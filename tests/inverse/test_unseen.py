"""Gaps of a log that is put on one rate: about one that hides what is judged no balance counts, and no invented moment is left."""

from dataclasses import replace

import numpy as np
import pytest

from workbench.campaign import load
from workbench.identification.fit import identify
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.inverse.unseen import ABOUT, HIDES
from workbench.motion import motion
from workbench.readers.sampling import gaps
from workbench.record import IDENTIFICATION, ROLES, Record
from workbench.tracing.decimation import thin_one

DT, BAND = 1e-3, 50.0
TIME = DT * np.arange(8000)
CAMPAIGN = """
title = "a slide on air"
plant = "one mass"
resample = true
evaluation_bandwidth = {{ value = {band}, unit = "Hz" }}

[channels.time]
column = "t"
unit = "s"

[channels.force]
column = "F"
unit = "N"

[channels.position]
column = "x"
unit = "m"

[[effects]]
effect = "inertia"
at = "axis"
parameters.inertia = {{ value = 2.0, unit = "kg", fixed = false }}

[[effects]]
effect = "viscous_friction"
at = "axis"
parameters.viscous = {{ value = 1.0, unit = "N*s/m", fixed = false }}
"""


def slide(folder, missing, band):
    """A campaign of a slide that turns within a few samples, whose record for identification misses these (from, until) samples."""
    force = 20.0 * np.sign(np.sin(2 * np.pi * 1.5 * TIME))
    v = np.cumsum(np.concatenate([[0.0], 0.5 * (force[1:] + force[:-1])])) * DT / 3.0
    x = np.cumsum(np.concatenate([[0.0], 0.5 * (v[1:] + v[:-1])])) * DT
    text = CAMPAIGN.format(band=band)
    for role in ROLES:
        keep = np.ones(TIME.size, dtype=bool)
        for a, b in missing if role == IDENTIFICATION else ():
            keep[a:b] = False
        rows = np.column_stack([TIME, x, force])[keep]
        np.savetxt(folder / f"{role}.csv", rows, "%.9g", ",", header="t,x,F", comments="")
        text += f'\n[[records]]\nfile = "{role}.csv"\nrole = "{role}"\n'
    (folder / "campaign.toml").write_text(text)
    return load(folder)


def made(unseen):
    x = np.sin(2 * np.pi * TIME)
    channels = {"force": -2.0 * (2 * np.pi) ** 2 * x, "position": x}
    return Record("made", IDENTIFICATION, TIME.copy(), channels, unseen=unseen)


def test_a_clock_s_gaps_are_where_a_sample_or_more_is_missing():
    keep = np.delete(np.arange(TIME.size), [100, *range(2000, 2006)])
    assert np.array(gaps(TIME[keep])) == pytest.approx(np.array([[0.099, 0.101], [1.999, 2.006]]))
    jittered = TIME + 0.2 * DT * np.random.default_rng(1).uniform(-1.0, 1.0, TIME.size)
    assert gaps(jittered) == ()


def test_about_a_gap_that_hides_the_band_no_balance_counts_and_about_a_shorter_one_each_does():
    hides, short = 1.05 * HIDES / BAND, 0.95 * HIDES / BAND
    (p,) = inverse_dynamics([made(((2.0, 2.0 + hides), (4.0, 4.0 + short)))], BAND)
    assert p.counts.shape == (2, TIME.size) and np.array_equal(*p.counts)
    left_out = TIME[~p.counts[0]]
    assert left_out[[0, -1]] == pytest.approx([2.0 - ABOUT / BAND, 2.0 + hides + ABOUT / BAND], abs=1.5 * DT)
    assert left_out.size == pytest.approx((hides + 2 * ABOUT / BAND) / DT, abs=2)
    (whole,) = inverse_dynamics([made(((4.0, 4.0 + short),))], BAND)
    assert whole.counts is None


def test_what_does_not_count_for_another_reason_does_not_count_beside_a_gap_either():
    m = motion(made(((2.0, 2.05),)), BAND)
    rests = np.ones((2, TIME.size), dtype=bool)
    rests[0, 5000:5100] = False
    p = InverseDynamics(m, counts=rests)
    assert not p.counts[0, 5000:5100].any() and p.counts[1, 5000:5100].all()
    assert not p.counts[:, 2020].any() and rests[:, 2020].all()


def test_a_record_at_a_lower_rate_has_its_gaps_where_they_were():
    (p,) = inverse_dynamics([made(((2.0, 2.05),))], BAND)
    thin = thin_one(p)
    assert thin.motion.dt > p.motion.dt
    share = [1.0 - q.counts[0].mean() for q in (p, thin)]
    assert share[1] == pytest.approx(share[0], rel=0.1)


def test_of_a_log_that_is_mostly_gaps_nothing_is_left_out():
    many = tuple((t, t + 0.02) for t in np.arange(0.1, 7.9, 0.03))
    (p,) = inverse_dynamics([made(many)], BAND)
    assert p.counts is None


@pytest.mark.parametrize(("band", "left_out"), [(50.0, True), (20.0, False)])
def test_a_turn_in_a_gap_leaves_no_moment_where_the_band_would_show_it(tmp_path, band, left_out):
    """20 N turn within a sample, of which straight lines make 9 ms: at 50 Hz that is no small part of the band."""
    turns = [(round(k / 3.0 / DT) - 3, round(k / 3.0 / DT) + 5) for k in (4, 7, 11)]
    campaign = slide(tmp_path, turns, band)
    record = next(r for r in campaign.records if r.role == IDENTIFICATION)
    assert len(record.unseen) == 3
    (said,) = campaign.findings
    assert "its 3 gaps is not known" in said.sentence and "no error counts about one" in said.sentence
    inverses = inverse_dynamics(campaign.records, band)
    fit = identify(campaign.plant, inverses)
    assert (inverses[0].counts is not None) == left_out
    straight = [InverseDynamics(motion(replace(r, unseen=()), band)) for r in campaign.records]
    bent = identify(campaign.plant, straight)
    ratio = fit.identification / bent.identification
    assert ratio < 0.2 if left_out else ratio == pytest.approx(1.0)
