"""What counts as explainable: a line that a force makes, and not the hum of the mains, which is told apart; a joint whose stiffness
changes along the stroke, and an inertia or a drive's constant that does."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_joints import BAND as JOINT_BAND
from made_joints import BL, BM, JL, JM, RATE, SOURCE, K, jointed, waved

from workbench.definition import find
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, Record
from workbench.tracing import explainable as X
from workbench.tracing.counted import edge
from workbench.tracing.criteria import Criteria
from workbench.tracing.decimation import decimate
from workbench.tracing.evidence import Explainable
from workbench.tracing.explainable import _bursts, explainable
from workbench.tracing.neighbours import gained
from workbench.tracing.state import State

DT, N, INERTIA, BAND = 1e-3, 20000, 0.02, 90.0
T = DT * np.arange(N)


def left(reported: float, felt: float, frequency: float, samples: int = N) -> Explainable:
    """Return what is explainable of a residual: of a sine in the reported drive alone, and of a force that moves the axis. Sizes in N*m."""
    t, w = T[:samples], 2 * np.pi * frequency
    q = 0.5 * np.sin(3.0 * t) - felt / INERTIA / w**2 * np.sin(w * t)
    drive = -0.5 * 9.0 * INERTIA * np.sin(3.0 * t) + reported * np.sin(w * t)
    drive += 2e-4 * np.random.default_rng(1).standard_normal(samples)
    record = Record("r", IDENTIFICATION, t, {"torque": drive, "position": q})
    plant = Plant(ONE_MASS) + find("inertia")(inertia=INERTIA)
    return explainable(State(plant, inverse_dynamics([record], BAND)), Criteria())


@pytest.mark.parametrize("frequency", [50.0, 59.9])
def test_hum_of_the_mains_in_the_reported_drive_is_not_explainable(frequency):
    assert left(0.005, 0.0, frequency).line == 0.0


@pytest.mark.parametrize(("frequency", "samples"), [(50.0, N), (59.9, N), (50.0, 2900)])
def test_hum_that_a_current_loop_passes_on_to_the_axis_is_told_with_its_size_and_is_no_line(frequency, samples):
    # the sensor's hum is held at zero in the report, so that the motor gives it: the axis feels all, the drive shows none
    found = left(0.0, -0.005, frequency, samples)
    assert found.line == 0.0 and found.size < Criteria().explainable
    assert found.hum == pytest.approx(0.005 / (0.5 * 9.0 * INERTIA), rel=0.1)
    assert found.mains == pytest.approx(frequency, abs=0.2)


def test_a_line_beside_the_mains_is():
    found = left(0.0, 0.005, 43.0)
    assert found.line > 0.02 and found.hum == 0.0


def test_a_pump_that_slips_two_per_cent_behind_the_mains_is():
    assert left(0.0, 0.005, 49.0).line > 0.02


@pytest.mark.parametrize(("rubbing", "found"), [((), True), (("coulomb_friction",), False)])
def test_an_axis_that_has_no_friction_never_stands_still(rubbing, found):
    # a damping that ends in the middle of the travel, on an axis that turns six to ten times a second: where it rubs, each turn shows counts
    t, f = T, 6.0 + 4.0 * T / T[-1]
    phase = 2 * np.pi * np.cumsum(f) * DT
    slow = 0.3 * np.sin(0.7 * t)
    q, v = slow + 0.05 * np.sin(phase), 0.21 * np.cos(0.7 * t) + 0.05 * 2 * np.pi * f * np.cos(phase)
    a = -0.147 * np.sin(0.7 * t) - 0.05 * (2 * np.pi * f) ** 2 * np.sin(phase)
    drive = (
        INERTIA * a
        + 0.1 * v * (1.0 + 0.5 * np.tanh(q / 0.02))
        + 2e-3 * np.random.default_rng(3).standard_normal(t.size)
    )
    record = Record("r", IDENTIFICATION, t, {"torque": drive, "position": q, "reference": q})
    plant = Plant(ONE_MASS) + find("inertia")(inertia=INERTIA) + find("viscous_friction")(viscous=0.1)
    for name in rubbing:
        plant += find(name)()
    size = explainable(State(plant, inverse_dynamics([record], BAND)), Criteria()).exogenous
    assert (size > 0.02) is found


def swayed(frequency: float, seconds: tuple[float, ...]) -> float:
    """Return the line that is explainable, N*m, where the bench sways through all records: the axis feels 5 mN*m that nobody reports."""
    records, begun, w = [], 0.0, 2 * np.pi * frequency
    for k, long in enumerate(seconds):
        t = begun + np.arange(0.0, long, DT)
        q = 0.5 * np.sin(3.0 * t) - 0.005 / INERTIA / w**2 * np.sin(w * t)
        drive = -0.5 * 9.0 * INERTIA * np.sin(3.0 * t) + 2e-4 * np.random.default_rng(k).standard_normal(t.size)
        channels = {"torque": drive, "position": q, "reference": 0.5 * np.sin(3.0 * t)}
        records.append(Record(f"r{k}", IDENTIFICATION, t, channels))
        begun = t[-1] + 3.0
    state = State(Plant(ONE_MASS) + find("inertia")(inertia=INERTIA), inverse_dynamics(records, BAND))
    return explainable(state, Criteria()).line * np.sqrt(state.power / sum(r.time.size for r in records))


def test_a_line_is_of_all_records_in_which_it_stands_out():
    one, three = swayed(6.3, (20.0,)), swayed(6.3, (20.0, 15.0, 12.0))
    assert one == pytest.approx(0.005 / np.sqrt(2.0), rel=0.1) and three == pytest.approx(one, rel=0.1)


def test_a_rocking_base_of_less_than_one_cycle_a_second_is_a_line():
    assert swayed(0.83, (15.0, 14.0)) == pytest.approx(0.005 / np.sqrt(2.0), rel=0.15)


def belt(changes: float, declared: float | None = None) -> Explainable:
    """Return what is explainable where a belt's stiffness changes by this share from the middle of the stroke to its ends.

    declared: stiffness that is held, free where None.
    """
    t = np.arange(6000) / RATE
    place, speed, through = waved(t, 5, 0), waved(t, 5, 1), JL * waved(t, 5, 2) + BL * waved(t, 5, 1)
    motor = place + through / (K * (1.0 + changes * place / np.abs(place).max()))
    acceleration = np.gradient(np.gradient(motor, t), t)
    drive = through + JM * acceleration + BM * speed + np.random.default_rng(2).normal(0.0, 5.0, t.size)
    record = Record("r", IDENTIFICATION, t, {"torque": drive, "position": motor, "load_position": place}, {}, SOURCE)
    plant = jointed(inertia=True)
    if declared is not None:
        spring = plant["linear_stiffness@joint"]
        held = replace(spring.parameters["stiffness"], value=declared, fixed=True)
        plant = plant.swap(replace(spring, parameters={"stiffness": held}))
    return explainable(State(plant, inverse_dynamics([record], JOINT_BAND)), Criteria())


def test_a_joint_whose_stiffness_changes_along_the_stroke_is_told_as_such():
    found = belt(0.2)
    assert found.kind == "joint" and found.joint > 0.02


@pytest.mark.parametrize("declared", [None, 0.9 * K])
def test_a_joint_that_is_alike_everywhere_is_not_and_neither_is_one_declared_too_soft(declared):
    assert belt(0.0, declared).joint == 0.0


def crank(changes: float, declared: float | None = None) -> Explainable:
    """Return what is explainable where an inertia changes twice a turn by this share. declared: inertia that is held, free where None."""
    t = np.arange(6000) / RATE
    q, v, a = (waved(t, 5, n) for n in (0, 1, 2))
    inertia, slope = INERTIA * (1.0 + changes * np.cos(2.0 * q)), -2.0 * INERTIA * changes * np.sin(2.0 * q)
    drive = inertia * a + 0.5 * slope * v**2 + 0.5 * INERTIA * v
    drive += 0.01 * INERTIA * np.random.default_rng(2).standard_normal(t.size)
    record = Record("r", IDENTIFICATION, t, {"torque": drive, "position": q}, {}, SOURCE)
    value = {"inertia": declared or INERTIA, "fixed": declared is not None}
    plant = Plant(ONE_MASS) + find("inertia")(**value) + find("viscous_friction")
    return explainable(State(plant, inverse_dynamics([record], JOINT_BAND)), Criteria())


def test_an_inertia_that_changes_along_the_stroke_is_told_as_such():
    found = crank(0.1)
    assert found.inertia > max(0.03, found.size)


@pytest.mark.parametrize("declared", [None, 0.8 * INERTIA])
def test_an_inertia_that_is_alike_everywhere_is_not_and_neither_is_one_declared_too_small(declared):
    assert crank(0.0, declared).inertia == 0.0


def driven(spring: float, gain: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Explainable:
    """Return what is explainable where a drive moves a mass on a spring (over its inertia, 1/s^2), all of which is declared, by a gain of time and
    place that is not."""
    t = np.arange(12000) / RATE
    q, v, a = (waved(t, 5, n) for n in (0, 1, 2))
    drive = INERTIA * (a + 0.5 * v + spring * q) / gain(t, q)
    drive += 0.01 * INERTIA * np.random.default_rng(2).standard_normal(t.size)
    record = Record("r", IDENTIFICATION, t, {"torque": drive, "position": q}, {}, SOURCE)
    plant = Plant(ONE_MASS) + find("inertia") + find("viscous_friction") + find("linear_stiffness")(at="axis")
    return explainable(State(plant, inverse_dynamics([record], JOINT_BAND)), Criteria())


def leaving(falls: float) -> Explainable:
    """Return what is explainable where a drive's constant falls by this share towards the ends of the stroke."""
    return driven(900.0, lambda t, q: 1.0 - falls * (q / np.abs(q).max()) ** 2)


