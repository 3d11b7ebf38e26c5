"""A reference over time and what is added to the command: bits, closed forms, and what is refused."""

import numpy as np
import pytest

from workbench.control import fixed_pd, pi_cascade
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.plant import Limits, Plant
from workbench.simulation import Criteria, Loop, Scenario, followed, simulate
from workbench.simulation.binding import bind
from workbench.simulation.given import INJECTED, REFERENCE, given_of
from workbench.simulation.oracle import run_arrays
from workbench.simulation.run import run_lanes
from workbench.simulation.scenario import arrays_of

TS, N, LANES = 1e-3, 400, 37
INERTIA, VISCOUS = 0.01, 0.02
LOOP = Loop(TS, 2, resolution=1e-6, velocity_filter=2e-3)
TIME = np.arange(N) * TS


def plant(**limits) -> Plant:
    effects = (find("inertia")(inertia=INERTIA), find("viscous_friction")(viscous=VISCOUS))
    return Plant("one mass", effects, limits=Limits(**limits))


def many() -> list[Scenario]:
    rng = np.random.default_rng(3)
    return [
        Scenario(friction=rng.uniform(0.5, 1.5), noise=0.01 * (i % 2), phase=rng.uniform(), seed=i)
        for i in range(LANES)
    ]


def waves(lanes: int) -> np.ndarray:
    return 0.02 * np.sin(2 * np.pi * np.linspace(1.0, 4.0, lanes) * TIME[:, None])


SHAPES = {
    "shared": (waves(1)[:, 0], 0.1 * np.cos(40.0 * TIME)),
    "own": (waves(LANES), 3.0 * waves(LANES)),
    "shared reference, own excitation": (waves(1)[:, 0], waves(LANES)),
    "reference alone": (waves(LANES), None),
    "excitation alone": (None, 0.1 * np.cos(40.0 * TIME)),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_lanes_have_the_bits_of_numpy_with_signals_over_time(shape):
    reference, injected = SHAPES[shape]
    friction = plant(drive=0.5) + find("coulomb_friction")(coulomb=0.05)
    given = given_of({REFERENCE: reference, INJECTED: injected}, N, LANES)
    cascade = pi_cascade(20.0, 0.4, 4.0, 1e3)
    bound = bind(friction, LOOP, cascade, arrays_of(many()), N, Criteria(), given=given)
    rows, kept = run_arrays(bound, ("q", "u_c"))
    for lanes in (32, 1):
        final, recorded = run_lanes(bound, ("q", "u_c"), lanes=lanes)
        assert all(np.array_equal(final[n], v) for n, v in rows.items() if n in final)
        assert np.array_equal(recorded, kept)
    assert np.ptp(kept[:, 1]) > 0.1


def test_a_reference_for_all_is_that_reference_given_to_each():
    shared, own = (
        simulate(plant(), LOOP, fixed_pd(40.0, 1.0), many(), N * TS, record=("q",), reference=r)
        for r in (waves(1)[:, 0], np.repeat(waves(1), LANES, axis=1))
    )
    assert np.array_equal(shared.trajectories["q"], own.trajectories["q"])
    assert np.array_equal(shared.following_error, own.following_error)


def test_lanes_that_share_references_and_last_as_long_as_each_is_needed_have_the_bits_of_the_whole_run():
    which, lasts = np.arange(LANES) % 3, np.sort(np.random.default_rng(4).integers(1, N + 1, LANES))
    kp = np.linspace(20.0, 60.0, 4)
    own = fixed_pd(kp, 0.02 * kp).taken(np.arange(LANES) % 4)
    assert np.array_equal(own.parameters["kp"], kp[np.arange(LANES) % 4])
    scenarios, references = arrays_of(many()), waves(3)
    whole = simulate(plant(), LOOP, own, scenarios, N * TS, record=("q",), reference=references[:, which])
    short = followed(plant(), LOOP, own, scenarios, references, which, lasts)
    needed = np.arange(N)[:, None] < lasts
    assert np.array_equal(short[needed], whole.trajectories["q"][needed])


def test_a_constant_reference_is_a_target():
    targets = np.linspace(0.01, 0.05, LANES)
    steps = [Scenario(target=t) for t in targets]
    step = simulate(plant(), LOOP, fixed_pd(40.0, 1.0), steps, N * TS, record=("q",))
    over_time = simulate(plant(), LOOP, fixed_pd(40.0, 1.0), [Scenario()] * LANES, N * TS, record=("q",),
                         reference=np.tile(targets, (N, 1)))  # fmt: skip
    assert np.array_equal(step.trajectories["q"], over_time.trajectories["q"])
    for name in ("time_1pct", "overshoot", "final_error", "settling", "peak_torque"):
        assert np.array_equal(getattr(step, name), getattr(over_time, name)), name
    assert step.following_error is None
    assert np.array_equal(over_time.following_error, targets)


def test_a_ramp_is_followed_at_the_distance_of_its_closed_form():
    kp, kd, speed = 40.0, 1.0, 0.3
    found = simulate(plant(), Loop(TS, 8), fixed_pd(kp, kd), [Scenario()], 4.0, reference=speed * np.arange(4000) * TS)
    # kp e = (kd + viscous) v, with e from the sampled reading
    assert found.final_error[0] == pytest.approx((kd + VISCOUS) * speed / kp, rel=1e-6)


def test_what_is_added_to_the_command_pushes_as_a_load_pulls():
    push = np.full(4000, 0.2)
    added = simulate(plant(), LOOP, fixed_pd(40.0, 1.0), [Scenario()], 4.0, injected=push)
    pulled = simulate(plant(), LOOP, fixed_pd(40.0, 1.0), [Scenario(load=-0.2)], 4.0)
    assert added.final_position == pytest.approx(pulled.final_position, rel=1e-6)
    assert added.final_position[0] == pytest.approx(0.2 / 40.0, rel=1e-3)


def test_what_is_added_to_the_command_obeys_the_drive_s_limit():
    found = simulate(plant(drive=0.5), LOOP, fixed_pd(40.0, 1.0), [Scenario()], N * TS, injected=np.full(N, 9.0))
    assert found.peak_torque[0] == 0.5


def test_a_move_is_judged_by_where_it_ends():
    ramp = np.minimum(0.5 * TIME, 0.05)
    found = simulate(plant(), LOOP, fixed_pd(40.0, 1.0), [Scenario()], N * TS, reference=ramp)
    assert 0.1 < found.time_1pct[0] < 0.3
    assert found.final_position[0] == pytest.approx(0.05, abs=1e-4)
    assert found.following_error[0] > 5e-3
    assert found.final_error[0] < 1e-4


@pytest.mark.parametrize(
    ("reference", "said"),
    [
        (np.zeros(N - 1), "399 samples"),
        (np.zeros((N, 3)), "(n, 2)"),
        (np.full(N, np.nan), "not finite"),
    ],
)
def test_signals_that_do_not_fit_the_run_are_refused(reference, said):
    with pytest.raises(WorkbenchError) as told:
        simulate(plant(), LOOP, fixed_pd(40.0, 1.0), [Scenario(), Scenario()], N * TS, reference=reference)
    assert said in str(told.value)
