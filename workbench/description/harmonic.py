"""Equivalent stiffness and loss of any force, by stepping it through cosine cycles until they repeat.

For effects that the integrals refuse: those that depend on rate or do not hold Masing's rule.
"""

from math import pi

import numpy as np

from workbench.definition import FORCE, Effect
from workbench.description.result import Equivalent, positive
from workbench.errors import WorkbenchError
from workbench.kernel import scan, step
from workbench.kernel.cache import load
from workbench.parameter import ROOM

SETTLED = 1e-9  # of the largest force: how little the harmonic may change while the number of cycles is doubled
MOST = 4096  # cycles


def _motion(amplitude: float, omega: float, samples: int, n: np.ndarray) -> dict[str, np.ndarray]:
    """Return the signals of q = A cos(2 pi n/samples), (n.size,) each; `t` begins with the quarter before n = 0.

    dir is the sign of motion, 0 at reversals: that of an effect with no hysteresis beside it, encoder counts forgotten. The bench is at
    room temperature.
    """
    theta = 2.0 * pi / samples * (np.arange(n[0] - 1, n[-1] + 1) % samples)
    q = amplitude * np.cos(theta)
    dt = 2.0 * pi / omega / samples
    return {
        "q": q[1:],
        "dq": np.diff(q),
        "v": -amplitude * omega * np.sin(theta[1:]),
        "a": -omega * omega * q[1:],
        "dt": np.full(n.size, dt),
        "t": dt * (n + samples // 4),
        "dir": np.where(n % samples < samples // 2, -1.0, 1.0) * (n % (samples // 2) != 0),
        "temperature": np.full(n.size, ROOM),
    }


def _harmonic(force: np.ndarray) -> complex:
    """First harmonic F of one cycle that begins at the positive peak: force = real(F exp(i theta)) and others."""
    theta = 2.0 * pi / force.size * np.arange(force.size)
    return 2.0 / force.size * complex((force * np.cos(theta)).sum(), -(force * np.sin(theta)).sum())


def _settled(effect: Effect, amplitude: float, omega: float, samples: int) -> complex:
    """First harmonic of the force once it repeats, stepped cycle by cycle from rest at q = 0."""
    ready = step.build(effect)
    values = {n: p.value for n, p in effect.parameters.items()}
    weights = np.array([values.get(column, 1.0) for column in ready.columns])
    constants, states = ready.constants(values), np.zeros(ready.states)
    run = load(scan.source(ready.program), ready.program.name).scan

    def force(n: np.ndarray) -> np.ndarray:
        signals = _motion(amplitude, omega, samples, n)
        out = np.empty((len(ready.program.outputs[1]), n.size))
        run(np.array([signals[r] for r in ready.reads]).reshape(-1, n.size), states, constants, out)
        return (weights[:, None] * out[: weights.size]).sum(axis=0)

    force(np.arange(1 - samples // 4, 0))
    earlier, check = complex("nan"), 1
    for cycle in range(MOST):
        over = force(np.arange(cycle * samples, (cycle + 1) * samples))
        if cycle + 1 == check:
            now = _harmonic(over)
            if abs(now - earlier) <= SETTLED * np.abs(over).max():
                return now
            earlier, check = now, 2 * check
    raise WorkbenchError(
        f"effect '{effect.name}' does not settle within {MOST} cycles of amplitude {amplitude:g} at {omega:g} rad/s, "
        "so it has no first harmonic to describe."
    )


def first_harmonic(effect: Effect, amplitudes, omega: float, samples: int = 4096) -> Equivalent:
    """Return k_e and c_e w of a force under q = A cos(w t), once its cycle repeats: F = (k_e + i c_e w) A exp(i w t).

    amplitudes (n,): A, rad or m, zero to peak. omega: w, rad/s. samples: steps a cycle, a multiple of 4; the error falls
    at least with their square, and is rounding alone where the force is smooth between reversals.
    WorkbenchError: not a force; it reads a signal that a cosine does not give; it does not settle.
    """
    amplitudes = positive(amplitudes)
    if not (omega > 0.0 and np.isfinite(omega)) or samples < 8 or samples % 4:
        raise WorkbenchError(
            f"a cycle at {omega:g} rad/s in {samples} samples cannot be stepped; a frequency above zero and a multiple "
            "of 4 samples are needed."
        )
    missing = sorted(set(effect.reads) - set(_motion(1.0, 1.0, 8, np.arange(8))))
    if effect.port != FORCE or missing:
        why = f"it reads {', '.join(missing)}, which a cosine motion does not give"
        why = why if effect.port == FORCE else "it is not a force"
        raise WorkbenchError(f"effect '{effect.name}' cannot be described over amplitude: {why}.")
    ratio = np.array([_settled(effect, a, omega, samples) / a for a in amplitudes], dtype=complex)
    return Equivalent(amplitudes, ratio.real, ratio.imag)