def test_a_constant_of_the_drive_that_falls_towards_the_ends_of_the_stroke_is_told_as_such_and_one_of_one_size_is_not():
    assert leaving(0.15).inertia > 0.03  # an inertia that changes takes 0.026 of it
    assert leaving(0.0).inertia == 0.0


def test_a_drive_whose_gain_falls_as_it_warms_up_is_told_as_such_and_one_of_one_gain_is_not():
    """By a share, e-fold in 3 s."""
    cold, warm = (driven(4.0, lambda t, q, f=f: 1.0 - f * (1.0 - np.exp(-t / 3.0))) for f in (0.0, 0.1))
    assert warm.gain > 0.015
    assert cold.gain == 0.0


def test_neither_a_level_that_wanders_nor_one_that_changes_sign_is_a_burst_and_a_push_is():
    """Of 2 s each, what is far from zero beside what is usual there."""
    rng = np.random.default_rng(3)
    noise = 1e-3 * rng.standard_normal(N)
    wanders, turns, pushed = 0.04 * np.sin(0.2 * T), 0.02 * np.sign(np.sin(3.0 * T)), 0.05 * (np.abs(T - 7.0) < 0.02)
    parts = [SimpleNamespace(residual=noise + r, moves=np.ones(N, bool), dt=DT) for r in (wanders, turns, pushed)]
    assert [_bursts([p], 5.0) < 1e-2 * float(p.residual @ p.residual) for p in parts[:2]] == [True, True]
    assert _bursts(parts[2:], 5.0) == pytest.approx(40 * 0.05**2, rel=0.1)


