"""The benchmark of the trace: how campaigns are drawn, judged and counted; and a few of them, as everyone's quick subset."""

import json
from collections import Counter
from dataclasses import asdict, dataclass, replace
from inspect import signature
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import trace as bench
from benchmarks._trace_copies import COPIES, NOISE
from benchmarks._trace_draw import NONE, OUTSIDE, PAIR, SINGLE, clash, spec, specs
from benchmarks._trace_families import cases, known, placed
from benchmarks._trace_families import judged as of_family
from benchmarks._trace_ledger import ledger
from benchmarks._trace_measured import judged_axis
from benchmarks._trace_peers import greedy, sparse
from benchmarks._trace_private import changed, deciding, numbers
from benchmarks._trace_rules import RULES, in_its_place, listening, right, rule, same
from benchmarks._trace_run import judged, moved, one, place_right, seen
from benchmarks._trace_sweep import again as decided_again
from benchmarks._trace_sweep import sweep as sweep_of
from benchmarks._trace_sweep import varied
from benchmarks._trace_table import interval, table
from benchmarks.trace import read
from workbench.definition import find
from workbench.plant import ONE_MASS, Plant
from workbench.record import Record

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


# --- families -----------------------------------------------------------------------------------------------------------

SAID = {
    "verdict": "cause", "ranked": ["gravity", "cogging"], "added": ["gravity"], "rivals": [], "causes": [], "moved": [], "unknown": {},
    "before": {"identification": 0.06, "validation": 0.05}, "after": {"identification": 0.02, "validation": 0.02},
    "floor": {"identification": 0.02, "validation": 0.02}, "peers": {"greedy, BIC": ["gravity"]}, "seconds": 1.0, "megabytes": 300.0,
}  # fmt: skip
TRUTH = {"missing": ["gravity"], "nrmse_declared": 0.05, "nrmse_true": 0.01}


def kept(family: str, name: str, truth: dict, said: dict) -> dict:
    return {"family": family, "name": name, "truth": truth, "said": said, "judged": of_family(truth, said, None)}


def test_a_campaign_of_any_family_is_judged_by_its_truth():
    j = of_family(TRUTH, SAID, None)
    assert j["of"] == SINGLE and j["first"] and not j["false"] and not j["nothing"] and not j["below"]
    assert j["share"] == pytest.approx(0.75)
    wrong = of_family(TRUTH | {"missing": ["creep", "inertia"]}, SAID, None)
    assert wrong["of"] == PAIR and not wrong["first"] and wrong["false"] == ["gravity"] and wrong["share"] == 0.0
    missed = of_family(TRUTH | {"missing": ["unknown"]}, SAID | {"verdict": "nothing_missing", "added": []}, None)
    assert missed["of"] == OUTSIDE and missed["nothing"] and not missed["unknown"]
    assert of_family(TRUTH | {"missing": []}, SAID, None)["alarm"]
    assert of_family(TRUTH, SAID | {"after": {"identification": 0.01, "validation": 0.06}}, None)["below"]


def test_an_unknown_cause_may_be_placed_in_words_and_have_no_true_error():
    told = {"missing": ["unknown"], "cause": "a neighbour that stamps", "where": "moments, 1.4 s apart"}
    said = SAID | {"verdict": "unknown", "added": [], "unknown": {"coordinate": "time"}}
    found = of_family(told, said, placed(told, said, None))
    assert found["unknown"] and found["place"] is None and found["share"] is None


def test_a_fixed_value_that_moves_unnamed_is_seen():
    def fit(value):
        return SimpleNamespace(
            estimates=[SimpleNamespace(effect="inertia", at="axis", parameter="inertia", value=value, fixed=True)]
        )

    assert moved(fit(1.0), fit(1.1), set()) == ["inertia at axis: inertia"]
    assert moved(fit(1.0), fit(1.0), set()) == moved(fit(1.0), fit(1.1), {"inertia"}) == []


def added(effect: str, at: str, **parameters) -> dict:
    return SAID | {
        "ranked": [effect],
        "added": [effect],
        "causes": [{"effect": effect, "at": at, "parameters": parameters}],
    }


