"""The assumed axis of the gain-scheduling paper, one mass: its loop, and its plant of inertia and presliding."""

from workbench.definition import find
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.simulation import Loop

LOOP = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, 4.848e-6)


def plant() -> Plant:
    return Plant(
        ONE_MASS,
        (find("inertia")(inertia=0.0074), find("presliding_hysteresis")(h0=0.15, x0=1 / 636)),
        limits=Limits(3.3, 12.57),
    )
