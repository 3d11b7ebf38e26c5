"""What a 95 % interval is worth: how often it holds the truth over 200 simulated sets with coloured residuals."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rig
from made_motions import sines
from scipy.signal import lfilter

from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import Motion, motion
from workbench.plant import ONE_MASS, Plant
from workbench.record import Record, Source

RATE, BAND, SETS = 250.0, 30.0, 200
J, B, H0, X0 = 0.0026, 0.011, 0.15, 0.02
SOURCE = Source(Path("r"), "", "", {})


def moved(seed: int, seconds: float) -> tuple[np.ndarray, ...]:
    """Return (t, q, v, a): slow and fast, large and small sines in closed form."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(seconds * RATE)) / RATE
    return t, *sines(rng, t)


def coloured(rng, n: int, size: float, memory: float) -> np.ndarray:
    """Return AR(1) noise (n,) of rms `size` whose correlation falls by e in `memory` s."""
    keep = np.exp(-1 / (memory * RATE))
    run_in = round(10 * memory * RATE)
    return lfilter([size * np.sqrt(1 - keep**2)], [1, -keep], rng.normal(size=n + run_in))[run_in:]


def sets(seconds: tuple[float, ...], memory: float, size: float, count: int):
    """Yield the inverse dynamics of `count` noisy sets on the same motions."""
    made, rng = [], np.random.default_rng(30)
    for seed, length in enumerate(seconds):
        t, q, v, a = moved(seed, length)
        u = J * a + B * v + H0 * rig.masing(q, 1 / X0)
        made.append(motion(Record(f"r{seed}", "identification", t, {"torque": u, "position": q}, {}, SOURCE), BAND))
    for _ in range(count):
        yield [InverseDynamics(noisy(m, coloured(rng, m.u.size, size, memory))) for m in made]


def noisy(m: Motion, noise: np.ndarray) -> Motion:
    channels = {**m.record.channels, "torque": m.u + noise}
    return replace(m, record=replace(m.record, channels=channels), u=m.u + noise)


def coverage(seconds: tuple[float, ...], memory: float, size: float = 0.02, count: int = SETS) -> dict[str, float]:
    """Return how often the interval of each parameter holds the truth, as a share of the sets."""
    plant = Plant(ONE_MASS) + find("inertia")(inertia=J, fixed=True) + find("viscous_friction")(viscous=B)
    plant = plant + find("presliding_hysteresis")(h0=H0, x0=X0)
    true = {"viscous": B, "h0": H0, "a": 1 / X0}
    hits = dict.fromkeys(true, 0)
    for inverses in sets(seconds, memory, size, count):
        for e in identify(plant, inverses).estimates:
            if e.parameter in true:
                hits[e.parameter] += e.low <= true[e.parameter] <= e.high
    return {n: h / count for n, h in hits.items()}


@pytest.mark.parametrize(
    ("seconds", "memory"),
    [
        ((6.0, 6.0, 6.0), 0.05),  # 36 blocks of half a second, ten times the memory
        ((6.0, 6.0, 6.0), 0.3),  # a memory as long as a block
        ((2.5, 2.5), 0.05),  # ten blocks for three parameters: the few-blocks correction carries it
        ((2.0,), 0.1),  # as few again, and a memory of half a block
    ],
)
def test_a_95_per_cent_interval_holds_the_truth(seconds, memory):
    for name, share in coverage(seconds, memory).items():
        assert 0.88 <= share <= 0.99, name
