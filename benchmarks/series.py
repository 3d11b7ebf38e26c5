"""Ten thousand axes drawn from distributions, on this machine's threads: CPU time, and what of it is spent before the lanes."""

import os
from time import monotonic, process_time

import numpy as np

from benchmarks._timing import cpu
from workbench.control import fixed_pd
from workbench.definition import find
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.robustness import (
    Varied,
    blocks,
    fixed,
    independent,
    influences,
    joined,
    log_uniform,
    normal,
    uniform,
    work,
)
from workbench.robustness.local import on_cores
from workbench.robustness.vary import applied
from workbench.robustness.workload import digest
from workbench.simulation import Loop
from workbench.task.task import Task

DRAWS = 10_000
STEP = 0.4 * 2 * np.pi  # rad
VARIED = (
    Varied("inertia", uniform(0.5, 1.5)),
    Varied("friction", uniform(0.5, 1.5)),
    Varied("presliding_hysteresis.x0", log_uniform(0.7, 1.4), relative=True),
    Varied("presliding_hysteresis.d", uniform(0.8, 1.0)),
    Varied("delay", uniform(0.0, 2.5e-4), unit="s"),
    Varied("phase", uniform(0.0, 1.0)),
    Varied("encoder_eccentricity.amplitude", uniform(0.0, 2.4e-5), unit="rad"),
    Varied("torque_constant_error.error", normal(0.0, 0.03, -0.09, 0.09)),
    Varied("kinematic_error.amplitude", uniform(0.0, 1e-4), unit="rad"),
    Varied("kinematic_error.order", fixed(100.0), unit="1/rad"),
)


def main() -> None:
    effects = (
        find("inertia")(inertia=0.0074),
        find("viscous_friction")(viscous=1e-3),
        find("presliding_hysteresis")(h0=0.15, x0=1 / 636),
        find("stribeck_friction")(drop=0.05, speed=0.05),
    )
    plant = Plant(ONE_MASS, effects, limits=Limits(3.3, 12.57))
    task = Task(plant, Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, 4.848e-6), STEP, 0.4, noise=2e-3)
    given = work(task, {"fixed PD": lambda lanes: fixed_pd(60.0, 1.3)}, VARIED)
    cases = independent(VARIED, DRAWS, seed=1)
    given.columns(blocks(cases)[0])  # kernels are compiled, or read
    spent, wall = cpu(), monotonic()
    columns = joined(on_cores(given, blocks(cases)))
    spent, wall = cpu() - spent, monotonic() - wall
    begin = process_time()
    for block in blocks(cases):
        applied(given.task.plant, VARIED, block.values)
    plants = process_time() - begin
    begin = process_time()
    influences(cases, columns["fixed PD"]["final_error"])
    told = process_time() - begin
    steps = DRAWS * task.duration / task.loop.substep
    print(
        f"{DRAWS} axes, {task.duration:g} s each at {1e-3 / task.loop.sample_time:g} kHz, {len(VARIED)} numbers drawn:"
    )
    print(
        f"  {spent:.2f} s of CPU, {wall:.2f} s on {os.cpu_count()} cores; {1e9 * spent / steps:.1f} ns a lane and substep."
    )
    print(
        f"  {plants:.2f} s of it make the plants. Influence of each number, with its error: {told:.2f} s of CPU more."
    )
    print(f"  digest of all metrics {digest(columns)[:16]}")


if __name__ == "__main__":
    main()
