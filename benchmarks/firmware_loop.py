"""The sampled loop with compiled firmware as controller, beside the float64 scalar kernel: asked is at most twice its time."""

import numpy as np

from benchmarks._timing import milliseconds
from workbench.control import fixed_pd, pi_cascade
from workbench.definition import find
from workbench.firmware import firmware
from workbench.firmware.loop import Compiled
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.simulation import Criteria, Loop, ScenarioArrays
from workbench.simulation.binding import bind
from workbench.simulation.run import run_lanes

COUNT = 2.0 * np.pi / 2**20
LOOP = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, COUNT)
AXIS = Plant(
    ONE_MASS,
    (
        find("inertia")(inertia=0.0074),
        find("viscous_friction")(viscous=0.02),
        find("presliding_hysteresis")(h0=0.15, x0=1.6e-3),
    ),
    limits=Limits(3.3, 20.9),
)
SAMPLES = 20000


def main() -> None:
    """Print the time of 5 s of each loop, and its ratio to the kernel's."""
    scenarios = ScenarioArrays(1, target=20000 * COUNT)
    empty = bind(AXIS, LOOP, None, scenarios, SAMPLES, Criteria())
    for name, law in (("fixed PD", fixed_pd(900.0, 5.0)), ("cascade", pi_cascade(60.0, 5.0, 300.0, 12.0))):
        bound = bind(AXIS, LOOP, law, scenarios, SAMPLES, Criteria())
        kernel = milliseconds(lambda b=bound: run_lanes(b, lanes=1, threads=1), 9)
        print(f"  {name + ', scalar kernel':<40}{kernel:10.2f} ms")
        for arithmetic in ("float32", "fixed"):
            compiled = Compiled(firmware(law, LOOP, AXIS, arithmetic), empty)
            spent = milliseconds(lambda c=compiled: c.lane(empty, 0), 9)
            print(f"  {name + ', firmware in ' + arithmetic:<40}{spent:10.2f} ms{spent / kernel:8.2f} x")


if __name__ == "__main__":
    main()
