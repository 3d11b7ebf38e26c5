"""The work that the loop benchmark measures: one second of a scheduled loop, over random scenarios.

One mass at 10 kHz, with n elements of hysteresis; and at 4 kHz two masses, and one mass with LuGre friction.
"""

from dataclasses import dataclass, replace
from math import pi
from types import SimpleNamespace

import casadi as ca
import numpy as np

from workbench.control import grid, scheduled_pd
from workbench.control.law import Controller
from workbench.definition import Effect, find, namespace
from workbench.effects.elementary import clip
from workbench.effects.hysteresis import bank, knots
from workbench.plant import Limits, Plant
from workbench.simulation import Criteria, Loop, Scenario, ScenarioArrays
from workbench.simulation.binding import Bound, bind
from workbench.simulation.scenario import arrays_of

ELEMENTS = (1, 4, 10)
SCENARIOS = 64
COUNT = 2.0 * pi / 2**20
LOOP = Loop(1e-4, 2, velocity_filter=5e-4, resolution=COUNT)
SLOW = Loop(2.5e-4, 2, velocity_filter=1e-3, resolution=COUNT)
BANK = "presliding_hysteresis"
ONE, TWO, LUGRE = range(3)  # kinds, as the C loop numbers them
JOINT = 4  # elements of the joint's hysteresis


@dataclass(frozen=True, eq=False)
class Work:
    """n elements of hysteresis where the drive acts; plant, controller, scenarios, and the loop for one second."""

    n: int
    plant: Plant
    controller: Controller
    scenarios: ScenarioArrays
    loop: Loop = LOOP
    kind: int = ONE

    @property
    def samples(self) -> int:
        return round(1.0 / self.loop.sample_time)

    def bound(self, samples: int, copies: int = 1) -> Bound:
        """The loop ready to run for a number of samples, each scenario so many times."""
        return bind(self.plant, self.loop, self.controller, self.scenarios.tiled(copies), samples, Criteria())


def hysteresis(n: int) -> Effect:
    """Presliding hysteresis of exactly n elements, from the project's own bank."""
    c = knots(n, small=())

    def derive(p):
        k, slip = bank(c, p.x0, p.d)
        return namespace(h0=p.h0, k=k, slip=slip)

    def step(s, z, p):
        x = clip(z.x + s.dq, -p.slip, p.slip)
        direction = ca.dot(p.k, x)
        return {"x": x}, p.h0 * direction, {"dir": direction}

    return replace(find(BANK)(h0=0.15, x0=1.5e-3, d=0.8), derive=derive, step=step, states={"x": n})


def one_mass(n: int) -> Work:
    plant = Plant("one mass", (find("inertia")(inertia=0.01), hysteresis(n)), limits=Limits(drive=2.0))
    return work(n, plant + find("viscous_friction")(viscous=0.02))


def two_masses(n: int = 10) -> Work:
    """A motor with n elements of friction; linear and cubic stiffness and hysteresis of four elements in the joint."""
    viscous = find("viscous_friction")
    at_motor = find("inertia")(inertia=0.0074, at="motor"), hysteresis(n)(at="motor"), viscous(viscous=0.02, at="motor")
    at_load = find("inertia")(inertia=0.002, at="load"), viscous(viscous=0.005, at="load")
    elastic = find("linear_stiffness")(stiffness=440.0), find("cubic_stiffness")(k3=2e7)
    joint = hysteresis(JOINT)(h0=0.05, x0=2e-4, at="joint")
    plant = Plant("two mass", (*at_motor, *at_load, *elastic, joint), limits=Limits(drive=2.0))
    return work(n, plant, 0.25, SLOW, TWO)


def bristles() -> Work:
    lugre = find("lugre_friction")(sigma0=95.0, sigma1=0.1, x0=1.5e-3, ratio=0.3, speed=0.05)
    plant = Plant("one mass", (find("inertia")(inertia=0.01), lugre), limits=Limits(drive=2.0))
    return work(0, plant + find("viscous_friction")(viscous=0.02), 0.25, SLOW, LUGRE)


def work(n: int, plant: Plant, gain: float = 1.0, loop: Loop = LOOP, kind: int = ONE) -> Work:
    """Return the work on a plant; gain: of the schedule, which at a lower rate has to be lower."""
    at = grid(1e-5, 1e-5 * 2**7.9)
    kp, kd = gain * 200.0 * (at / at[0]) ** -0.2, gain**0.5 * 2.0 * (at / at[0]) ** -0.1
    gains = SimpleNamespace(knots=at, kp=kp, kd=kd)
    assert at.size == 33
    rng = np.random.default_rng(7)
    many = [
        Scenario(
            target=rng.uniform(1e-3, 0.1),
            inertia=rng.uniform(0.8, 1.3),
            friction=rng.uniform(0.7, 1.3),
            load=rng.uniform(-0.02, 0.02),
            phase=rng.uniform(),
        )
        for _ in range(SCENARIOS)
    ]
    return Work(n, plant, scheduled_pd(gains), arrays_of(many), loop, kind)
