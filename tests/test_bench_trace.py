"""The benchmark of the trace: how campaigns are drawn, judged and counted; and a few of them, as everyone's quick subset."""

import json
from collections import Counter
from dataclasses import asdict, replace
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import trace as bench
from benchmarks._trace_draw import NONE, OUTSIDE, PAIR, SINGLE, clash, spec, specs
from benchmarks._trace_peers import greedy, sparse
from benchmarks._trace_run import judged, one, place_right, seen
from benchmarks._trace_table import interval, table
from benchmarks.trace import read

# --- drawing ------------------------------------------------------------------------------------------------------------


def test_every_kind_is_drawn_as_often_as_the_others_and_no_pair_clashes():
    drawn = specs(400, 3)
    assert drawn == specs(400, 3) != specs(400, 4)
    assert len({s.key for s in drawn}) == len(drawn) == 400
    assert [len(specs(n, 1)) for n in (1, 2, 6, 20, 37)] == [1, 2, 6, 20, 37]
    singles = Counter(s.missing[0] for s in drawn if s.of == SINGLE)
    assert max(singles.values()) - min(singles.values()) <= 1
    pairs = [s for s in drawn if s.of == PAIR]
    assert pairs and not any(clash(*s.missing) for s in pairs)
    assert {s.missing for s in drawn if s.of == NONE} == {()}
    assert not any(s.two for s in specs(60, 3, two_mass=False)) and all(s.two for s in specs(60, 3, two_mass=True))


# --- judging ------------------------------------------------------------------------------------------------------------


def test_a_share_has_clopper_and_pearsons_interval():
    """Closed forms at none and all; 5 of 10 as the tables of 1934 have it."""
    assert interval(0, 20) == (0.0, pytest.approx(1 - 0.025 ** (1 / 20)))
    assert interval(20, 20) == (pytest.approx(0.025 ** (1 / 20)), 1.0)
    assert interval(5, 10) == (pytest.approx(0.187, abs=5e-4), pytest.approx(0.813, abs=5e-4))


def test_a_place_is_right_within_a_tenth_of_the_range():
    span, where = {"position": (-2.0, 2.0)}, ("position", [(-0.5, 0.1)])
    said = {"coordinate": "position", "low": -0.8, "high": 0.4}
    assert place_right(where, said, span, 1.0)
    assert not place_right(where, said | {"low": -1.0}, span, 1.0)
    assert not place_right(where, said | {"coordinate": "velocity"}, span, 1.0)
    assert not place_right(where, said, span, 0.1)  # a linear axis, whose metres are fewer
    speeds = {"coordinate": "velocity", "low": 0.05, "high": 0.11}
    assert place_right(("velocity", [(0.5, 1.1)]), speeds, {"velocity": (-0.2, 0.2)}, 0.1)  # and slower, too
    assert place_right(("command", []), said, span, 1.0) is None
    moments, clock = ("time", [(1.0, 1.1), (2.0, 2.1)]), {"time": (0.0, 100.0)}
    said = {"coordinate": "time", "low": 0.9, "high": 2.2}
    assert place_right(moments, said | {"spans": [[1.9, 2.2]]}, clock, 1.0)
    assert place_right(moments, said | {"spans": [[0.9, 1.0], [1.9, 2.2]]}, clock, 1.0)
    assert not place_right(moments, said | {"spans": [[1.5, 1.6]]}, clock, 1.0)
    assert not place_right(moments, said | {"spans": [[0.9, 1.0], [1.5, 1.6]]}, clock, 1.0)  # every one that is stated
    assert not place_right(
        ("time", [*moments[1], (3.0, 3.1)]), said | {"spans": [[1.9, 2.2]]}, clock, 1.0
    )  # and half of all


def test_what_is_judged_follows_from_what_was_said():
    s = spec(PAIR, 1, ("cogging", "gravity"), ("presliding",))
    truth = {"missing": ["cogging", "gravity"], "also": [], "floor": {"validation": 0.01}}
    said = {
        "verdict": "cause", "ranked": ["gravity", "cogging"], "added": ["gravity", "inertia"], "rivals": [],
        "before": {"validation": 0.05}, "after": {"validation": 0.02},
    }  # fmt: skip
    j = judged(s, truth, said, None)
    assert j["first"] and not j["both"] and j["spurious"] == 1 and not j["worse"]
    assert j["share"] == pytest.approx(0.75)
    assert judged(s, truth, said | {"added": ["inertia"]}, None)["share"] == 0.0
    none = spec(NONE, 1, (), ("presliding",))
    assert judged(none, truth | {"missing": []}, said, None)["alarm"]


