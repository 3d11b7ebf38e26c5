"""Robustness: draws, both perspectives, statements with confidence, influence, and worst cases that are replayed."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.control import fixed_pd, pi_cascade, scheduled_pd
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.plant import ONE_MASS, TWO_MASS, Limits, Plant
from workbench.report.contents import Figure, Items
from workbench.robustness import (
    Cases,
    Varied,
    blocks,
    even,
    fixed,
    grid,
    independent,
    influences,
    joined,
    log_uniform,
    normal,
    perspectives,
    share_beyond,
    uniform,
    work,
)
from workbench.robustness import worst as kept
from workbench.robustness.document import of_work, work_of
from workbench.robustness.influence import first_order
from workbench.robustness.local import on_cores
from workbench.robustness.perspective import share_beyond_worst
from workbench.robustness.wording import ranking, statement
from workbench.robustness.workload import Block, digest, probe
from workbench.simulation import Loop
from workbench.study.robustness import declared, robustness
from workbench.task.task import Task

LOOP = Loop(2.5e-4, 2, 2.5e-4, 2.5e-4, 4.848e-6)
SHAPE = (Varied("presliding_hysteresis.x0", log_uniform(0.7, 1.4), relative=True),)
VARIED = (
    Varied("inertia", uniform(0.5, 1.5)),
    Varied("friction", uniform(0.5, 1.5)),
    *SHAPE,
    Varied("presliding_hysteresis.d", uniform(0.8, 1.0)),
    Varied("delay", uniform(0.0, 2.5e-4), unit="s"),
    Varied("phase", uniform(0.0, 1.0)),
    Varied("torque_constant_error.error", normal(0.0, 0.03, -0.1, 0.1)),
    Varied("kinematic_error.amplitude", uniform(0.0, 1e-4), unit="rad"),
    Varied("kinematic_error.order", fixed(100.0), unit="1/rad"),
)


def axis() -> Plant:
    effects = (find("inertia")(inertia=0.0074), find("presliding_hysteresis")(h0=0.15, x0=1 / 636))
    return Plant(ONE_MASS, effects, limits=Limits(3.3, 12.57))


def task(**changed) -> Task:
    return Task(**{"plant": axis(), "loop": LOOP, "step": 0.05, "duration": 0.06, "noise": 2e-3} | changed)


def factories():
    return {
        "fixed PD": lambda lanes: fixed_pd(np.full(lanes, 60.0), np.full(lanes, 1.3)),
        "PI cascade": lambda lanes: pi_cascade(np.full(lanes, 45.0), np.full(lanes, 1.3), np.full(lanes, 6.0), 12.0),
    }


@pytest.fixture(scope="module")
def drawn():
    """96 axes, run in one block."""
    w, cases = work(task(), factories(), VARIED), independent(VARIED, 96, seed=7)
    return w, cases, joined(on_cores(w, blocks(cases)))


# --- distributions ---------------------------------------------------------------------------------------------------


@given(st.floats(0.0, 1.0), st.floats(-5.0, 5.0), st.floats(0.1, 10.0))
def test_a_quantile_lies_within_the_support_and_grows_with_the_share(share, low, width):
    kinds = [uniform(low, low + width), normal(low, width, low - width, low + 3 * width), log_uniform(width, 3 * width)]
    for d in kinds:
        value, more = d.at(np.array([share, min(share + 0.1, 1.0)]))
        assert d.low <= value <= more <= d.high


@pytest.mark.parametrize(
    ("distribution", "reference"),
    [
        (uniform(0.5, 1.5), lambda s: s.uniform(0.5, 1.0)),
        (log_uniform(0.1, 10.0), lambda s: s.loguniform(0.1, 10.0)),
        (normal(1.0, 0.2, 0.8, 1.6), lambda s: s.truncnorm(-1.0, 3.0, loc=1.0, scale=0.2)),
    ],
)
def test_a_distribution_is_that_of_scipy(distribution, reference):
    from scipy import stats

    share = np.linspace(0.001, 0.999, 500)
    assert distribution.at(share) == pytest.approx(reference(stats).ppf(share), rel=1e-12)


@pytest.mark.parametrize("make", [lambda: uniform(2.0, 1.0), lambda: log_uniform(0.0, 1.0), lambda: normal(0.0, 0.0, -1, 1),
                                  lambda: normal(0.0, 1.0, 8.0, 9.0), lambda: uniform(0.0, float("inf"))])  # fmt: skip
def test_numbers_that_make_no_distribution_are_refused(make):
    with pytest.raises(WorkbenchError, match="distribution"):
        make()


# --- draws -----------------------------------------------------------------------------------------------------------


def test_a_draw_depends_on_its_name_seed_and_index_alone():
    few, many = independent(VARIED, 10, 7), independent(VARIED, 1000, 7)
    other = independent(VARIED[::-1], 10, 7)
    assert (few.values == many.values[:10]).all() and (few.values == other.values[:, ::-1]).all()
    assert not (independent(VARIED, 10, 8).values[:, 0] == few.values[:, 0]).any()


def test_draws_of_two_names_are_not_the_same_numbers():
    cases = independent((Varied("inertia", uniform(0, 1)), Varied("friction", uniform(0, 1))), 4000, 1)
    assert abs(np.corrcoef(cases.values.T)[0, 1]) < 0.05


def test_a_grid_is_every_combination_and_quasi_random_points_fill_every_strip():
    two = (Varied("inertia", uniform(0, 1)), Varied("friction", uniform(0, 1)))
    assert grid(two, [(1, 2), (3, 4, 5)]).values.tolist() == [[1, 3], [1, 4], [1, 5], [2, 3], [2, 4], [2, 5]]
    strips = np.floor(even(two, 64, 1).values * 64).astype(int)
    assert all(np.unique(strips[:, k]).size == 64 for k in range(2))
    with pytest.raises(WorkbenchError, match="power of two"):
        even(two, 63, 1)


@pytest.mark.parametrize(
    ("name", "distribution", "words"),
    [
        ("inertja", uniform(0.5, 1.5), ("inertja", "inertia")),
        ("presliding_hysteresis.h", uniform(0.1, 0.2), ("'h'", "'h0'")),
        ("presliding_hysteresis.d", uniform(0.8, 1.2), ("physical bounds", "0.3 to 1")),
        ("inertia", uniform(0.0, 1.0), ("inertia", "physical bounds")),
        ("delay", uniform(-1e-4, 1e-4), ("delay", "bounds")),
    ],
)
def test_what_cannot_vary_is_refused_by_name(name, distribution, words):
    with pytest.raises(WorkbenchError) as caught:
        work(task(), factories(), (Varied(name, distribution),))
    assert all(w in str(caught.value) for w in words)


def test_what_varies_twice_is_refused():
    with pytest.raises(WorkbenchError, match="twice"):
        independent((VARIED[0], VARIED[0]), 10, 1)


# --- runs ------------------------------------------------------------------------------------------------------------


def test_the_numbers_do_not_depend_on_blocks_or_threads(drawn, monkeypatch):
    from workbench.simulation import run

    w, cases, columns = drawn
    monkeypatch.setattr(run, "_CORES", 1)
    assert digest(joined(on_cores(w, blocks(cases, 37)))) == digest(columns)


def test_an_error_of_the_torque_constant_is_the_same_as_all_else_being_off_the_other_way():
    """u' = (1 + e) u moves J, h0 as u moves J/(1 + e), h0/(1 + e), where no limit is met and nothing is quantised."""
    smooth = task(loop=Loop(2.5e-4, 2), step=0.01, noise=0.0)
    gains = {"PD": lambda lanes: fixed_pd(60.0, 1.3)}
    e = 0.25
    one = work(smooth, gains, (Varied("torque_constant_error.error", fixed(e)),)).columns(Block(0, np.array([[e]])))
    both = (Varied("inertia", fixed(1 / (1 + e))), Varied("friction", fixed(1 / (1 + e))))
    two = work(smooth, gains, both).columns(Block(0, np.full((1, 2), 1 / (1 + e))))
    for name in ("final_error", "time_1pct", "overshoot"):
        assert one["PD"][name] == pytest.approx(two["PD"][name], rel=1e-9)


