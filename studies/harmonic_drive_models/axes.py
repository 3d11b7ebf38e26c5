"""Four assumed axes, each of which holds one effect that the carried records do not, and the records that the study logs on them.

All are lanes of one plant that has every effect, neutral where an axis has it not. Sizes: of catalogues for a drive of this size
(accuracy 1e-4 to 6e-4 rad, stiffness 340 to 840 N*m/rad, friction that falls by a third and varies by a sixth over a turn).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from workbench.control import fixed_pd
from workbench.definition import Effect, find
from workbench.plant import TWO_MASS, Geometry, Limits, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record
from workbench.simulation import Loop, ScenarioArrays, simulate
from workbench.simulation.recorded import record_of
from workbench.tracing.decimation import decimated

from .laws import compliances_in_series, waves_under_load

RATIO = 30
WAVES = (2.0, 1.0, 4.0)  # a turn of the motor: of the wave generator, of its eccentricity, of its double
LOOP = Loop(2.5e-4, 2, 2.5e-4, 2e-3, 2 * pi / 8000 / RATIO, 2 * pi / 1_296_000)
DURATION, NOISE = 10.0, 2e-3  # s; N*m rms, new every sample
LOGGED = 250.0  # Hz: a log at 1 kHz holds up to here
KP, KD = 60.0, 0.7  # of the loop that moves are logged through
STRIBECK, CYCLIC, LOADED, SERIES = "Stribeck", "cyclic friction", "waves under load", "compliances in series"
AXES = (STRIBECK, CYCLIC, LOADED, SERIES)
MOTIONS = (
    ("id_slow", IDENTIFICATION, "0.2 Hz sine of 1 rad with a 1.7 Hz sine of 0.02 rad on it"),
    ("id_staircase", IDENTIFICATION, "velocity staircase, +-0.1 to 4 rad/s"),
    ("id_locked", IDENTIFICATION, "output locked, random torque up to 1 Hz"),
    ("val_moves", VALIDATION, "moves of 3 mrad to 1.5 rad, there and back, with dwells"),
)  # fmt: skip
# validates where it is the joint that is asked about
WOUND = ("val_locked", VALIDATION, "output locked, another random torque up to 1 Hz")
LANES = tuple((a, *(WOUND if a == SERIES and m[0] == "val_moves" else m)) for a in AXES for m in MOTIONS)


@dataclass(frozen=True)
class Axis:
    """known: what was simulated, with all that is neutral left out. records: of `known`."""

    known: Plant
    records: tuple[Record, ...]


def _every() -> Plant:
    """Return the plant of every effect, with what all axes share."""
    hysteresis, cyclic = find("presliding_hysteresis"), find("cyclic_friction")
    return Plant(
        TWO_MASS,
        (
            find("inertia")(at="motor", inertia=2.1e-3, fixed=True),
            find("inertia")(at="load", inertia=2.6e-3, fixed=True),
            find("viscous_friction")(at="motor", viscous=0.010),
            find("viscous_friction")(at="load", viscous=0.003),
            hysteresis(at="motor", h0=0.137, x0=1.3e-3),
            find("stribeck_friction")(at="motor", speed=0.3),
            cyclic(at="motor", label="once", order=RATIO),
            cyclic(at="motor", label="twice", order=2 * RATIO),
            find("gravity")(at="load"),
            find("linear_damping")(at="joint", damping=0.022),
            hysteresis(at="joint", h0=0.107, x0=4.5e-4),
            find("linear_stiffness")(at="joint", stiffness=260.0),
            find("cubic_stiffness")(at="joint", k3=1.4e6),
            compliances_in_series()(x0=4e-3, c=2.0),
            waves_under_load(WAVES, RATIO)(sine_1=1.15e-4),
        ),
        geometry=Geometry(gear_ratio=RATIO),
        limits=Limits(3.0, 21.0),
    )


HELD: Mapping[str, Mapping[str, Mapping[str, float]]] = {  # axis -> effect -> what of it is not neutral
    STRIBECK: {"stribeck_friction@motor": {"drop": 0.050}},
    CYCLIC: {
        "cyclic_friction once@motor": {"cosine": 0.018, "sine": 0.010, "viscous_cosine": 0.002},
        "cyclic_friction twice@motor": {"cosine": 0.008, "sine": -0.010, "viscous_sine": 0.001},
    },
    LOADED: {
        "waves_under_load@joint": {"sine_2": 3e-5, "cosine_2": 3e-5, "sine_3": -2e-5, "cosine_3": 1e-5, "fading": 0.3},
        "gravity@load": {"sine": 0.8},
    },
    # 340 N*m/rad unloaded, half of that compliance the generator's; its friction is half of the joint's, the rest is hysteresis
    SERIES: {
        "linear_stiffness@joint": {"stiffness": 0.0},
        "cubic_stiffness@joint": {"k3": 0.0},
        "presliding_hysteresis@joint": {"h0": 0.05},
        "compliances_in_series@joint": {"torque": 1.2, "x0": 1.2 / 340, "share": 0.5, "c": 2.4, "friction": 0.06 / 1.2},
    },
}  # fmt: skip
OPTIONAL = (
    "stribeck_friction",
    "cyclic_friction",
    "gravity",
    "compliances_in_series",
    "linear_stiffness",
    "cubic_stiffness",
)


def assumed(axis: str) -> Plant:
    """Return the plant of every effect with this axis's values."""
    return _every().with_values(HELD[axis])