def test_a_measured_axis_is_right_by_its_table():
    late = added("clock_skew", "sensor.load_position", offset=2.95e-3)
    assert judged_axis("kr300_axis1", late)["right"]
    assert (
        "ms late" in judged_axis("kr300_axis3_JmJl", added("clock_skew", "sensor.load_position", offset=1e-3))["wrong"]
    )
    assert not judged_axis("kr300_axis1", added("clock_skew", "sensor.position", offset=2.95e-3))["right"]
    assert not judged_axis("kr300_axis1", late | {"moved": ["inertia at motor: inertia"]})["right"]
    assert judged_axis("xl330", added("gravity", "axis", mgl=0.47))["right"]
    assert not judged_axis("xl330", added("gravity", "axis", mgl=0.47) | {"added": ["gravity", "creep"]})["right"]
    rubs = SAID | {"added": ["lugre_friction", "backlash"], "after": {"identification": 0.10, "validation": 0.20}}
    assert judged_axis("brfd", rubs)["right"] and not judged_axis("brfd", rubs | {"added": ["lugre_friction"]})["right"]
    assert not judged_axis("brfd", rubs | {"after": {"identification": 0.10, "validation": 0.22}})["right"]


def test_the_ledger_has_a_row_a_family_and_a_line_for_what_is_wrong():
    results = [
        kept("c", "c01", TRUTH, SAID), kept("d", "d01", TRUTH | {"missing": []}, SAID),
        {"family": "d", "name": "d02", "failed": "WorkbenchError: no."},
    ]  # fmt: skip
    text = ledger(results)
    rows = [line for line in text.splitlines() if line.startswith(("| c | 1", "| d | 2"))]
    assert "1/1 [2, 100]" in rows[0] or "1/1 [3, 100]" in rows[0]
    assert "- d d01 lacks nothing: cause, first ['gravity'], added ['gravity']" in text and "- d d02: no trace." in text
    assert "| c | greedy, BIC | 1/1" in text


def test_without_measured_data_only_drawn_families_have_campaigns(monkeypatch):
    monkeypatch.delenv("WORKBENCH_DATA", raising=False)
    found = cases(["c", "d", "measured", "rig", "bench"], 10, 1)
    assert Counter(c.family for c in found) == {"rig": 10, "bench": 10} and len({c.key for c in found}) == 20


@dataclass(frozen=True)
class Criteria:
    least: float = 0.5
    counts: int = 1
    strict: bool = True


def test_a_folder_of_any_other_author_is_a_family(monkeypatch, tmp_path):
    made = tmp_path / "campaigns_x" / "x01" / "campaign.toml"
    made.parent.mkdir(parents=True)
    made.touch()
    monkeypatch.setenv("WORKBENCH_DATA", str(tmp_path))
    assert [(c.family, c.name) for c in cases(["x", "y"], 0, 1)] == [("x", "x01")]


def test_a_sweep_halves_and_doubles_each_number_and_decides_again():
    assert [(n, f, c.least, c.counts) for n, f, c in varied(Criteria())] == [
        ("least", 0.5, 0.25, 1), ("least", 2.0, 1.0, 1), ("counts", 0.5, 0.5, 1), ("counts", 2.0, 0.5, 2),
    ]  # fmt: skip

    def decide(evidence: dict, criteria: Criteria):
        names = ["gravity"] if evidence["share"] >= criteria.least else []
        return SimpleNamespace(verdict="cause" if names else "nothing_missing", ranked=["gravity at axis"], added=names)

    result = kept("c", "c01", TRUTH, SAID | {"evidence": {"share": 0.7}})
    assert decided_again(result, decide, Criteria())["judged"]["first"]
    strict = decided_again(result, decide, Criteria(least=1.0))
    assert strict["judged"]["nothing"] and strict["said"]["ranked"] == ["gravity"]


def test_a_sweep_says_what_it_lacks(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "workbench.tracing.criteria", None)
    assert sweep_of([kept("c", "c01", TRUTH, SAID)]).startswith("No sweep: this version of the trace has no criteria")


# --- the quick subset ---------------------------------------------------------------------------------------------------

