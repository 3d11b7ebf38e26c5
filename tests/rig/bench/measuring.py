"""How a bench is measured: what pushes the body and is not reported, what the reports add, rates, units and encoders."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter

from rig.bench.cause import walk
from rig.bench.kernel import RATE, simulate
from rig.bench.machines import Machine, Stand, log_uniform
from rig.bench.motions import Motion
from rig.signals import decimated, low_pass, noise

STILL, BROAD, FIRST, WANDER = "none", "broadband", "first order", "wandering"
QUIET = (
    0.003  # of the drive's rms: what hum, a drifting offset or an encoder's own error may come to in a sound campaign
)


FELT = (0.004, 0.03)  # of the drive's rms: hum on the body, as loud as the disturbances that no report shows


@dataclass(frozen=True)
class Nuisances:
    """What is on every bench. disturbance: colour of a force on the body that no channel reports, its size (rms over the
    drive's) and corner (Hz). noise, hum, drift: of the reported drive, rms over its own. mains: Hz. grain: step of the
    reported drive, over its rms. felt: hum that the axis feels and no report shows, rms over the drive's, of a current loop
    that holds what a humming sensor reads. cut: Hz above which it was filtered before the log (0: not). waves: a line, of an error
    within the encoder's line; steps: counts in one; subdivision: its size, counts. tolerance: of what is declared fixed."""

    disturbance: str = STILL
    size: float = 0.0
    corner: float = 0.0
    noise: float = 0.004
    hum: float = 0.0
    mains: float = 50.0
    drift: float = 0.0
    grain: float = 0.0
    cut: float = 0.0
    waves: int = 0
    steps: int = 64
    subdivision: float = 0.0
    tolerance: float = 0.0
    felt: float = 0.0


@dataclass(frozen=True)
class Rates:
    """log, control: Hz. band: of evaluation, Hz. seconds: of a record."""

    log: int
    band: float
    seconds: float

    @property
    def control(self) -> int:
        return max(4000, self.log)


@dataclass(frozen=True, eq=False)
class Log:
    """One record as measured: bench time, reported drive, positions in counts, reference."""

    t: np.ndarray
    rate: int
    u: np.ndarray
    q: np.ndarray
    ql: np.ndarray
    reference: np.ndarray
    locked: bool


def drawn(rng, s: Stand, rates: Rates, tolerance: float) -> Nuisances:
    """Nuisances of one campaign."""
    colour = str(rng.choice([STILL, BROAD, FIRST, WANDER], p=[0.25, 0.35, 0.25, 0.15]))
    size = {STILL: 0.0, WANDER: rng.uniform(0.001, QUIET)}.get(colour, log_uniform(rng, 0.004, 0.04))
    corner = {
        STILL: 0.0,
        BROAD: rng.uniform(100.0, 400.0),
        FIRST: rng.choice([9.0, 18.0, 36.0]),
        WANDER: log_uniform(rng, 0.05, 0.4),
    }[colour]
    has = rng.random(5) < (0.4, 0.4, 0.6, 0.4, 0.5)
    own = rng.spawn(1)[0]  # of its own stream, so that what else a seed draws stays as it was
    felt = log_uniform(own, *FELT) * (own.random() < 0.25)
    return Nuisances(
        colour, size, float(corner), log_uniform(rng, 0.002, 0.01), rng.uniform(0.0005, QUIET) * has[0], float(rng.choice([50.0, 60.0])),
        rng.uniform(0.0005, QUIET) * has[1], log_uniform(rng, 1e-3, 3e-2) * has[2], rates.band * rng.uniform(1.3, 2.5) * has[3],
        int(rng.choice([1, 2])) * int(has[4]), int(2 ** rng.integers(4, 11)), log_uniform(rng, 0.3, 3.0), tolerance, felt,
    )  # fmt: skip


def rated(rng) -> Rates:
    """A log rate, a band that it carries, and records of some ten thousand samples."""
    log = int(rng.choice([500, 1000, 2000, 4000, 8000], p=[0.15, 0.3, 0.35, 0.12, 0.08]))
    band = {500: (40, 60), 1000: (60, 120)}.get(log, (80, 150))
    seconds = {500: 18.0, 1000: 13.0, 2000: 9.0, 4000: 5.5, 8000: 4.0}[log]
    return Rates(log, float(round(rng.uniform(*band) / 10) * 10), round(seconds * rng.uniform(0.9, 1.2), 1))


def coloured(rng, n: int, rate: float, kind: str, corner: float) -> np.ndarray:
    """Noise (n,) of rms one: broadband to the corner, or of first order behind it (wandering: the same, slowly)."""
    if kind == BROAD:
        white = rng.standard_normal(n)
        f = np.fft.rfftfreq(n, 1 / rate)
        x = np.fft.irfft(np.fft.rfft(white) / (1 + (f / corner) ** 8), n)
        # of 1/(1 + x^8)^2 the integral over all x > 0 is (1 - 1/8) (pi/8)/sin(pi/8)
        return x / np.sqrt(2 * corner / rate * 7 / 8 * (np.pi / 8) / np.sin(np.pi / 8))
    keep = np.exp(-2 * np.pi * corner / rate)
    begun = lfilter([np.sqrt(1 - keep**2)], [1.0, -keep], rng.standard_normal(n), zi=[keep * rng.standard_normal()])[0]
    return begun


def subdivided(s: Stand, x: Nuisances, rates: Rates, drive: float) -> np.ndarray:
    """The waves (1, 3) of an error within each line of the mover's encoder; its force in the band stays quiet."""
    f, line = s.machine.facts, x.steps * s.machine.facts.count
    loud = 5 * QUIET * drive * np.sqrt(2.0) / (f.inertia * (2 * np.pi * rates.band) ** 2)
    return np.array([[min(x.subdivision * f.count, loud, 0.1 * line), 2 * np.pi * x.waves / line, 1.0]])


def disturbance(x: Nuisances, drive: float, seed: list[int], t: np.ndarray, rate: float) -> np.ndarray:
    """The force (n,) that nobody reports, on the bench clock t: of its colour, and hum of the mains."""
    return drive * (x.felt * humming(x.mains, t) + _of_its_colour(x, seed, t, rate))


def humming(mains: float, t: np.ndarray) -> np.ndarray:
    """Hum of the mains (n,) and its third harmonic, on the bench clock t; of rms one, but for the harmonic."""
    return np.sqrt(2.0) * (np.sin(2 * np.pi * mains * t + 0.4) + 0.3 * np.sin(6 * np.pi * mains * t + 1.1))


def _of_its_colour(x: Nuisances, seed: list[int], t: np.ndarray, rate: float) -> np.ndarray:
    """The disturbance (n,) over the drive's rms."""
    if x.disturbance == STILL:
        return np.zeros(t.size)
    if x.disturbance == WANDER:
        return x.size * walk(seed[0] + 77, 1 / (2 * np.pi * x.corner), t)
    return x.size * coloured(np.random.default_rng(seed), t.size, rate, x.disturbance, x.corner)


def run(machine: Machine, motion: Motion, start: float, rates: Rates, pushed: np.ndarray | None = None) -> Log:
    """Run a machine from rest; positions and drive at the log rate, before anything that reports add."""
    per_control, per_log, n = RATE // rates.control, RATE // rates.log, motion.reference.size
    t = start + np.arange(n) / rates.control
    level, pushed = np.ones(n), np.zeros(n) if pushed is None else pushed.copy()
    for line in machine.timelines:
        level, pushed = level * line.level(t), pushed + line.push(t)
    q, ql, u = np.zeros((3, n * per_control))
    simulate(
        machine.facts, machine.lists, start, per_control, motion.reference, motion.speed, motion.acceleration, motion.injected,
        pushed, level, motion.closed, motion.locked, q, ql, u,
    )  # fmt: skip
    late, k = machine.reported, int(machine.two)
    fine = start + np.arange(q.size) / RATE
    logs = [q, ql]
    if late.late or late.skew:
        logs[k] = np.interp(fine - late.late - late.skew * fine, fine, logs[k])
    q, ql = (x[::per_log].copy() for x in logs)
    for moment, step in late.lost:
        ql[fine[::per_log] > moment] += step * (moment > start)
    reference = motion.reference[:: rates.control // rates.log]
    return Log(fine[::per_log], rates.log, decimated(u, per_log), q, ql, reference[: q.size], motion.locked)


def reported(log: Log, s: Stand, machine: Machine, x: Nuisances, rates: Rates, drive: float, seed: list[int]) -> Log:
    """The same as a bench reports it."""
    rng = np.random.default_rng([*seed, 1])
    t, u = log.t, log.u + machine.reported.trend * log.t
    u = u + noise(rng, u.size, x.noise * drive, log.rate, rates.band)
    if x.cut > 0.0 and x.cut < 0.4 * log.rate:
        u = low_pass(u, log.rate, x.cut)
    u = u + x.hum * drive * humming(x.mains, t) + x.drift * drive * walk(seed[0] + 78, 25.0, t)
    if x.grain > 0.0:
        u = x.grain * drive * np.round(u / (x.grain * drive))
    counts = s.machine.facts.count, s.load_count
    q, ql = (c * np.floor(y / c + 0.5) if c > 0.0 else y for c, y in zip(counts, (log.q, log.ql), strict=True))
    return replace(log, u=u, q=q, ql=ql)