def test_a_gear_error_that_the_encoder_reads_is_in_the_final_error():
    """With stiff gains the reading goes to the target, so what is left of the position is the gear's error there."""
    amplitude, step = 1e-3, 0.05
    t = task(noise=0.0, duration=1.2, loop=Loop(2.5e-4, 2))
    pi = {"PI": lambda lanes: pi_cascade(45.0, 1.3, 20.0, 12.0)}
    named = ("kinematic_error.amplitude", "kinematic_error.phase", "kinematic_error.order")
    phase = (
        np.pi / 2 - 30.0 * step
    )  # sin(order*q + phase) = 1 at the target; at zero, where it was set to zero, it reads zero
    values = np.array([[amplitude, phase, 30.0]])
    out = work(t, pi, tuple(Varied(n, fixed(v)) for n, v in zip(named, values[0], strict=True))).columns(
        Block(0, values)
    )
    assert out["PI"]["final_error"][0] == pytest.approx(amplitude * (1.0 - np.sin(phase)), rel=0.02)


# --- what is said of them --------------------------------------------------------------------------------------------


def independent_of(n: int) -> Cases:
    return independent((Varied("inertia", uniform(0.5, 1.5)),), n, 1)


@pytest.mark.parametrize(("n", "k"), [(100, 0), (100, 1), (10000, 37), (10, 10)])
def test_clopper_pearson_bounds_are_those_of_the_binomial(n, k):
    """At the bound, a binomial has k or fewer with probability 1 %; for k = 0 it is 1 - 0.01^(1/n)."""
    from scipy.stats import binom

    values = np.r_[np.full(k, 2.0), np.zeros(n - k)]
    found = share_beyond(independent_of(n), values, 1.0, 0.99)
    assert found.exceeded == k
    assert found.upper == pytest.approx(1.0 - 0.01 ** (1 / n) if k == 0 else found.upper, rel=1e-9)
    if k == n:
        assert found.upper == 1.0
    else:
        assert binom.cdf(k, n, found.upper) == pytest.approx(0.01, rel=1e-6)