PLAIN = {"rate": 1000, "count": 4.848e-6, "memory": 0.0, "noise": 2e-3, "band": 150.0, "short": True, "over": 6.0}
FEW = [
    spec(SINGLE, 1, ("cyclic_friction",), ("presliding",)),
    spec(SINGLE, 2, ("encoder_eccentricity",), ("gravity",)),
    spec(SINGLE, 3, ("transport_delay",), ("linear",)),
    spec(PAIR, 4, ("cogging", "nonlinear_viscous_friction"), ("presliding",)),
    spec(NONE, 5, (), ("stribeck",)),
    spec(OUTSIDE, 6, ("rattle",), ("presliding",)),
]


@pytest.mark.parametrize("drawn", FEW, ids=lambda s: "+".join(s.missing) or s.of)
def test_a_campaign_of_the_benchmark_is_traced_as_it_should_be(drawn):
    beside = drawn is FEW[0]  # the peers need no campaign more than once
    result = one(replace(drawn, **PLAIN), beside=beside)
    j = result["judged"]
    assert j["spurious"] == 0 and not j["worse"] and not j["alarm"]
    assert j["unknown"] == (drawn.of == OUTSIDE)
    if drawn.of in (SINGLE, PAIR):
        assert j["first"] and j["both"] and j["share"] > 0.95
    assert set(result["said"]["peers"]) == ({"greedy, BIC", "PySINDy"} if beside else set())
    assert json.loads(json.dumps(result)) and table([result]).startswith("1 campaigns")


def test_friction_of_the_load_is_named_though_the_drive_does_not_feel_it():
    asked = {"rate": 2000, "noise": 1.075e-3, "memory": 6.55e-3, "band": 100.0, "ratio": 30.0, "over": 2.21}
    result = one(
        replace(spec(SINGLE, 101032, ("presliding_hysteresis@load",), ("elastic",)), **(PLAIN | asked)), beside=False
    )
    before, after = (result["said"][k]["identification"] for k in ("before", "after"))
    assert result["judged"]["first"] and result["judged"]["spurious"] == 0
    assert after == pytest.approx(before, rel=0.02)


# --- private numbers ------------------------------------------------------------------------------------------------------


def test_a_private_number_is_changed_wherever_it_was_imported_to_and_put_back():
    from workbench.tracing import greedy, unexplained

    before = unexplained.PLAIN
    with changed("unexplained", "PLAIN", 7.0):
        assert unexplained.PLAIN == greedy.PLAIN == 7.0
    assert unexplained.PLAIN == greedy.PLAIN == before


def test_of_many_numbers_those_that_decide_are_found_by_halving_groups():
    asked = []

    def differs(group):
        asked.append(group)
        return bool({3, 77} & set(group))

    assert list(deciding(range(100), differs)) == [3, 77] and len(asked) < 30
    assert list(deciding(range(100, 200), differs)) == []


def test_numbers_of_one_name_in_two_modules_are_two():
    from workbench.residual import change_points, localisation

    with changed("change_points", "MOST", 1):
        assert change_points.MOST == 1 != localisation.MOST
    named = [(module, name) for module, name, _ in numbers()]
    assert len(set(named)) == len(named) > 50 and ("ranking", "BEHIND") in named


# --- rules ----------------------------------------------------------------------------------------------------------------


def test_what_stands_for_a_rule_takes_what_the_rule_takes():
    for name, without in RULES.items():
        asked = signature(rule(name)).parameters.values()
        given = [object() for p in asked if p.default is p.empty]
        signature(without).bind(*given)
        assert len(given) == len([p for p in asked if p.kind is p.POSITIONAL_OR_KEYWORD and p.default is p.empty])


def test_a_rule_is_left_out_wherever_it_was_imported_to_and_put_back():
    from workbench.tracing import ranking, spellings

    before = ranking.absurd
    with in_its_place(before, RULES["ranking.absurd"]):
        assert spellings.absurd is ranking.absurd is not before
    assert spellings.absurd is ranking.absurd is before


def test_a_rule_is_heard_where_its_answer_is_not_that_of_its_lack():
    from workbench.tracing import discs, in_turn

    with listening() as heard:
        assert in_turn.later([], SimpleNamespace(roles=())) == []
        assert discs.of_the_disc(find("kinematic_error"), "sensor.position", Plant(ONE_MASS, (), rotary=True))
    assert heard == {"discs.of_the_disc"}


