"""What a trace says where it has no cause to name: "unknown" with its place, or nothing missing with what would have shown."""

from dataclasses import replace
from pathlib import Path

import pytest
import rig

from benchmarks._trace_run import place_right, ranges
from workbench.campaign import load
from workbench.inverse.dynamics import inverse_dynamics
from workbench.tracing.result import NOTHING, UNKNOWN
from workbench.tracing.tracing import trace

# What is missing, of which machine, the seed of the rig, and the coordinate and way of motion in which it lives.
OUTSIDE = [
    ("slip@joint", "two mass", 37, "time", "either direction"),
    ("hard_spot", "presliding", 7, "position", "backward"),
    ("window_friction", "two mass", 8, "position", "forward"),
    ("rattle", "presliding", 9, "velocity", "either direction"),
    ("missed_counts", "presliding", 10, "time", "either direction"),
    ("fan", "presliding", 11, "time", "either direction"),
]


@pytest.mark.parametrize(("name", "base", "seed", "coordinate", "way"), OUTSIDE, ids=lambda x: str(x))
def test_a_cause_of_the_rigs_own_is_unknown_and_its_place_right_within_a_tenth(
    tmp_path: Path, name, base, seed, coordinate, way
):
    truth = rig.campaign(tmp_path, seed, (name,), 2.0, base=base, short=True)
    campaign = load(tmp_path)
    found = trace(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth))
    assert found.verdict == UNKNOWN and found.added == ()
    assert found.unknown["coordinate"] == coordinate == truth["where"][0]
    assert found.unknown["direction"] == way
    assert place_right(truth["where"], found.unknown, ranges(campaign), truth["metres"])


def test_of_a_joint_that_slips_now_and_then_most_of_the_moments_that_are_stated_are_slips(tmp_path):
    """A record's beginning is stated, too; so not every one is."""
    truth = rig.campaign(tmp_path, 31, ("slip@joint",), 2.0, base="two mass", short=True)
    campaign = load(tmp_path)
    found = trace(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth))
    assert found.verdict == UNKNOWN and found.added == () and found.unknown["coordinate"] == "time"
    near = [min(abs(low - at) for at, _ in truth["where"][1]) < 0.1 for low, _ in found.unknown["spans"]]
    assert sum(near) >= 6 and sum(near) > 0.6 * len(near)


@pytest.mark.parametrize(("base", "seed"), [("presliding", 301), ("gravity", 303), ("two mass", 302)])
def test_the_floor_is_a_little_less_than_what_a_right_model_leaves(tmp_path, base, seed):
    """Nothing is missing, so what is left on the records is noise and counts: it is named as that, and nothing is added."""
    rig.campaign(tmp_path, seed, (), base=base, short=True)
    campaign = load(tmp_path)
    found = trace(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth))
    assert found.verdict == NOTHING and found.added == () and found.unknown == {}
    for role, left in (("identification", found.before.identification), ("validation", found.before.validation)):
        assert 0.75 * left < found.floor[role] < 1.1 * left
    judged = {c.effect for c in found.ranked}
    shown = {s.effect for s in found.smallest}
    assert shown <= judged and len(shown) > 0.8 * len(judged)
    assert all(s.value > 0.0 for s in found.smallest)
    assert "The least that these records would have shown" in found.sentence


@pytest.mark.parametrize(("times", "counts"), [(0.5, False), (2.0, True)])
def test_the_smallest_effect_that_would_have_shown_is_where_one_begins_to_count(tmp_path, times, counts):
    """A constant torque is added to the records: of half the size that was stated it does not count, of twice it does."""
    rig.campaign(tmp_path, 301, (), short=True)
    campaign = load(tmp_path)

    def traced(offset: float):
        records = [
            replace(r, channels={**r.channels, "torque": r.channels["torque"] + offset}) for r in campaign.records
        ]
        return trace(campaign.plant, inverse_dynamics(records, campaign.bandwidth), only=("constant_offset",))

    (least,) = traced(0.0).smallest
    assert (least.effect, least.parameter, least.unit) == ("constant_offset", "offset", "N*m")
    assert traced(times * least.value).ranked[0].earns == counts
