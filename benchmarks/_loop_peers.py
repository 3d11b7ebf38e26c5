"""The same loop in the words of two Python libraries: a nonlinear system of python-control, a simulator of do-mpc.

One scenario, plain arithmetic in the same order; each returns the positions at the samples, for the answers to be compared.
"""

import warnings
from math import floor

import casadi as ca
import numpy as np

from benchmarks._loop_c import constants, elements
from benchmarks._loop_work import BANK, LOOP, Work


class Sampled:
    """Reading, velocity, reversals and the scheduled law of one scenario, sample by sample, in plain Python."""

    def __init__(self, work: Work):
        s, table = work.scenarios, work.controller.tables[0]
        self.r, self.phase, self.limit = float(s.target[0]), float(s.phase[0]), work.plant.limits.drive
        self.knots, self.kp, self.kd = table.knots, table.columns["kp"], table.columns["kd"]

    def read(self, q: float) -> float:
        return LOOP.resolution * floor(q / LOOP.resolution + self.phase)

    def start(self) -> tuple[float, ...]:
        y = self.read(0.0)
        return y, 0.0, y, y, 0.0, 1.0

    def decide(self, q: float, state) -> tuple[float, tuple[float, ...]]:
        """Return (command, next state (y, vh, furthest, turned, way, share))."""
        before, vh, furthest, turned, way, share = state
        y = self.read(q)
        vh = vh + LOOP.smoothing * ((y - before) / LOOP.sample_time - vh)
        delta = y - furthest
        if way * delta > 0.0:
            furthest = y
        elif abs(delta) > 2.5 * LOOP.resolution:
            turned, furthest, share = furthest, y, 0.5 if way else share
            way = 1.0 if delta > 0.0 else -1.0
        amplitude = share * abs(y - turned)
        kp, kd = np.interp(amplitude, self.knots, self.kp), np.interp(amplitude, self.knots, self.kd)
        u = kp * (self.r - y) - kd * vh
        return float(min(max(u, -self.limit), self.limit)), (y, vh, furthest, turned, way, share)


class Axis:
    """Numbers of the plant in the first scenario."""

    def __init__(self, work: Work):
        values, s = constants(work), work.scenarios
        self.k, self.slip = (np.array(elements(values, f, work.n)) for f in ("k", "slip"))
        self.h0, self.viscous = values[f"{BANK}@axis.h0"], values["viscous_friction@axis.viscous"]
        self.mass = float(s.inertia[0]) * values["inertia@axis.inertia"]
        self.friction, self.load = float(s.friction[0]), float(s.load[0])


def python_control(work: Work, samples: int):
    """Return a function that runs `input_output_response` on one discrete-time nonlinear system and returns q (samples,)."""
    import control

    loop, axis, n, h = Sampled(work), Axis(work), work.n, LOOP.substep

    def update(t, x, u, params):
        torque, memory = loop.decide(x[0], x[2 + n :])
        q, v, z = x[0], x[1], x[2 : 2 + n]
        for _ in range(LOOP.substeps):
            z = np.clip(z + v * h, -axis.slip, axis.slip)
            force = axis.friction * (axis.h0 * axis.k.dot(z) + axis.viscous * v) + axis.load
            v = v + (torque - force) / axis.mass * h
            q = q + v * h
        return np.concatenate([[q, v], z, memory])

    system = control.nlsys(update, lambda t, x, u, params: x[0], states=8 + n, inputs=1, outputs=1, dt=LOOP.sample_time)
    time, start = np.arange(samples) * LOOP.sample_time, np.concatenate([np.zeros(2 + n), loop.start()])
    return lambda: control.input_output_response(system, time, np.zeros(samples), start).outputs


def do_mpc(work: Work, samples: int):
    """Return a function that steps a do-mpc simulator of a discrete model, the controller beside it, and returns q."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import do_mpc as library

    loop, axis, n, h = Sampled(work), Axis(work), work.n, LOOP.substep
    model = library.model.Model("discrete")
    q0, v0, z0 = (model.set_variable("_x", name, (size, 1)) for name, size in (("q", 1), ("v", 1), ("z", n)))
    torque = model.set_variable("_u", "torque")
    q, v, z = q0, v0, z0
    for _ in range(LOOP.substeps):
        z = ca.fmin(ca.fmax(z + v * h, -axis.slip), axis.slip)
        force = axis.friction * (axis.h0 * ca.dot(axis.k, z) + axis.viscous * v) + axis.load
        v = v + (torque - force) / axis.mass * h
        q = q + v * h
    for name, value in (("q", q), ("v", v), ("z", z)):
        model.set_rhs(name, value)
    model.setup()
    simulator = library.simulator.Simulator(model)
    simulator.set_param(t_step=LOOP.sample_time)
    simulator.setup()

    def run() -> np.ndarray:
        simulator.reset_history()
        simulator.x0 = np.zeros((2 + n, 1))
        state, x, result = loop.start(), np.zeros((2 + n, 1)), np.empty(samples)
        for i in range(samples):
            result[i] = x[0, 0]
            u, state = loop.decide(result[i], state)
            x = simulator.make_step(np.array([[u]]))
        return result

    return run
