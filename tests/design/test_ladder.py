"""A gain table judged over the ladder: the moves, the figures of a step, the table's shape, references that none beats."""

from dataclasses import replace

import numpy as np
import pytest
from paper_axis import LOOP, plant

from workbench.control.notched import coefficients, numbers_of
from workbench.description import Equivalent
from workbench.design.against import Against
from workbench.design.climb import Climbing, climb
from workbench.design.families.family import pd_family
from workbench.design.families.gain_table import fixed_family, gain_table, switched_family, table_family, without_notch
from workbench.design.families.linear import Linear
from workbench.design.families.shaped import shaped
from workbench.design.figures import step_figures
from workbench.design.ladder import PHASES, all_rungs, climbed, corners, ladder
from workbench.design.regret import BEATEN, Regret, cost, first_grid, prices, raised, references, regret
from workbench.design.wording import worth_sentence
from workbench.design.worth import regret_of, rivals
from workbench.task.task import Task, Weights
from workbench.tuning import sampled
from workbench.tuning.axis import Axis

COUNT = LOOP.count
AMPLITUDES = np.geomspace(1e-5, 2.5, 20)
SPRING = Equivalent(AMPLITUDES, 95.0 / (1.0 + 600.0 * AMPLITUDES), 0 * AMPLITUDES)
LINEAR = Linear(LOOP, 0.0074, 0.0, np.array([0.0, 95.0]), SPRING)
FIXED = shaped(lambda judge: pd_family(judge, (400.0, 8.0)), LINEAR, 1e-4, (260.0, 0.8))
OWN = 1e-4, 300.0, 0.8  # filter and notch of a table
GAINS = type("Gains", (), {"amplitude": AMPLITUDES, "kp": 2000 / (1 + 4 * AMPLITUDES), "kd": 7.0 + 0 * AMPLITUDES})


@pytest.fixture(scope="module")
def task() -> Task:
    return Task(plant(), LOOP, 0.05, 0.2, frictions=(0.5, 1.5), inertias=(0.5, 1.0, 1.5), weights=Weights(error=0.4))


@pytest.fixture(scope="module")
def short(task):
    return ladder(task, 0.15, scenarios=((1.0, 1.0),), sizes=2)


def test_the_ladder_goes_from_ten_counts_to_the_step_both_ways_from_rest_and_back_with_and_without_load(task):
    on = ladder(task)
    steps = [m for m in on.moves if m.kind == "step"]
    sizes = np.unique(np.round([abs(m.size) / COUNT for m in steps], 6))
    assert sizes.size == 9 and sizes[0] == pytest.approx(10.0) and sizes[-1] * COUNT == pytest.approx(0.05)
    for size in sizes:
        own = {(np.sign(m.size), m.load > 0.0, m.history) for m in steps if abs(m.size) / COUNT == pytest.approx(size)}
        assert len(own) == 8
    assert {m.kind for m in on.moves} == {"step", "sine", "load"}
    assert corners(task) == ((1.0, 1.0), (0.5, 0.5), (0.5, 1.5), (1.5, 0.5), (1.5, 1.5))


def test_a_rung_goes_to_its_size_and_back(short):
    r = short.reference(0, int(short.samples[0]))
    assert r[short.hold[0] - 1] == 0.0 and r[short.hold[0]] == short.rungs[0][0].size and r[-1] == 0.0
    assert np.count_nonzero(r) == short.half[0]


def test_two_counts_of_a_short_step_are_a_hundredth_of_a_long_one():
    n, dt = 1000, 1e-3
    t = np.arange(n)[:, None]
    small = np.where(t < 10, 0.0, 10 * COUNT) + np.where((t > 20) & (t < 40), 1.9 * COUNT, 0.0)
    time, error, over = step_figures(small, 10 * COUNT, 10 * COUNT, COUNT, dt)[0]
    assert time == pytest.approx(0.0098, abs=1e-9) and error == pytest.approx(0.0, abs=1e-15)
    assert over == pytest.approx(0.0095)
    large = 0.01 * (1 - np.exp(-t / 50.0)) * np.ones((1, 2)) + np.array([0.0, 1e-3]) * (t == 300)
    figures = step_figures(large, 0.01, 0.01, COUNT, dt)
    assert figures[0, 0] == pytest.approx(0.05 * np.log(100), rel=2e-3) and figures[0, 2] < 1e-6
    assert figures[1, 0] == pytest.approx(0.3, abs=0.002) and figures[1, 2] == pytest.approx(0.1, rel=0.05)
    assert np.isinf(step_figures(np.where(t > 950, 0.0, 0.01), 0.01, 0.01, COUNT, dt)).all()