def test_a_statement_holds_as_often_as_it_says():
    """Of 400 experiments on a share of 5 %, no more than about 1 % may give an upper bound below it (binomial, 3 sigma)."""
    cases, rng = independent_of(200), np.random.default_rng(3)
    wrong = sum(share_beyond(cases, rng.random(200) < 0.05, 0.5).upper < 0.05 for _ in range(400))
    assert wrong <= 4 + 3 * np.sqrt(4)


def test_a_run_that_never_settles_exceeds_every_limit():
    found = share_beyond(independent_of(3), np.array([np.inf, np.nan, 0.1]), 1.0)
    assert found.exceeded == 2
    assert "at most 99.7 %" in statement(found, "a limit") and "(2 of 3 draws did)" in statement(found, "a limit")


def test_nothing_is_said_with_confidence_of_a_grid_or_of_quasi_random_points():
    one = (Varied("inertia", uniform(0.5, 1.5)),)
    for cases in (grid(one, [(0.5, 1.0)]), even(one, 2, 1)):
        for said in (lambda c: share_beyond(c, np.zeros(2), 1.0), share_beyond_worst):
            with pytest.raises(WorkbenchError, match="independent draws"):
                said(cases)


def test_the_worst_of_459_draws_bounds_99_percent_of_axes_with_99_percent_confidence():
    """The published sample size of Wilks for 99 %/99 % is 459."""
    assert share_beyond_worst(independent_of(459)) <= 0.01 < share_beyond_worst(independent_of(458))


def test_the_perspectives_can_rank_two_controllers_in_opposite_orders():
    """The paper's Fig. 17, in its own numbers: GS 1 has 0.39e-4 and 0.97e-4 rad, GS 2 2.40e-4 and 2.23e-4, the cascade 1.13e-4 and 8.87e-4."""
    errors = {"GS 1": (0.388e-4, 0.969e-4), "GS 2": (2.404e-4, 2.230e-4), "cascade": (1.131e-4, 8.870e-4)}
    found = {n: perspectives(np.array(e)) for n, e in errors.items()}
    first, second, both = ranking(found, "both loads", "rad")
    assert (
        "GS 1 is the most robust (96.9 µrad)" in first.sentence
        and "GS 2 is the most robust (17.4 µrad)" in second.sentence
    )
    assert "disagree" in both.sentence and found["cascade"].spread == pytest.approx(7.739e-4)