@pytest.mark.parametrize(("count", "pushed", "told"), [(1e-5, 0.0, False), (1e-7, 0.0, False), (1e-5, 300.0, True)], ids=["coarse", "fine", "pushed"])  # fmt: skip
def test_an_axis_that_creeps_from_count_to_count_is_not_pushed_and_one_that_is_pushed_is(
    count, pushed, told, monkeypatch
):
    """Each count of a heavy axis is a jerk of what its mass asks for, and stands out where it moves slowly."""
    mass, band = 200.0, 50.0
    rng = np.random.default_rng(7)
    t = T[:16000]
    q = 0.02 * np.sin(0.9 * t) ** 3  # slow, and slower about its turns
    push = pushed * np.exp(-(((t - 5.0) / 0.03) ** 2))
    drive = mass * np.gradient(np.gradient(q, DT), DT) + 0.2 * rng.standard_normal(t.size) + push
    read = {"position": count * np.round(q / count), "reference": q}
    record = Record("r", IDENTIFICATION, t, {"force": drive, **read}, {}, resolution={"position": count})
    plant = Plant(ONE_MASS, rotary=False) + find("inertia")(inertia=mass, fixed=True)
    state = State(plant, decimate(inverse_dynamics([record], band), plant))
    largest = max(float(np.abs(r).max()) for r in state.residuals)
    step = edge(state.inverses[0], plant)
    if not pushed and count > 1e-6:
        assert 0.7 * step < largest < X.EDGES * step  # what counts make is what a count makes
        monkeypatch.setattr(X, "edge", lambda *_: 0.0)
        assert explainable(state, Criteria()).burst > 0.0  # by what is usual alone
        monkeypatch.undo()
    assert (explainable(state, Criteria()).burst > 0.0) is told


def test_one_block_that_is_told_badly_hides_nothing_and_one_that_is_told_well_proves_nothing():
    """Of 40 stretches each holds 1; half of it is told of all but one."""
    before, after = np.ones(40), np.full(40, 0.5)
    after[3] = 10.0
    assert gained(before, after) == pytest.approx(40.0 - 29.5)
    assert gained(before, np.where(np.arange(40) == 3, 50.0, 0.5)) == 0.0  # more is lost by it than the others gain
    well = np.ones(40)
    well[3] = 0.0
    assert gained(before + 30.0 * (well == 0.0), well) == 0.0
    noise = np.random.default_rng(0).normal(0.0, 0.3, 40)
    assert gained(before, before - noise + 0.02) == 0.0


def test_a_knot_that_is_passed_in_blocks_of_one_fold_alone_is_not_foretold_by_the_tail_that_others_see(monkeypatch):
    """Of a curve's knot the other folds see next to nothing: what noise there asks of it would be no residual of the axis."""
    size, count = 100, 4 * X.FOLDS
    blocks = [slice(i * size, (i + 1) * size) for i in range(count)]
    rng = np.random.default_rng(2)
    column, residual = np.zeros(size * count), rng.standard_normal(size * count)
    for i in (0, X.FOLDS):
        column[blocks[i]] = rng.standard_normal(size)
    column[blocks[1]] = 1e-3 * residual[blocks[1]]  # the tail, which noise happens to follow
    column /= np.linalg.norm(column)
    model = SimpleNamespace(columns=column[:, None], best=lambda gram, moment: moment / np.diag(gram))
    monkeypatch.setattr(X, "Deviations", lambda *_: model)
    state = SimpleNamespace(
        problem=SimpleNamespace(blocks=lambda _: blocks), solution=SimpleNamespace(residual=residual)
    )
    unseen = X._unseen(state)
    assert np.linalg.norm(unseen) < 1.1 * np.linalg.norm(residual)
    monkeypatch.setattr(X, "COMMON", 0.0)
    assert np.linalg.norm(X._unseen(state)) > 10.0 * np.linalg.norm(residual)