def test_a_loop_that_plays_within_two_counts_is_at_rest_about_their_middle():
    t = np.arange(1000)[:, None]
    play = np.where(t < 10, 0.0, 40 * COUNT + 1.9 * COUNT * (-1.0) ** t)
    time, error, over = step_figures(play, 40 * COUNT, 40 * COUNT, COUNT, 1e-3)[0]
    assert time == pytest.approx(0.0097, abs=3e-4) and error == pytest.approx(1.9 * COUNT) and over < 0.01
    assert np.isinf(
        step_figures(play + 0.2 * COUNT * (play - 40 * COUNT) / COUNT, 40 * COUNT, 40 * COUNT, COUNT, 1e-3)
    ).all()


def test_landings_that_no_search_knew_are_others(short):
    own, other = (np.arange(m.met) + m.past for m in (short, short.elsewhere))
    assert other.size == 4 * own.size and not set(own) & set(other)
    family, points = pd_family(LINEAR, (400.0, 8.0)), np.array([[1500.0, 7.5]])
    here, there = (climbed(on, family, points, all_rungs(on, points)) for on in (short, short.elsewhere))
    assert (here[0, 0] != there[0, 0]).any()


def test_gains_of_a_table_never_rise_and_are_as_stiff_as_the_sensitivity_allows():
    table = gain_table(LINEAR, AMPLITUDES, 2.5 * COUNT, 2.0)
    family = table_family(table, GAINS, LINEAR, "error", 4.0)
    draw = np.random.default_rng(2)
    points = family.settled(family.start * np.exp(0.4 * draw.standard_normal((20, family.start.size))))
    points = np.clip(points, family.lower, family.upper)
    kp, kd = table.gains(points)
    assert (np.diff(kp, axis=1) <= 0.0).all() and (family.sensitivity(points) <= 2.003).all()
    schedule = table.held(points[0])
    filtered, notch = replace(LOOP, velocity_filter=schedule["velocity_filter"]), schedule["notch"]
    axis = Axis.of(Equivalent(np.array([1.0]), np.zeros(1), np.zeros(1)), 0.0074, 0.0, filtered)
    axis = axis.take(np.zeros(kp[0].size, int)).behind(coefficients(notch, LOOP.sample_time))
    k, d = kp[0] / axis.unit_kp, kd[0] / axis.unit_kd
    peak, _ = sampled.sensitivity_peak(k, d, axis.steps(k), axis.clock)
    assert (peak <= 2.0).all() and peak.max() > 1.98


def test_with_a_wide_notch_a_table_is_half_as_stiff_again_within_the_same_sensitivity():
    stiff = gain_table(LINEAR, AMPLITUDES, 2.5 * COUNT, 2.0).stiff
    ratio = np.array([[20.0, 50.0, 100.0, 200.0]])
    behind, bare = (stiff.along(ratio, np.array([[5e-5, 270.0, depth]])) for depth in (0.55, 1.0))
    assert (behind / bare > 1.45).all()
    family = shaped(lambda judge: pd_family(judge, (400.0, 8.0)), LINEAR, 5e-5, (270.0, 0.55))
    points = np.stack([behind[0], behind[0] / ratio[0], *np.full((4, 3), (5e-5, 270.0, 0.55)).T], axis=1)
    assert family.sensitivity(points) == pytest.approx(2.0, rel=3e-3)


def test_a_ratio_beyond_the_largest_that_acts_is_brought_back_to_it_and_the_gains_stay():
    table = gain_table(LINEAR, AMPLITUDES, 2.5 * COUNT, 2.0)
    family = table_family(table, GAINS, LINEAR, "error", 4.0)
    beyond = family.start[None].copy()
    beyond[:, :-3] = family.upper[:-3]
    settled = family.settled(beyond)
    most = table.stiff.largest(beyond[:, -3:])[0]
    assert (settled[0, :-3] == most).all() and most < family.upper[0]
    for one, other in zip(table.gains(beyond), table.gains(settled), strict=True):
        assert one == pytest.approx(other, rel=1e-9)


