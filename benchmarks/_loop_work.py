"""The work that the loop benchmark measures: one second of a scheduled loop, over random scenarios."""

from dataclasses import dataclass, replace
from math import pi
from types import SimpleNamespace

import casadi as ca
import numpy as np

from workbench.control import grid, scheduled_pd
from workbench.control.law import Controller
from workbench.effect import Effect, find, namespace
from workbench.effects.elementary import clip
from workbench.effects.hysteresis import bank, knots
from workbench.plant import Limits, Plant
from workbench.simulate import Criteria, Loop, Scenario, ScenarioArrays
from workbench.simulate.binding import Bound, bind
from workbench.simulate.scenario import arrays_of

ELEMENTS = (1, 4, 10)
SCENARIOS, SAMPLES = 64, 10_000
COUNT = 2.0 * pi / 2**20
LOOP = Loop(1e-4, 2, velocity_filter=5e-4, resolution=COUNT)
BANK = "presliding_hysteresis"


@dataclass(frozen=True, eq=False)
class Work:
    """n elements of hysteresis; plant, controller and scenarios."""

    n: int
    plant: Plant
    controller: Controller
    scenarios: ScenarioArrays

    def bound(self, samples: int = SAMPLES, copies: int = 1) -> Bound:
        """The loop ready to run for a number of samples, each scenario so many times."""
        return bind(self.plant, LOOP, self.controller, self.scenarios.tiled(copies), samples, Criteria())


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


def work(n: int) -> Work:
    plant = Plant("one mass", (find("inertia")(inertia=0.01), hysteresis(n)), limits=Limits(drive=2.0))
    plant += find("viscous_friction")(viscous=0.02)
    at = grid(1e-5, 1e-5 * 2**7.9)
    gains = SimpleNamespace(knots=at, kp=200.0 * (at / at[0]) ** -0.2, kd=2.0 * (at / at[0]) ** -0.1)
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
    return Work(n, plant, scheduled_pd(gains), arrays_of(many))