def bare(plant: Plant) -> Plant:
    """Return the plant without optional effects that are neutral in it."""

    def neutral(e: Effect) -> bool:
        return e.name in OPTIONAL and not any(e.parameters[n].value for n in e.linear)

    return replace(plant, effects=tuple(e for e in plant.effects if not neutral(e)))


def _smooth(x: np.ndarray) -> np.ndarray:
    """Return (n,) of steps with a rise of 60 ms: a mean of a mean."""
    for _ in range(2):
        window = np.ones(round(0.03 / LOOP.sample_time))
        x = np.convolve(np.pad(x, (window.size - 1, 0), mode="edge"), window / window.sum(), mode="valid")
    return x


def _references(t: np.ndarray, rng: np.random.Generator) -> list[np.ndarray]:
    """Return the reference (n,) of each motion, rad, each from rest at 0; of the locked one none is followed."""
    ramp = np.minimum(t / 0.5, 1.0)
    slow = ramp * (np.sin(2 * pi * 0.2 * t) + 0.02 * np.sin(2 * pi * 1.7 * t))
    # there and back on one side, then on the other: in the mean the joint is relaxed, as where encoders are set to zero
    speeds = np.outer([0.1, 0.3, 0.6, 1.0, 2.0, 4.0], [1.0, -1.0, -1.0, 1.0]).ravel()
    held = np.repeat(speeds, t.size // speeds.size + 1)[: t.size] * (t > 0.1)
    staircase = np.cumsum(_smooth(held)) * LOOP.sample_time
    aims = np.outer(0.5 * rng.permutation(np.geomspace(3e-3, 1.5, 6)), [1.0, -1.0]).ravel()
    moves = np.zeros_like(t)
    for k, size in enumerate(np.diff(aims, prepend=0.0)):
        s = np.clip((t - 0.2 - 0.8 * k) / (0.12 + 0.4 * np.sqrt(abs(size) / 1.5)), 0.0, 1.0)
        moves += size * s**3 * (10.0 + s * (6.0 * s - 15.0))
    return [slow, staircase, np.zeros_like(t), moves]


def _torque(t: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return (n,) of a torque with a flat spectrum up to 1 Hz, N*m, 0.8 rms."""
    lines = np.arange(1, int(t[-1]) + 1) / t[-1]
    wave = np.sum(np.cos(2 * pi * lines[:, None] * t + rng.uniform(0, 2 * pi, (lines.size, 1))), axis=0)
    return np.minimum(t, 1.0) * 0.8 * wave / np.std(wave)


def axes() -> dict[str, Axis]:
    """Return every axis with its records, at 1 kHz; the drive is logged as the mean about each moment, without phase."""
    t = LOOP.sample_time * np.arange(round(DURATION / LOOP.sample_time))
    rng = np.random.default_rng(7)
    reference = np.tile(np.stack(_references(t, rng), axis=1), (1, len(AXES)))
    held = np.array([_locked(name) for _, name, *_ in LANES], dtype=float)
    torques = {name: _torque(t, rng) for name in ("id_locked", "val_locked")}
    injected = np.stack([torques.get(name, np.zeros_like(t)) for _, name, *_ in LANES], axis=1)
    reference, free = np.where(held > 0.0, 0.0, reference), 1.0 - held
    scenarios = ScenarioArrays(
        held.size, target=reference[-1], noise=NOISE, seed=1 + np.arange(held.size), phase=0.5, locked=held
    )
    run = simulate(
        [assumed(a) for a, *_ in LANES], LOOP, fixed_pd(KP * free, KD * free), scenarios, DURATION,
        ("motor.y", "load.y", "u"), reference=reference, injected=injected,
    ).trajectories  # fmt: skip
    known = {axis: bare(assumed(axis)) for axis in AXES}
    records = [_record(known[a], a, run, k, *motion) for k, (a, *motion) in enumerate(LANES)]
    return {
        axis: Axis(known[axis], tuple(r for r, (a, *_) in zip(records, LANES, strict=True) if a == axis))
        for axis in AXES
    }


def _locked(name: str) -> bool:
    return name.endswith("locked")


def _record(known: Plant, axis: str, run, k: int, name: str, role: str, motion: str) -> Record:
    u = run["u"][:, k]
    about = 0.5 * (u + np.concatenate([u[:1], u[:-1]]))  # held from each sample on: the mean about a moment is of two
    channels = {"torque": about, "position": run["motor.y"][:, k], "load_position": run["load.y"][:, k]}
    counts = {"position": LOOP.resolution, "load_position": LOOP.load_resolution}
    whole = record_of(name, role, known, run.time, channels, counts, f"{axis}: {motion}", locked=_locked(name))
    return decimated(whole, LOGGED)
