"""A load's dry friction whose presliding is short: what it does to the drive's error, and what of that the load's motion shows."""

from dataclasses import replace

import numpy as np
import pytest

from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import motion
from workbench.plant import TWO_MASS, Plant
from workbench.record import IDENTIFICATION, MADE, Record
from workbench.tracing.criteria import Criteria
from workbench.tracing.in_motion import in_motion

STIFFNESS, BAND, STEP = 3e3, 40.0, 1e-6


def moves(load: np.ndarray, time: np.ndarray, deflection: np.ndarray | float = 0.0, drive: np.ndarray | None = None):
    channels = {"position": load + deflection, "load_position": load}
    channels["torque"] = np.zeros(time.size) if drive is None else drive
    steps = dict.fromkeys(("position", "load_position"), STEP)
    record = Record("moves", IDENTIFICATION, time, channels, {}, MADE, resolution=steps)
    return InverseDynamics(motion(record, BAND))


def made(length: float) -> tuple[Plant, Plant, InverseDynamics]:
    """A declared plant whose load has Coulomb friction, the true one, whose friction gives way over `length`, and the true one's record."""
    time = np.arange(12000) * 1e-3
    load = 0.3 * np.clip(np.sin(2 * np.pi * 0.4 * time) * 1.6, -1.0, 1.0) + 0.05 * np.sin(2 * np.pi * 1.7 * time)
    bare = Plant(TWO_MASS) + find("inertia")(at="motor", inertia=0.02) + find("linear_stiffness")(stiffness=STIFFNESS)
    bare = bare + find("viscous_friction")(at="motor", viscous=0.3) + find("inertia")(at="load", inertia=0.1)
    bare = bare + find("presliding_hysteresis")(at="motor", h0=1.0, x0=2e-4)
    # inertia is known, or nothing tells force from its scale
    bare = replace(bare, effects=tuple(_held(e) if e.name == "inertia" else e for e in bare.effects))
    true = bare + find("presliding_hysteresis")(at="load", h0=3.0, x0=length)
    needed = sum(
        (e.parameters[n].value if n else 1.0) * c[1] for e, n, c in moves(load, time).columns(true) if e.at == "load"
    )
    still = moves(load, time, needed / STIFFNESS)
    drive = sum((e.parameters[n].value if n else 1.0) * c[0] for e, n, c in still.columns(true))
    return bare + find("coulomb_friction")(at="load"), true, moves(load, time, needed / STIFFNESS, drive)


def _held(e):
    return replace(e, parameters={n: replace(p, fixed=True) for n, p in e.parameters.items()})


@pytest.mark.parametrize(("length", "little"), [(1e-4, True), (5e-4, True), (0.05, False)])
def test_a_short_presliding_of_the_load_shows_in_the_drive_by_what_gives_way_for_it_and_a_long_one_in_motion_too(
    length, little
):
    declared, true, passes = made(length)
    less, more = (identify(plant, [passes]).identification for plant in (true, declared))
    assert np.sqrt(more**2 - less**2) > 2.0 * Criteria().practical
    assert (in_motion(declared, true, [passes], "load") < Criteria().practical) == little