def test_an_error_that_is_not_finite_leaves_no_robustness():
    p = perspectives(np.array([1e-5, np.inf]))
    assert p.maximum == p.spread == np.inf and p.failed == 0.5


# --- influence -------------------------------------------------------------------------------------------------------


def test_first_order_shares_are_those_of_ishigami_and_homma():
    """Published: 0.3139, 0.4424 and 0 for a = 7, b = 0.1 (Ishigami and Homma 1990)."""
    x = np.random.default_rng(5).uniform(-np.pi, np.pi, (20000, 3))
    y = np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    found = [first_order(x[:, k], y, bins=40) for k in range(3)]
    assert found == pytest.approx([0.3139, 0.4424, 0.0], abs=0.015)


def test_a_parameter_that_moves_nothing_has_an_influence_of_zero_within_its_error():
    cases = independent(VARIED[:2] + SHAPE, 4000, 2)
    found = {i.name: i for i in influences(cases, np.exp(3.0 * cases.values[:, 0]) + 1e-3)}
    assert found["inertia"].correlation == pytest.approx(1.0) and found["inertia"].share == pytest.approx(1.0, abs=0.01)
    assert not found["friction"].sure and abs(found["friction"].share) < 4 * found["friction"].share_error


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 1000))
def test_the_standard_error_is_the_scatter_of_the_estimate(seed):
    """Of ten repetitions the scatter is the stated error within a factor that chance explains."""
    rng = np.random.default_rng(seed)
    stated, values = [], []
    for _ in range(10):
        cases = Cases("independent draws", (Varied("inertia", uniform(0, 1)),), rng.random((600, 1)))
        (found,) = influences(cases, cases.values[:, 0] + rng.random(600))
        stated.append(found.correlation_error)
        values.append(found.correlation)
    assert 0.3 < np.std(values, ddof=1) / np.mean(stated) < 2.5


def test_of_a_grid_nothing_is_said_about_influence():
    assert influences(grid((Varied("inertia", uniform(0, 1)),), [np.linspace(0, 1, 100)]), np.zeros(100)) == ()


# --- worst cases -----------------------------------------------------------------------------------------------------


def test_the_worst_cases_are_replayed_from_their_file_to_the_same_bits(drawn, tmp_path):
    w, cases, columns = drawn
    found = kept.worst(cases, columns, 2)
    assert columns["fixed PD"]["final_error"].max() == found[0].metrics["final_error"]
    kept.write(w, found, tmp_path / kept.FILE)
    again, read = kept.read(tmp_path / kept.FILE)
    assert len(read) == 4
    for case in read:
        r = kept.replay(again, case)
        assert r.same and r.trajectories["q"].shape == (240, 1)


def test_a_replay_says_where_the_bits_are_others(drawn, tmp_path):
    w, cases, columns = drawn
    kept.write(w, kept.worst(cases, columns, 1), tmp_path / kept.FILE)
    content = json.loads((tmp_path / kept.FILE).read_text())
    content["cases"][0]["values"]["inertia"] = np.nextafter(content["cases"][0]["values"]["inertia"], 2.0)
    (tmp_path / kept.FILE).write_text(json.dumps(content))
    again, read = kept.read(tmp_path / kept.FILE)
    assert not kept.replay(again, read[0]).same


def test_a_document_is_the_work_it_was_made_of(drawn):
    """A schedule's table among it; the digest of a probe is over every bit."""

    class Schedule:
        knots, kp, kd, rule, reversal = 2.0 ** np.arange(-14, 0), np.geomspace(200, 20, 14), np.geomspace(2, 0.6, 14), "error", None  # fmt: skip

    w = work(
        task(), {**factories(), "scheduled": lambda n: scheduled_pd([Schedule], table=np.zeros(n, dtype=int))}, VARIED
    )
    block = Block(0, independent(VARIED, 8, 3).values)
    again = work_of(json.loads(json.dumps(of_work(w), allow_nan=False)))
    assert probe(again, block) == probe(w, block)
    assert probe(again, Block(1, block.values)) != probe(w, block)  # other seeds of the noise


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"format": 1}', '{"format": 99}'])
def test_a_file_that_holds_no_worst_cases_is_refused_by_name(text, tmp_path):
    (tmp_path / "other.json").write_text(text)
    with pytest.raises(WorkbenchError, match="other.json"):
        kept.read(tmp_path / "other.json")