def test_every_search_for_a_table_begins_within_its_bounds():
    table = gain_table(LINEAR, AMPLITUDES, 2.5 * COUNT, 2.0)
    fewer = fixed_family(table, GAINS, LINEAR, "error", 0.02), switched_family(table, GAINS, LINEAR, "error")
    for family in (table_family(table, GAINS, LINEAR, "error", 4.0), *fewer):
        assert (family.lower <= family.start).all() and (family.start <= family.upper).all()


def test_a_table_without_a_notch_has_two_numbers_less_and_the_gains_of_a_depth_of_one():
    table = gain_table(LINEAR, AMPLITUDES, 2.5 * COUNT, 2.0)
    whole = table_family(table, GAINS, LINEAR, "error", 4.0)
    bare = without_notch(table, whole)
    assert bare.numbers == whole.numbers[:-2] and bare.start.size == bare.lower.size == whole.start.size - 2
    points = bare.settled(bare.start * np.array([[1.0], [0.7]]))
    same = np.column_stack([points, np.full(2, 300.0), np.ones(2)])
    made = bare.controller(points, 1)
    assert numbers_of(made) is None and bare.sensitivity(points) == pytest.approx(whole.sensitivity(same), rel=1e-12)
    assert made.tables[1].columns["kp"] == pytest.approx(table.gains(same)[0][1], rel=1e-12)
    assert table.held(same[0])["notch"] is None and first_grid(table, notch=False).shape[1] == 3


def test_references_are_raised_by_whichever_point_beats_them_most(short):
    table = gain_table(LINEAR, AMPLITUDES, 2.5 * COUNT, 2.0)
    family = table_family(table, GAINS, LINEAR, "error", 4.0)
    known = references(short, FIXED, first_grid(table)[::60])
    points = family.settled(family.start * np.array([[1.0], [1.3]]))
    figures = climbed(short, family, points, all_rungs(short, points))
    own = prices(short, figures, known.scale).min(axis=0)
    found = raised(short, known, family, points, figures)
    assert (found.cost <= np.where(own < known.cost - BEATEN, own, known.cost)).all()
    assert (found.law == family.name).any() == (own < known.cost - BEATEN).any()


def test_of_references_searched_for_each_move_none_is_beaten_by_the_grid_that_it_came_from(short):
    family = FIXED
    points = first_grid(gain_table(LINEAR, AMPLITUDES, 2.5 * COUNT, 2.0))[::20]
    found = references(short, family, points)
    points = points[family.sensitivity(points) <= 2.002]
    assert (
        prices(short, climbed(short, family, points, all_rungs(short, points)), found.scale).min(axis=0) >= found.cost
    ).all()
    assert np.isfinite(found.cost).all() and (found.error > 0.0).all()


def test_a_search_over_the_ladder_is_the_same_again_and_beats_no_reference(short):
    table = gain_table(LINEAR, AMPLITUDES, 2.5 * COUNT, 2.0)
    starts = [table_family(table, GAINS, LINEAR, "error", ahead) for ahead in (4.0, 2.0)]
    fixed = FIXED, first_grid(table)[::20]
    found, again = (climb(short, starts, fixed, seeds=(1, 2), budget=Climbing(generations=2)) for _ in range(2))
    assert (found.best.point == again.best.point).all() and found.spread >= 1.0
    own = prices(short, found.best.figures, found.references.scale)
    assert (own >= found.references.cost - BEATEN).all()
    assert found.best.value <= found.runs[-1].value and len(found.runs) == 2
    worst = found.regret.worst
    assert worst[0] == found.regret.time.max() and np.isfinite(worst).all()


def test_points_on_rungs_of_their_own_have_the_figures_that_they_have_among_others(short):
    family = pd_family(LINEAR, (400.0, 8.0))
    points = np.array([[1500.0, 7.5], [900.0, 8.0]])
    every = climbed(short, family, points, all_rungs(short, points))
    own = climbed(short, family, points, np.array([[3], [0]]))
    assert own[0, 0] == pytest.approx(every[0, 3], rel=1e-9) and own[1, 0] == pytest.approx(every[1, 0], rel=1e-9)


