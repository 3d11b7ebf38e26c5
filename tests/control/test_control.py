"""Controllers as data: gains over amplitude, found by the leading bits of a number."""

from types import SimpleNamespace

import numpy as np
import pytest

from workbench.control import Table, fixed_pd, gains_at, grid, scheduled_pd
from workbench.control.table import look_up
from workbench.errors import WorkbenchError

KNOTS = grid(1e-6, 2e-4)


def schedule(knots=KNOTS, **more):
    return SimpleNamespace(
        knots=knots, kp=100.0 * (knots / knots[0]) ** -0.3, kd=np.linspace(2.0, 1.0, knots.size), **more
    )


def test_knots_lie_on_eighths_of_octaves_and_cover_the_range():
    knots = grid(1e-6, 2e-4, per_octave=8)
    mantissa, _ = np.frexp(knots)
    assert (mantissa * 16 == np.round(mantissa * 16)).all()
    assert knots[0] <= 1e-6 < knots[1] and knots[-2] < 2e-4 <= knots[-1]


@pytest.mark.parametrize("per_octave", [1, 4, 16])
def test_look_up_by_bits_is_linear_interpolation_clipped_at_both_ends(per_octave):
    s = schedule(grid(1e-6, 2e-4, per_octave))
    table = Table(s.knots, {"kp": s.kp, "kd": s.kd})
    amplitude = np.concatenate([np.geomspace(1e-8, 1e-2, 4001), s.knots, np.nextafter(s.knots, 0.0)])
    for found, column in zip(gains_at(table, amplitude), (s.kp, s.kd), strict=True):
        np.testing.assert_allclose(found, np.interp(amplitude, s.knots, column), rtol=1e-13)


def test_tables_of_one_grid_are_looked_up_lane_by_lane():
    a, b = Table(KNOTS, {"kp": KNOTS}), Table(KNOTS, {"kp": 2.0 * KNOTS})
    rows = np.concatenate([a.rows, b.rows])
    at = np.array([3e-5, 3e-5, 1.7e-4])
    (found,) = look_up(rows, a.shift, a.offset, np.array([0, KNOTS.size, KNOTS.size]), at)
    np.testing.assert_allclose(found, at * [1.0, 2.0, 2.0], rtol=1e-14)


@pytest.mark.parametrize("knots", [[1e-5, 2e-5, 3e-5], [1.0, 1.25, 1.75], [1.0, 1.1], [2.0, 1.0], []])
def test_knots_off_the_grid_are_refused(knots):
    with pytest.raises(WorkbenchError, match="knots"):
        Table(np.array(knots), {"kp": np.ones(len(knots))})


def test_what_is_wrong_with_a_controller_is_a_sentence():
    with pytest.raises(WorkbenchError, match="did you mean 'frozen'"):
        scheduled_pd(schedule(), "frosen")
    with pytest.raises(WorkbenchError, match="kp is not finite"):
        fixed_pd(float("nan"), 1.0)
    with pytest.raises(WorkbenchError, match="different knots"):
        scheduled_pd([schedule(), schedule(grid(1e-6, 4e-4))])
    with pytest.raises(WorkbenchError, match="table numbers"):
        scheduled_pd([schedule()], table=[0, 1])
    assert scheduled_pd(schedule(rule="frozen", reversal=1e-5)).reversal == 1e-5


def test_every_law_of_the_package_is_known_by_its_own_name():
    from workbench.control import law_named, laws, profile
    from workbench.control.law import Law
    from workbench.control.named import every

    written = {id(x) for module in (laws, profile) for x in vars(module).values() if isinstance(x, Law)}
    made = scheduled_pd(schedule(), "error", deceleration=1.0, speed_limit=2.0).law
    assert written <= {id(x) for x in every().values()} and law_named(made.name) is made
    with pytest.raises(WorkbenchError, match="pi_cascade"):
        law_named("pi_cascad")


def test_a_controllers_own_velocity_filter_takes_the_place_of_the_loops():
    from dataclasses import replace

    from workbench.definition import find
    from workbench.plant import ONE_MASS, Plant
    from workbench.simulation import Loop, ScenarioArrays, simulate

    plant = Plant(ONE_MASS, (find("inertia")(inertia=0.01),))
    slow = Loop(2.5e-4, 4, 2.5e-4, 4e-3)
    lanes, law = ScenarioArrays(2, target=0.01), fixed_pd(10.0, 0.8)
    of_loop = simulate(plant, slow, law, lanes, 0.1, ("vh",)).trajectories["vh"]
    quick = replace(slow, velocity_filter=2.5e-4)
    own = simulate(
        plant, quick, replace(law, velocity_filter=np.array([4e-3, 2.5e-4])), lanes, 0.1, ("vh",)
    ).trajectories["vh"]
    plain = simulate(plant, quick, law, lanes, 0.1, ("vh",)).trajectories["vh"]
    np.testing.assert_allclose(own, np.stack([of_loop[:, 0], plain[:, 1]], axis=1), rtol=1e-9, atol=1e-12)
    assert not np.allclose(own[:, 0], own[:, 1])
    with pytest.raises(WorkbenchError, match="velocity filter"):
        replace(law, velocity_filter=-1.0)
    with pytest.raises(WorkbenchError, match="velocity_filter has shape"):
        simulate(plant, quick, replace(law, velocity_filter=np.ones(3)), lanes, 0.1)