def test_a_result_that_a_kill_cut_short_is_done_again(tmp_path):
    whole = {"key": "a", "judged": {"first": True}}
    (tmp_path / "kept").write_text(json.dumps(whole) + "\n" + json.dumps(whole | {"key": "b"})[:-3] + "\n")
    assert read(tmp_path / "kept") == {"a": whole} and read(tmp_path / "none") == {}


def test_a_campaign_of_the_table_is_made_again_by_its_key(tmp_path, monkeypatch, capsys):
    """As a sweep keeps it: a line begins anew where an earlier run was killed in the middle of one."""
    asked = spec(SINGLE, 3, ("transport_delay",), ("linear",))
    monkeypatch.setattr(bench, "KEPT", tmp_path)
    monkeypatch.setattr("benchmarks._trace_run.one", lambda s: {"key": s.key, "same": s == asked})
    (tmp_path / "x.jsonl").write_text(
        '\n{"key": "cut\n' + json.dumps({"key": asked.key, "spec": asdict(asked)}) + "\n", encoding="utf-8"
    )
    bench.again(asked.key)
    assert json.loads(capsys.readouterr().out) == {"key": asked.key, "same": True}
    with pytest.raises(SystemExit, match="no kept campaign has the key 'none'"):
        bench.again("none")


# --- peers --------------------------------------------------------------------------------------------------------------


def test_of_a_time_only_what_records_show_is_asked_for():
    def record(role, low, high):
        return SimpleNamespace(role=role, time=np.arange(low, high + 0.01, 0.5))

    records = [record("identification", 0, 5), record("identification", 7, 9), record("validation", 10, 12)]
    assert seen([(1.5, 6.0)], records) == [(1.5, 5.0)]
    assert seen([(4.0, 8.0)], records) == [(4.0, 8.0)]
    assert seen([(5.5, 6.5), (10.5, 11.0)], records) == []


@pytest.mark.parametrize("peer", [greedy, sparse])
def test_a_peer_finds_a_term_of_its_own_library(peer):
    rng = np.random.default_rng(1)
    x = rng.normal(size=(2000, 6))
    y = 0.5 * x[:, 3] + 0.1 * rng.normal(size=2000)
    assert peer(list("abcdef"), x, y)[:1] == ["d"]


# --- the quick subset ---------------------------------------------------------------------------------------------------

PLAIN = {"rate": 1000, "count": 4.848e-6, "memory": 0.0, "noise": 2e-3, "band": 150.0, "short": True, "over": 6.0}
FEW = [
    spec(SINGLE, 1, ("cyclic_friction",), ("presliding",)),
    spec(SINGLE, 2, ("encoder_eccentricity",), ("gravity",)),
    spec(SINGLE, 3, ("transport_delay",), ("linear",)),
    spec(PAIR, 4, ("cogging", "nonlinear_viscous_friction"), ("presliding",)),
    spec(NONE, 5, (), ("stribeck",)),
    spec(OUTSIDE, 6, ("coarse_torque",), ("presliding",)),
]


@pytest.mark.parametrize("drawn", FEW, ids=lambda s: "+".join(s.missing) or s.of)
def test_a_campaign_of_the_benchmark_is_traced_as_it_should_be(drawn):
    result = one(replace(drawn, **PLAIN))
    j = result["judged"]
    assert j["spurious"] == 0 and not j["worse"] and not j["alarm"]
    assert j["unknown"] == (drawn.of == OUTSIDE)
    if drawn.of in (SINGLE, PAIR):
        assert j["first"] and j["both"] and j["share"] > 0.95
    assert set(result["said"]["peers"]) == {"greedy, BIC", "PySINDy"}
    assert json.loads(json.dumps(result)) and table([result]).startswith("1 campaigns")


def test_friction_of_the_load_is_named_though_the_drive_does_not_feel_it():
    asked = {"rate": 2000, "noise": 1.075e-3, "memory": 6.55e-3, "band": 100.0, "ratio": 30.0, "over": 2.21}
    result = one(replace(spec(SINGLE, 101032, ("presliding_hysteresis@load",), ("elastic",)), **(PLAIN | asked)))
    before, after = (result["said"][k]["identification"] for k in ("before", "after"))
    assert result["judged"]["first"] and result["judged"]["spurious"] == 0
    assert after == pytest.approx(before, rel=0.02)