def test_an_effect_of_ones_own_is_refused_where_it_must_be_known_by_name():
    from workbench.effects.hysteresis import maxwell_slip

    w = work(task(plant=axis() + maxwell_slip((1e-4, 1e-3))), factories(), VARIED[:1])
    with pytest.raises(WorkbenchError, match="maxwell_slip"):
        of_work(w)


# --- a study's declaration, and what it writes -----------------------------------------------------------------------

TOML = """
[robustness]
draws = 64
seed = 3
controllers = ["PI cascade", "fixed PD"]
worst = 1
[robustness.limits]
final_error = { value = 50.0, unit = "urad" }
[robustness.vary]
inertia = { uniform = [0.5, 1.5] }
delay = { uniform = [0.0, 0.1], unit = "ms" }
"presliding_hysteresis.x0" = { normal = [100.0, 10.0], within = [70.0, 140.0], unit = "percent", relative = true }
"kinematic_error.phase" = { value = 90.0, unit = "deg" }
"""


def study(tmp_path, text=TOML):
    from workbench.study import configuration

    (tmp_path / "study.toml").write_text('title = "t"\n' + text)
    return configuration.load(tmp_path)


def test_a_study_declares_what_differs_with_units(tmp_path):
    asked = declared(study(tmp_path).table, task())
    found = {v.name: v for v in asked.varied}
    assert found["delay"].distribution == uniform(0.0, 1e-4) and found["inertia"].distribution == uniform(0.5, 1.5)
    d = found["presliding_hysteresis.x0"].distribution
    assert found["presliding_hysteresis.x0"].relative and (d.mean, d.deviation) == pytest.approx((1.0, 0.1))
    assert found["kinematic_error.phase"].distribution.low == pytest.approx(np.pi / 2)
    assert asked.limits == {"final_error": pytest.approx(5e-5)} and asked.controllers[0] == "PI cascade"


def test_a_temperature_varies_by_degrees_and_its_deviation_by_kelvins(tmp_path):
    for text, low, high in (
        ('{ uniform = [5.0, 45.0], unit = "degC" }', 278.15, 318.15),
        ('{ normal = [20.0, 10.0], within = [-10.0, 40.0], unit = "degC" }', 263.15, 313.15),
    ):
        line = f"{TOML}temperature = {text}\n"
        (one,) = (v for v in declared(study(tmp_path, line).table, task()).varied if v.name == "temperature")
        assert (one.distribution.low, one.distribution.high) == pytest.approx((low, high))
    assert (one.distribution.mean, one.distribution.deviation) == pytest.approx((293.15, 10.0))


def test_gains_that_were_tuned_warm_meet_an_axis_that_is_cold():
    """Friction that falls by a quarter from 20 to 60 degC is in the error of a fixed PD, which leaves friction over stiffness."""
    plant = axis() + find("thermal_friction")(rate=-1e-3, viscous_rate=0.0, bend=1e-4)
    varied = (Varied("temperature", uniform(250.0, 340.0)),)
    w = work(task(plant=plant, noise=0.0, duration=0.3), {"PD": lambda n: fixed_pd(60.0, 1.3)}, varied)
    errors = w.columns(Block(0, 273.15 + np.array([[-20.0], [20.0], [60.0]])))["PD"]["final_error"]
    assert errors[0] > errors[1] > errors[2]