def test_answers_with_the_same_additions_differ_where_these_are_weighed_otherwise():
    one, other = SimpleNamespace(added=[3], weighed=(1.0,)), SimpleNamespace(added=[3], weighed=(2.0,))
    assert same(one, one) and not same(one, other) and not same(SimpleNamespace(added=[3]), SimpleNamespace(added=[4]))


def test_a_verdict_is_right_with_all_that_was_added_and_of_an_unknown_cause_with_nothing():
    assert right({"missing": ["cogging"]}, "cause", ("cogging",))
    assert right({"missing": ["cogging"]}, "cause", ("cogging", "creep")) is False
    assert right({"missing": ["unknown"]}, "unknown", ()) and right({"missing": []}, "nothing_missing", ())
    assert right({"missing": ["unknown"]}, "cause", ("creep",)) is False and right(None, "unknown", ()) is None


def test_a_folder_is_found_as_it_is_named_or_below_the_data(tmp_path, monkeypatch):
    (tmp_path / "campaigns" / "c01").mkdir(parents=True)
    (tmp_path / "campaigns" / "c01" / "campaign.toml").touch()
    monkeypatch.setenv("WORKBENCH_DATA", str(tmp_path))
    assert bench.folder("campaigns/c01") == tmp_path / "campaigns" / "c01"
    with pytest.raises(SystemExit, match="holds no campaign.toml, nor does"):
        bench.folder("campaigns/c02")


def test_a_flank_pushes_and_lets_go_and_nothing_is_felt_within_the_play():
    """Friction behind play: along the far way it is 1, in the play 0, and it never pulls."""
    from rig.bench.kernel import met

    z, half = np.zeros(1), 1.0
    bristles = np.array([[0.1, 1.0]])
    side, room, felt = 0.0, half, []
    for way in (*(0.05,) * 60, *(-0.05,) * 60):
        force, side, room = met(z, bristles, side, room, way, half)
        felt.append(force)
    forward, backward = np.array(felt[:60]), np.array(felt[60:])
    assert forward[-1] == 1.0 and backward[-1] == -1.0
    assert (forward >= 0.0).all()
    empty = np.count_nonzero(backward == 0.0) * 0.05
    assert abs(empty - 2.0 * half) < 0.2


# --- copies ---------------------------------------------------------------------------------------------------------------


def test_a_copy_is_of_half_the_rate_noisier_or_its_records_have_changed_roles():
    t = 1e-3 * np.arange(400)
    channels = {"torque": np.sin(9.0 * t), "position": np.sin(3.0 * t)}
    whole = [
        Record(n, r, t, dict(channels))
        for n, r in (("a", "identification"), ("b", "identification"), ("c", "validation"))
    ]
    half, noisy, swapped = (COPIES[how](whole) for how in ("half", "noise", "swapped"))
    assert all(np.array_equal(r.channels["torque"], channels["torque"][::2]) and r.time[1] == 2e-3 for r in half)
    apart = noisy[1].channels["torque"] - channels["torque"]
    assert np.std(apart) == pytest.approx(NOISE * np.sqrt(np.mean(channels["torque"] ** 2)), rel=0.2)
    assert np.array_equal(noisy[1].channels["position"], channels["position"])
    assert [r.role for r in swapped] == ["identification", "validation", "identification"]
    assert [r.role for r in COPIES["swapped"](whole[1:])] == ["validation", "identification"]


def test_copies_of_a_folder_are_families(monkeypatch, tmp_path):
    (tmp_path / "campaigns_q" / "q1").mkdir(parents=True)
    (tmp_path / "campaigns_q" / "q1" / "campaign.toml").touch()
    monkeypatch.setenv("WORKBENCH_DATA", str(tmp_path))
    assert [(c.family, c.name) for c in cases(["q:half"], 1, 1)] == [("q:half", "q1")]
    asked = {f: known(f) for f in ("q", "q:half", "d:half", "q:mirrored", "measured:half", "rig:half", "r:half", "r")}
    assert [f for f, there in asked.items() if there] == ["q", "q:half", "d:half"]
