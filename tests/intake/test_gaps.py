"""A log with gaps in its samples: cut into records that load, nothing measured across a gap, and what is left out is said."""

import numpy as np
import pytest

from workbench.campaign import load
from workbench.intake.entries import stretches
from workbench.intake.new import new

DT = 1e-3
TIME = DT * np.arange(6000)


def log(path, keep, t=TIME):
    q = sum(np.sin(2 * np.pi * f * t + f) / f for f in (0.7, 2.1, 5.3))
    torque = 0.02 * np.gradient(np.gradient(q, DT), DT) + 0.1 * np.gradient(q, DT)
    np.savetxt(path, np.column_stack([t, q, torque])[keep], "%.9g", ",", header="t[s],q[rad],torque[Nm]", comments="")
    return path


def without(*gaps) -> np.ndarray:
    """Which samples are left of the log without these (from, until) samples."""
    keep = np.ones(TIME.size, dtype=bool)
    for a, b in gaps:
        keep[a:b] = False
    return np.flatnonzero(keep)


@pytest.mark.parametrize("gaps", [[(2000, 2500)], [(1500, 1600), (4000, 4011)]], ids=["one", "two"])
def test_a_log_is_cut_at_its_gaps_and_every_other_sample_is_in_one_record(tmp_path, gaps):
    keep = without(*gaps)
    made = new(tmp_path / "study", [log(tmp_path / "run.csv", keep)])
    campaign = load(tmp_path / "study" / "campaign")
    assert [r.name for r in campaign.records] == [f"run_{k + 1}" for k in range(len(gaps) + 1)]
    assert np.concatenate([r.time for r in campaign.records]) == pytest.approx(TIME[keep])
    assert [r.role for r in campaign.records].count("validation") == 1 and not campaign.findings
    assert sum("cut at a gap" in line for line in made.lines) == len(gaps) + 1


def test_what_is_too_short_for_a_record_is_left_out_and_said_and_one_that_is_left_is_parted(tmp_path):
    made = new(tmp_path / "study", [log(tmp_path / "run.csv", without((90, 200)))])
    records = load(tmp_path / "study" / "campaign").records
    assert [r.name for r in records] == ["run_first", "run_second"] and records[0].time[0] == pytest.approx(0.2)
    assert (
        records[1].time[-1] == pytest.approx(TIME[-1]) and "\n".join(made.lines).count("90 samples are left out") == 1
    )


def test_of_two_logs_one_with_a_gap_makes_two_records(tmp_path):
    new(tmp_path / "study", [log(tmp_path / "a.csv", without((3000, 3300))), log(tmp_path / "b.csv", without())])
    assert [r.name for r in load(tmp_path / "study" / "campaign").records] == ["a_1", "a_2", "b"]


def test_a_clock_is_cut_in_the_middle_of_gaps_longer_than_ten_steps_and_kept_whole_where_nothing_is_long_enough():
    (whole,) = stretches(0, TIME[without((1000, 1008))])
    assert whole.whole and whole.time.size == TIME.size - 8
    first, last = stretches(3, TIME[without((1000, 2000))])
    assert first.until == last.since == pytest.approx(1.4995) and (first.survey, first.samples.stop) == (3, 1000)
    torn = np.flatnonzero(np.arange(TIME.size) % 60 < 40)
    assert [s.whole for s in stretches(0, TIME[torn])] == [True]