@pytest.mark.parametrize(
    ("was", "becomes", "words"),
    [
        ('unit = "ms"', 'unit = "mm"', ("delay", "unit 'mm'")),
        ("uniform = [0.5, 1.5]", "unifrom = [0.5, 1.5]", ("inertia", "unifrom", "uniform")),
        ("uniform = [0.5, 1.5]", "uniform = [1.5, 0.5]", ("inertia.uniform", "no support")),
        ("uniform = [0.5, 1.5]", "uniform = [0.5]", ("inertia.uniform", "two numbers")),
        ("uniform = [0.5, 1.5]", "uniform = [-0.5, 1.5]", ("inertia", "physical bounds")),
        (", within = [70.0, 140.0]", "", ("within", "two numbers")),
        ("hysteresis.x0", "hysteresis.x1", ("'x1'", "x0")),
        ("final_error =", "final_eror =", ("final_eror", "final_error")),
    ],
)
def test_a_faulty_declaration_is_answered_with_file_and_key(was, becomes, words, tmp_path):
    with pytest.raises(WorkbenchError) as caught:
        declared(study(tmp_path, TOML.replace(was, becomes)).table, task())
    assert all(w in str(caught.value) for w in ("study.toml", *words))


def test_a_study_gets_figures_statements_and_cases_that_the_command_replays(tmp_path, capsys):
    from workbench.cli import main

    text = TOML.replace('"PI cascade", "fixed PD"', '"fixed PD"').replace("worst = 1", "worst = 2")
    part = robustness(study(tmp_path, text), task(), factories(), lambda _: None)
    assert {"grid_error_fixed_pd", "drawn_error_99_percent_fixed_pd", "share_beyond_final_error_fixed_pd"} <= set(
        part.figures
    )
    assert part.units["grid_error_fixed_pd"] == "rad" and "share_beyond_final_error_fixed_pd" not in part.units
    (chapter,) = part.chapters
    drawn = [b for b in chapter.blocks if isinstance(b, Figure)]
    assert len(drawn) == 4 and all(b.svg().startswith(b"<svg") for b in drawn)
    assert any("of axes drawn from the declared distributions at most" in t for b in chapter.blocks if isinstance(b, Items)
               for t in b.texts)  # fmt: skip
    (tmp_path / "out").mkdir()
    for write in part.files:
        write(tmp_path / "out")
    rows = (tmp_path / "out" / "robustness" / "draws.csv").read_text().splitlines()
    assert len(rows) == 65 and len(rows[0].split('","')) == len(rows[1].split(",")) == 8
    file = str(tmp_path / "out" / "robustness" / "worst.json")
    assert main(["replay", file]) == 0 and capsys.readouterr().out.count("to the same bits") == 2
    assert main(["replay", file, "--case", "2", "--out", str(tmp_path / "motion")]) == 0
    assert (tmp_path / "motion" / "motion.csv").read_text().startswith("time,q,y,u\n0.0,")
    assert main(["replay", file, "--case", "3"]) == 2


def test_of_two_masses_the_load_is_what_is_judged_and_replayed(tmp_path):
    effects = (
        find("inertia")(at="motor", inertia=0.0074),
        find("inertia")(at="load", inertia=5.8e-4),
        find("presliding_hysteresis")(at="motor", h0=0.15, x0=1 / 636),
        find("linear_stiffness")(at="joint", stiffness=440.0),
        find("linear_damping")(at="joint", damping=0.02),
    )
    plant = Plant(TWO_MASS, effects, limits=Limits(3.3, 12.57))
    loop = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, 4.848e-6, 4.848e-6)
    vary = (
        Varied("inertia@load.inertia", uniform(0.5, 1.5), relative=True),
        Varied("linear_stiffness.stiffness", uniform(300.0, 800.0)),
        Varied("kinematic_error.amplitude", uniform(0.0, 1e-4)),
        Varied("kinematic_error.order", fixed(100.0)),
    )
    w = work(task(plant=plant, loop=loop), {"fixed PD": lambda lanes: fixed_pd(20.0, 0.6)}, vary)
    assert "kinematic_error@joint" in w.task.plant
    cases = independent(vary, 40, 1)
    columns = joined(on_cores(w, blocks(cases)))
    kept.write(w, kept.worst(cases, columns, 1), tmp_path / "worst.json")
    again, (case,) = kept.read(tmp_path / "worst.json")
    r = kept.replay(again, case)
    assert r.same and not (r.position == r.trajectories["q"][:, 0]).all()
    with pytest.raises(WorkbenchError, match="motor, load"):
        work(task(plant=plant, loop=loop), factories(), (Varied("inertia.inertia", uniform(0.1, 0.2)),))
