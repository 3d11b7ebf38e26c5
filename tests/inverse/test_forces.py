"""Forces along a motion that no record holds: laws in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from workbench.definition import find
from workbench.effects.direction import stop_direction
from workbench.errors import WorkbenchError
from workbench.inverse.forces import force_along
from workbench.kernel.step import build
from workbench.plant import ONE_MASS, TWO_MASS, Plant

DT, N = 1e-3, 500
T = DT * np.arange(N)
Q, V, A = 0.1 * np.sin(20.0 * T), 2.0 * np.cos(20.0 * T), -40.0 * np.sin(20.0 * T)
MOVED = {"q": Q, "dq": np.diff(Q, prepend=0.0), "v": V, "a": A}


def test_forces_add_up_along_a_motion():
    plant = Plant(ONE_MASS) + find("inertia")(inertia=0.02) + find("viscous_friction")(viscous=0.3)
    assert force_along(plant, DT, 1e-6, **MOVED) == pytest.approx(0.02 * A + 0.3 * V, rel=1e-12)


def test_friction_without_memory_turns_within_the_counts():
    """At 2 rad/s a count of 1e-6 rad passes within a sample, so that the direction is that of the motion."""
    force = force_along(Plant(ONE_MASS) + find("coulomb_friction")(coulomb=0.7), DT, 1e-6, **MOVED)
    fast = (np.abs(V) > 0.1) & (T > 0.0)  # before the first sample nothing moved
    assert force[fast] == pytest.approx(0.7 * np.sign(V[fast]))


def test_friction_with_memory_slides_at_its_height():
    sliding = {"q": 0 * T, "dq": np.full(N, 1e-3), "v": 1.0 + 0 * T, "a": 0 * T}
    plant = Plant(ONE_MASS) + find("presliding_hysteresis")(h0=0.4, x0=0.01)
    assert force_along(plant, DT, 1e-6, **sliding)[-1] == pytest.approx(0.4, rel=1e-6)


def test_nothing_asks_for_no_force():
    assert not force_along(Plant(ONE_MASS), DT, 1e-6, **MOVED).any()


def test_two_masses_are_refused_for_one_position():
    with pytest.raises(WorkbenchError, match="one mass"):
        force_along(Plant(TWO_MASS), DT, 1e-6, **MOVED)


def test_what_a_motion_does_not_hold_is_named():
    plant = Plant(ONE_MASS) + replace(find("coulomb_friction"), reads=("normal",))
    with pytest.raises(WorkbenchError, match="'normal', which a motion alone does not have"):
        force_along(plant, DT, 1e-6, **MOVED)


def test_a_direction_of_any_width_is_one_program():
    """A record has its own counts, and so its own width: a program a width would be built at every pass of a search."""
    narrow, wide = stop_direction(1e-6), stop_direction(2e-6)
    assert build(narrow) is build(wide)
    turned = [build(e).run({"dq": np.full(3, 1e-6)}, {"width": w})[1] for e, w in ((narrow, 1e-6), (wide, 2e-6))]
    assert turned[0].tolist() == [1.0, 1.0, 1.0] and turned[1].tolist() == [0.5, 1.0, 1.0]