def test_a_ladder_without_an_encoder_begins_at_a_share_of_the_step(task):
    on = ladder(replace(task, loop=replace(LOOP, resolution=0.0)), 0.1, sizes=2)
    assert min(abs(m.size) for m in on.moves if m.kind == "step") == pytest.approx(5e-7)


def test_steps_of_few_counts_are_met_at_several_phases_of_the_encoder_and_long_ones_at_one(task):
    on = ladder(task)
    few = np.array([r[0].kind == "step" and abs(r[0].size) < 200 * COUNT for r in on.rungs])
    assert (on.phases[few] == PHASES).all() and (on.phases[~few] == 1).all() and few.any()


def test_fixed_gains_and_a_switch_are_tables_of_one_and_of_two_ratios():
    table = gain_table(LINEAR, AMPLITUDES, 2.5 * COUNT, 2.0)
    one = fixed_family(table, GAINS, LINEAR, "error", 0.02)
    columns = one.controller(one.start[None, :], 1).tables[0].columns
    assert one.start.size == 4 and np.ptp(columns["kp"]) == 0.0 and np.ptp(columns["kd"]) == 0.0
    two = switched_family(table, GAINS, LINEAR, "error")
    kp, kd = table.switched(np.array([[200.0, 50.0, 1e-3, *OWN]]))
    assert np.unique(np.round(kp / kd, 6)).size == 2 and (np.diff(kp) <= 0.0).all()
    assert two.settled(np.array([[50.0, 200.0, 1e-3, *OWN]]))[0].tolist() == [50.0, 50.0, 1e-3, *OWN]
    assert two.lower[2] == table.knots[0] and two.upper[2] == table.knots[-1]


def test_what_has_fewer_levels_is_tuned_alike_and_the_sentence_says_who_is_behind(short):
    table = gain_table(LINEAR, AMPLITUDES, 2.5 * COUNT, 2.0)
    start = table_family(table, GAINS, LINEAR, "error", 4.0)
    found = climb(short, [start], (FIXED, first_grid(table)[::20]), seeds=(1,), budget=Climbing(generations=1))
    fixed = rivals(found, (fixed_family(table, GAINS, LINEAR, "error", 0.02),), Climbing(generations=1)).found[0]
    own = regret_of(short, fixed, found.references)
    assert own.time.shape == found.regret.time.shape and list(fixed.numbers) == [
        "ratio",
        "velocity_filter",
        "notch",
        "notch depth",
    ]
    ours, behind = (Regret(np.full((1, 2), v), np.ones((1, 2)), np.zeros((1, 2))) for v in (1.2, 1.5))
    assert "is worth its schedule" in worth_sentence(ours, {"fixed gains": behind})
    assert "against fixed gains the description's curve buys nothing" in worth_sentence(ours, {"fixed gains": ours})
    lost = Regret(np.array([[1.0, np.nan]]), np.array([[1.0, np.inf]]), np.zeros((1, 2)))
    said = worth_sentence(ours, {"fixed gains": lost})
    assert "fixed gains no rest on 1 of 2 moves" in said and "is worth its schedule" in said and "nan" not in said


def test_points_that_are_given_up_are_those_that_cost_more_and_all_others_have_the_figures_of_the_whole_ladder(short):
    table = gain_table(LINEAR, AMPLITUDES, 2.5 * COUNT, 2.0)
    family = table_family(table, GAINS, LINEAR, "error", 4.0)
    draw = np.random.default_rng(3)
    points = family.settled(family.start * np.exp(0.6 * draw.standard_normal((8, family.start.size))))
    known = references(short, FIXED, first_grid(table))
    whole = climbed(short, family, points, all_rungs(short, points))
    costs = cost(regret(short, whole, known))
    most = float(np.median(costs))
    against = Against(short, family, known, together=16)
    kept = costs <= most
    for members in (None, whole[:3]):
        found = against.tried(points, most, members)
        assert (found.figures[kept] == whole[kept]).all() and (found.costs[kept] == costs[kept]).all()
        assert np.isinf(found.costs[~kept]).all()
        assert (found.figures[~kept] == 0.0).any(), "some rungs were spared"
    rest = against.tried(points[:1], np.inf, whole[1:2], np.array([2])).figures
    assert (rest[0, 2] == whole[0, 2]).all() and (rest[0, 3:] == whole[1, 3:]).all()
