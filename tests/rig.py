"""A rig of its own: a harmonic-drive servo simulated at 20 kHz, that writes campaigns whose answer is known.

Nothing here comes from the workbench: friction with memory is a stack of turning points on the exact virgin curve (the
workbench has a bank of stops), motion is integrated in time (the workbench reads torque off motion), and every effect
is written a second time. `campaign` writes one folder and returns what the declared model lacks.

To add an effect, write its law (a torque that resists the motion, linear in p[0]) and one line in EFFECTS.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

import numba
import numpy as np

RATE = 20_000  # Hz, of the integration
PER_SAMPLE = 20  # steps a logged sample: 1 kHz
PER_CONTROL = 5  # steps a control sample: 4 kHz
COUNT = 4.848e-6  # rad, encoder
BAND = 150.0  # Hz, evaluation bandwidth
LIMIT = 3.0  # N*m
LEVEL = 4.0  # size 1: what the declared model cannot absorb of an effect is this many times the noise in the band
DEPTH = 512  # turning points remembered
UNUSED = 100  # logged samples at both ends in which nothing is compared
ROLES = ("identification", "validation")


# --- friction with memory ---------------------------------------------------------------------------------------------


@numba.njit(cache=True)
def branch(x, f, way, at, rate):
    """Force at x on the branch that begins at (x, f): the virgin curve from the origin, else the same stretched by two."""
    return f + way * 2.0 * (1.0 - np.exp(-rate * 0.5 * abs(at - x)))


@numba.njit(cache=True)
def turning(points, depth, way, x, rate):
    """Move to x; return (depth, way, force of height one). points (DEPTH, 2): positions and forces of turning points.

    depth 0: on the virgin curve through (0, 0). A loop closes where it reaches the turning point before the last, or, as
    the outermost one, the mirror image of its own beginning: there the two points are forgotten.
    """
    while True:
        if depth == 0:
            force = (1.0 - np.exp(-rate * abs(x))) * (1.0 if x > 0 else -1.0)
            return depth, way, force
        if depth == 1:
            closed = -points[0, 0]
        else:
            closed = points[depth - 2, 0]
        if (x - closed) * way > 0.0:
            depth = max(depth - 2, 0)
            continue
        return depth, way, branch(points[depth - 1, 0], points[depth - 1, 1], way, x, rate)


@numba.njit(cache=True)
def turn(points, depth, way, x, force):
    """Remember (x, force), where the motion turns; beyond DEPTH the smallest loop is forgotten. Return (depth, way)."""
    if depth == DEPTH:
        depth -= 2
    points[depth, 0] = x
    points[depth, 1] = force
    return depth + 1, -way


@numba.njit(cache=True)
def masing(position, rate):
    """Return the force (n,) of height one along a position (n,) that begins relaxed, virgin curve 1 - exp(-rate x)."""
    out = np.empty(position.size)
    points = np.empty((DEPTH, 2))
    depth, way, force = 0, 0.0, 0.0
    last = position[0]
    for n in range(position.size):
        x = position[n] - position[0]
        moved = x - (last - position[0])
        if moved != 0.0:
            if way == 0.0:
                way = np.sign(moved)
            elif moved * way < 0.0:
                depth, way = turn(points, depth, way, last - position[0], force)
            depth, way, force = turning(points, depth, way, x, rate)
            last = position[n]
        out[n] = force
    return out


# --- effects ----------------------------------------------------------------------------------------------------------
# A law is a torque resisting the motion: law(p, q, v, d, t, u), p its parameters, d the friction of height one, t the
# bench clock, u the applied torque.


@numba.njit(cache=True)
def stribeck(p, q, v, d, t, u):
    return p[0] * np.exp(-((v / p[1]) ** 2)) * d


@numba.njit(cache=True)
def cogging(p, q, v, d, t, u):
    return p[0] * (np.sin(p[1] * q + p[2]) + p[3] * np.sin(2.0 * p[1] * q + p[4]))


@numba.njit(cache=True)
def asymmetry(p, q, v, d, t, u):
    return p[0] * (abs(d) + p[1] * abs(v))


@numba.njit(cache=True)
def nonlinear_viscous(p, q, v, d, t, u):
    return p[0] * v * abs(v)


@numba.njit(cache=True)
def offset(p, q, v, d, t, u):
    return p[0]


@numba.njit(cache=True)
def cable(p, q, v, d, t, u):
    return p[0] * (q - p[1])


@numba.njit(cache=True)
def weight(p, q, v, d, t, u):
    return p[0] * np.sin(q + p[1])


@numba.njit(cache=True)
def loaded(p, q, v, d, t, u):
    return p[0] * abs(u) * d


@numba.njit(cache=True)
def drift(p, q, v, d, t, u):
    return p[0] * (t - p[1]) * d


@numba.njit(cache=True)
def cyclic(p, q, v, d, t, u):
    return p[0] * np.sin(p[1] * q + p[2]) * d


@numba.njit(cache=True)
def window(p, q, v, d, t, u):
    """Friction in one direction between two positions: outside the catalogue."""
    inside = 0.5 * (np.tanh((q - p[1]) / p[3]) - np.tanh((q - p[2]) / p[3]))
    return p[0] * inside * max(d, 0.0)


@numba.njit(cache=True)
def slips(p, q, v, d, t, u):
    """A clamp that slips at moments that nothing measured foretells, about every p[1] s: outside the catalogue."""
    k = np.floor(t / p[1])
    at = p[1] * (k + 0.2 + 0.6 * (np.sin(12.9898 * k + p[2]) * 43758.5453 % 1.0))
    s = (t - at) / p[3]
    kick = np.sin(np.pi * s) ** 2 if 0.0 < s < 1.0 else 0.0
    return p[0] * kick * (1.0 if np.sin(78.233 * k + p[2]) > 0 else -1.0)


@dataclass(frozen=True)
class Kind:
    """law: a torque, or None where the effect is none. draw(rng) -> parameters, the first of which its size will set.

    names: what p is called outside. port: "force"; "delay", "lag" (p[0] in s); "inertia" (declared too small by p[0]).
    known: whether it is in the catalogue of effect names.
    """

    draw: Callable[[np.random.Generator], tuple[float, ...]]
    names: tuple[str, ...]
    law: Callable | None = None
    port: str = "force"
    known: bool = True


def phase(rng) -> float:
    return rng.uniform(-np.pi, np.pi)


EFFECTS: dict[str, Kind] = {
    "stribeck_friction": Kind(lambda r: (1.0, r.uniform(0.2, 1.5)), ("drop", "speed"), stribeck),
    "cogging": Kind(
        lambda r: (1.0, r.choice([2.0, 60.0, 150.0, 300.0]), phase(r), r.uniform(0.0, 0.3), phase(r)),
        ("amplitude", "order", "phase", "second", "phase_2"), cogging,
    ),
    "coulomb_asymmetry": Kind(lambda r: (1.0, r.uniform(0.0, 0.15)), ("coulomb", "viscous"), asymmetry),
    "nonlinear_viscous_friction": Kind(lambda r: (r.choice([-1.0, 1.0]),), ("quadratic",), nonlinear_viscous),
    "constant_offset": Kind(lambda r: (r.choice([-1.0, 1.0]),), ("offset",), offset),
    "cable_spring": Kind(lambda r: (1.0, r.uniform(-3.0, 3.0)), ("stiffness", "rest"), cable),
    "gravity": Kind(lambda r: (1.0, phase(r)), ("mgl", "phase"), weight),
    "load_dependent_friction": Kind(lambda r: (1.0,), ("mu",), loaded),
    "friction_drift": Kind(lambda r: (1.0, 0.0), ("rate", "from"), drift),
    "cyclic_friction": Kind(lambda r: (1.0, r.choice([1.0, 2.0, 30.0]), phase(r)), ("amplitude", "order", "phase"), cyclic),
    "transport_delay": Kind(lambda r: (1.0,), ("delay",), port="delay"),
    "actuator_lag": Kind(lambda r: (1.0,), ("time_constant",), port="lag"),
    "inertia": Kind(lambda r: (r.choice([-1.0, 1.0]),), ("inertia",), port="inertia"),
    "window_friction": Kind(
        lambda r: (1.0, *(r.uniform(-0.6, -0.2) + np.array([0.0, r.uniform(0.4, 0.8)])), 0.01),
        ("amplitude", "from", "to", "edge"), window, known=False,
    ),
    "slip_moments": Kind(lambda r: (1.0, r.uniform(0.6, 1.2), phase(r), 0.08), ("amplitude", "every", "seed", "length"), slips, known=False),
}  # fmt: skip
WIDTH = 5  # parameters a law may have
FORCES = tuple(name for name, kind in EFFECTS.items() if kind.law is not None)


@cache
def every_law():
    """The sum of all laws, law k with row k of its table of parameters; a row that begins with zero costs nothing."""

    def one(k, law):
        @numba.njit
        def term(table, q, v, d, t, u):
            return law(table[k], q, v, d, t, u) if table[k, 0] != 0.0 else 0.0

        return term

    def both(f, g):
        @numba.njit
        def total(table, q, v, d, t, u):
            return f(table, q, v, d, t, u) + g(table, q, v, d, t, u)

        return total

    terms = [one(k, EFFECTS[name].law) for k, name in enumerate(FORCES)]
    while len(terms) > 1:
        terms = [both(*terms[k : k + 2]) if k + 1 < len(terms) else terms[k] for k in range(0, len(terms), 2)]
    return terms[0]


TOTAL = every_law()


# --- the axis ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Axis:
    """inertia kg*m^2, viscous N*m*s/rad, h0 N*m, rate 1/rad, delay and lag s. forces: law name -> parameters."""

    inertia: float
    viscous: float
    h0: float
    rate: float
    delay: float = 0.0
    lag: float = 0.0
    forces: dict[str, tuple[float, ...]] = field(default_factory=dict)

    def table(self) -> np.ndarray:
        rows = np.zeros((len(FORCES), WIDTH))
        for name, p in self.forces.items():
            rows[FORCES.index(name), : len(p)] = p
        return rows


@numba.njit(cache=True)
def simulate(axis, table, start, reference, speed, injected, q_log, u_log, d_log, v_log):
    """Integrate one record from rest, friction relaxed; fills the logs, one value a step.

    axis: inertia, viscous, h0, rate, delay, lag. reference, speed: what the cascade follows, per control sample. injected:
    torque added to the command. u_log is the command as the drive reports it, before delay and lag.
    """
    inertia, viscous, h0, rate, delay, lag = axis
    h = 1.0 / RATE
    points = np.empty((DEPTH, 2))
    depth, way, d = 0, 0.0, 0.0
    q, v, applied = 0.0, 0.0, 0.0
    read, filtered, integral, command = 0.0, 0.0, 0.0, 0.0
    ts = PER_CONTROL * h
    smooth = 1.0 - np.exp(-2.0 * np.pi * 250.0 * ts)
    gain, stiffness = inertia * 2.0 * np.pi * 22.0, 2.0 * np.pi * 6.0
    back = delay / h
    whole = int(back)
    part = back - whole
    keep = h / (lag + 0.5 * h) if lag > 0.0 else 1.0
    before = 0.0
    for n in range(q_log.size):
        if n % PER_CONTROL == 0:
            k = n // PER_CONTROL
            y = COUNT * np.floor(q / COUNT + 0.5)
            filtered += smooth * ((y - read) / ts - filtered)
            read = y
            error = stiffness * (reference[k] - y) + speed[k] - filtered
            wanted = gain * (error + integral) + injected[k]
            command = min(max(wanted, -LIMIT), LIMIT)
            if wanted == command:
                integral += 2.0 * np.pi * 4.0 * ts * error
        u_log[n] = command
        late = u_log[n - whole] if n >= whole else 0.0
        later = u_log[n - whole - 1] if n >= whole + 1 else 0.0
        late = (1.0 - part) * late + part * later
        if lag > 0.0:  # trapezoidal: no phase of its own
            applied += keep * (0.5 * (late + before) - applied)
            before = late
        else:
            applied = late
        resisting = viscous * v + h0 * d + TOTAL(table, q, v, d, start + n * h, applied)
        q_log[n], d_log[n], v_log[n] = q, d, v
        v += h * (applied - resisting) / inertia
        moved = h * v
        if moved != 0.0:
            if way == 0.0:
                way = np.sign(moved)
            elif moved * way < 0.0:
                depth, way = turn(points, depth, way, q, d)
            q += moved
            depth, way, d = turning(points, depth, way, q, rate)


@numba.njit(cache=True)
def along(table, q, v, d, t, u):
    """The torque (n,) of the laws along a motion."""
    out = np.empty(q.size)
    for n in range(q.size):
        out[n] = TOTAL(table, q[n], v[n], d[n], t[n], u[n])
    return out


# --- motions ----------------------------------------------------------------------------------------------------------
# Each returns (reference, speed, injected torque) per control sample.


def clock(seconds: float) -> np.ndarray:
    return np.arange(round(seconds * RATE / PER_CONTROL)) * PER_CONTROL / RATE


def gliding(speed: np.ndarray, seconds: float) -> np.ndarray:
    """A running mean, so that steps of a speed become ramps."""
    n = max(1, round(seconds * RATE / PER_CONTROL))
    total = np.cumsum(np.concatenate([np.full(n, speed[0]), speed]))
    return (total[n:] - total[:-n]) / n


def slow_sine(rng, short: bool):
    """0.2 Hz, amplitudes 0.0024, 0.02, 0.2, 1.2 rad (short: the two that matter most, at 0.4 Hz)."""
    period, amplitudes = (2.5, (0.02, 1.2)) if short else (5.0, (0.0024, 0.02, 0.2, 1.2))
    t = clock(period * len(amplitudes))
    a = np.array(amplitudes)[np.minimum((t / period).astype(int), len(amplitudes) - 1)]
    a[0] = 0.0
    reference = gliding(a, 0.3) * np.sin(2 * np.pi * t / period)
    return reference, np.gradient(reference, t), np.zeros(t.size)


def multisine(rng, short: bool):
    """1 to 90 Hz, of equal torque, on top of a slow sweep of 1.4 rad."""
    t = clock(4.0 if short else 12.0)
    lines = np.arange(1.0, 90.5, 2.0) + rng.uniform(-0.2, 0.2, 45)
    injected = (
        0.33
        * np.sqrt(2 / lines.size)
        * np.sin(2 * np.pi * np.outer(t, lines) + rng.uniform(0, 2 * np.pi, 45)).sum(axis=1)
    )
    frequency = 0.5 if short else 0.25
    reference = 1.4 * np.sin(2 * np.pi * frequency * t) * np.minimum(t, 1.0)
    return reference, np.gradient(reference, t), injected * np.minimum(2 * t, 1.0)


def staircase(rng, short: bool):
    """Speeds of both signs between 0.05 and 14 rad/s."""
    speeds = (0.1, 1.5, 14.0) if short else (0.05, 0.15, 0.4, 1.0, 2.5, 6.0, 14.0)
    each = 0.8 if short else 0.9
    levels = np.array([0.0, *(s * way for s in speeds for way in (1.0, -1.0)), 0.0])
    t = clock(each * (levels.size - 1))
    speed = gliding(levels[1:][np.minimum((t / each).astype(int), levels.size - 2)], 0.12)
    speed = speed - speed[0]
    return np.cumsum(speed) * PER_CONTROL / RATE, speed, np.zeros(t.size)


def moves(rng, short: bool):
    """Point-to-point moves of random length with dwells, then small raw steps."""
    t = clock(4.5 if short else 10.0)
    reference, at, end = np.zeros(t.size), 0.0, 0.2
    raw = t[-1] * 0.8
    while end < raw - 0.6:
        to = rng.uniform(-2.5, 2.5)
        length = max(0.15, 1.9 * abs(to - at) / rng.uniform(6.0, 15.0))
        s = np.clip((t - end) / length, 0.0, 1.0)
        reference += (to - at) * s**3 * (10 - 15 * s + 6 * s**2)
        at, end = to, end + length + rng.uniform(0.1, 0.6)
    speed = np.gradient(reference, t)
    while end < t[-1]:
        reference[t >= end] += rng.choice([-1, 1]) * rng.uniform(5e-4, 2e-2)
        end += rng.uniform(0.15, 0.3)
    return reference, speed, np.zeros(t.size)


RECORDS = (
    ("id_slow_sine", "identification", slow_sine, "slow position sines"),
    ("id_multisine", "identification", multisine, "multisine torque injection 1-90 Hz on top of a slow sweep"),
    ("id_staircase", "identification", staircase, "velocity staircase"),
    ("val_moves", "validation", moves, "random point-to-point moves with dwells, then small raw steps"),
)


# --- logging ----------------------------------------------------------------------------------------------------------


@cache
def decimation() -> np.ndarray:
    """A low pass of linear phase, 8 ms long, flat to 250 Hz: Blackman's window on a sinc of 400 Hz."""
    n = np.arange(-80, 81)
    taps = np.sinc(2 * 400.0 / RATE * n) * np.blackman(n.size)
    return taps / taps.sum()


def decimated(x: np.ndarray) -> np.ndarray:
    """Samples at the log rate, group delay compensated. The command begins at zero and ends as it is."""
    taps = decimation()
    half = taps.size // 2
    padded = np.concatenate([np.full(half, x[0]), x, np.full(half, x[-1])])
    size = 1 << (padded.size + taps.size - 1).bit_length()
    smooth = np.fft.irfft(np.fft.rfft(padded, size) * np.fft.rfft(taps, size), size)[2 * half : 2 * half + x.size]
    return smooth[::PER_SAMPLE]


def low_pass(x: np.ndarray, derivative: int = 0) -> np.ndarray:
    """1/(1 + (f/BAND)^8) without phase, for signals at the log rate; about 0.1 s at the ends are not to be used."""
    extended = np.concatenate([2 * x[0] - x[500:0:-1], x, 2 * x[-1] - x[-2:-502:-1]])
    f = np.fft.rfftfreq(extended.size, PER_SAMPLE / RATE)
    spectrum = np.fft.rfft(extended) * (2j * np.pi * f) ** derivative / (1 + (f / BAND) ** 8)
    return np.fft.irfft(spectrum, extended.size)[500 : 500 + x.size]


@dataclass(frozen=True, eq=False)
class Run:
    """One record at the log rate: time, true command u, friction of height one d, true position q and speed v."""

    start: float
    u: np.ndarray
    q: np.ndarray
    v: np.ndarray
    d: np.ndarray

    @property
    def t(self) -> np.ndarray:
        return self.start + np.arange(self.q.size) * PER_SAMPLE / RATE


def run(axis: Axis, start: float, motion) -> Run:
    steps = motion[0].size * PER_CONTROL
    logs = np.zeros((4, steps))
    facts = np.array([axis.inertia, axis.viscous, axis.h0, axis.rate, axis.delay, axis.lag])
    simulate(facts, axis.table(), start, *motion, *logs)
    q, u, d, v = logs
    return Run(start, decimated(u), q[::PER_SAMPLE].copy(), v[::PER_SAMPLE].copy(), d[::PER_SAMPLE].copy())


def runs(axis: Axis, seed: int, short: bool) -> list[Run]:
    """The four records, with motions that depend on the seed alone."""
    rng = np.random.default_rng([seed, 1])
    found, start = [], 0.0
    for _, _, make, _ in RECORDS:
        found.append(run(axis, start, make(rng, short)))
        start = float(np.ceil(found[-1].t[-1] + 2.0))
    return found


# --- how large an effect is ---------------------------------------------------------------------------------------------


def unabsorbed(nominal: list[Run], axis: Axis, name: str, p: tuple[float, ...]) -> float:
    """Return the rms, on the identification records, of what the declared model cannot absorb of an effect with p[0] = 1.

    Its torque along the motions of the plain axis, less its projection on the free columns of the declared model and on
    what a change of the presliding rate would make.
    """
    kind, wrong, columns = EFFECTS[name], [], []
    for r, (_, role, _, _) in zip(nominal, RECORDS, strict=True):
        if role != "identification":
            continue
        if kind.law is not None:
            torque = along(replace(axis, forces={name: p}).table(), r.q, r.v, r.d, r.t, r.u)
        else:  # a change of inertia, or the first order of a delay or lag
            torque = np.gradient(r.v if kind.port == "inertia" else r.u, PER_SAMPLE / RATE)
        change = masing(r.q, 1.01 * axis.rate) - masing(r.q, axis.rate)
        wrong.append(low_pass(torque)[UNUSED:-UNUSED])
        columns.append(np.stack([low_pass(c)[UNUSED:-UNUSED] for c in (r.v, r.d, change)]))
    y, a = np.concatenate(wrong), np.concatenate(columns, axis=1).T
    a = a / np.linalg.norm(a, axis=0)
    return float(np.sqrt(np.mean((y - a @ np.linalg.lstsq(a, y, rcond=None)[0]) ** 2)))


# --- campaigns --------------------------------------------------------------------------------------------------------


def drawn(rng) -> Axis:
    """An axis of this kind."""
    around = lambda value, part: value * np.exp(rng.uniform(-part, part))  # noqa: E731
    return Axis(around(0.0026, 0.3), around(0.011, 0.3), around(0.15, 0.3), around(650.0, 0.4))


def with_effect(axis: Axis, name: str, p: tuple[float, ...]) -> Axis:
    kind = EFFECTS[name]
    if kind.law is not None:
        return replace(axis, forces={**axis.forces, name: p})
    return axis if kind.port == "inertia" else replace(axis, **{kind.port: axis.__dict__[kind.port] + p[0]})


def declaration(axis: Axis, guess: dict[str, float], title: str, starts: list[float], records=RECORDS) -> str:
    """The text of campaign.toml: the plain axis, inertia as from a data sheet, the rest roughly."""
    said = [
        f'title = "{title}"', 'plant = "one mass"', f'evaluation_bandwidth = {{ value = {BAND}, unit = "Hz" }}',
        f'actuator_limit = {{ value = {LIMIT}, unit = "N*m" }}', "", "[geometry]", "gear_ratio = 30", "pole_pairs = 5",
        "", "[channels.time]", 'column = "time_s"', 'unit = "s"',
        "", "[channels.torque]", 'column = "torque_Nm"', 'unit = "N*m"',
        "", "[channels.position]", 'column = "position_rad"', 'unit = "rad"', f"resolution = {COUNT!r}",
    ]  # fmt: skip
    effects = {
        "inertia": (("inertia", "kg*m^2", True),),
        "viscous_friction": (("viscous", "N*m*s/rad", False),),
        "presliding_hysteresis": (("h0", "N*m", False), ("a", "1/rad", False)),
    }
    for name, parameters in effects.items():
        said += ["", "[[effects]]", f'effect = "{name}"', 'at = "axis"']
        for parameter, unit, fixed in parameters:
            held = str(fixed).lower()
            said.append(
                f'parameters.{parameter} = {{ value = {guess[parameter]:.4g}, unit = "{unit}", fixed = {held} }}'
            )
    for (stem, role, _, motion), start in zip(records, starts, strict=True):
        said += ["", "[[records]]", f'file = "{stem}.csv"', f'role = "{role}"', f'motion = "{motion}"']
        said.append(f"start_time_s = {start}")
    return "\n".join(said) + "\n"


def logged(folder: Path, made: list[Run], noise: float, rng, records=RECORDS) -> dict[str, float]:
    """Write a CSV a record, torque with noise and position in counts; return role -> nrmse that the noise alone leaves."""
    white = noise / np.sqrt(np.mean(1 / (1 + (np.linspace(0, 500, 5001) / BAND) ** 8) ** 2))
    left, power = dict.fromkeys(ROLES, 0.0), dict.fromkeys(ROLES, 0.0)
    for r, (stem, role, _, _) in zip(made, records, strict=True):
        torque = r.u + white * rng.standard_normal(r.u.size)
        keep = slice(UNUSED, -UNUSED)
        left[role] += np.sum(low_pass(torque - r.u)[keep] ** 2)
        power[role] += np.sum(low_pass(torque)[keep] ** 2)
        counts = np.floor(r.q / COUNT + 0.5)
        rows = np.column_stack([r.t, torque, counts * COUNT])
        text = "\n".join(map("%.5f,%.5f,%.9f".__mod__, map(tuple, rows.tolist())))
        (folder / f"{stem}.csv").write_text(f"time_s,torque_Nm,position_rad\n{text}\n", encoding="utf-8")
    return {role: float(np.sqrt(left[role] / power[role])) for role in ROLES if power[role] > 0.0}


def campaign(
    folder: Path, seed: int, missing: tuple[str, ...] = ("stribeck_friction",), size: float = 1.0, *,
    noise: float = 2e-3, short: bool = False,
) -> dict:  # fmt: skip
    """Write a campaign folder whose declared model lacks `missing`, and return the truth.

    size: what the declared model cannot absorb of each effect, in units of LEVEL times the noise. noise: rms of the torque
    noise in the evaluation band, N*m (white at the log rate). short: records of a third of the length.
    The truth: missing (as a trace should name it: ["unknown"] for what no catalogue has), effects (as given), parameters,
    axis, floor: role -> nrmse that the torque noise alone leaves, and rig: the Axis itself, for further records of it.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng([seed, 0])
    plain = drawn(rng)
    nominal = runs(plain, seed, short)
    axis, parameters, wrong_inertia = plain, {}, 0.0
    for name in missing:
        kind = EFFECTS[name]
        p = tuple(float(x) for x in kind.draw(rng))
        p = (p[0] * size * LEVEL * noise / unabsorbed(nominal, plain, name, p), *p[1:])
        axis = with_effect(axis, name, p)
        parameters[name] = dict(zip(kind.names, p, strict=True))
        wrong_inertia += p[0] if kind.port == "inertia" else 0.0
    made = runs(axis, seed, short) if missing else nominal
    floor = logged(folder, made, noise, rng)
    guess = {
        "inertia": plain.inertia - wrong_inertia,
        "viscous": plain.viscous * rng.uniform(0.9, 1.1),
        "h0": plain.h0 * rng.uniform(0.9, 1.1),
        "a": plain.rate * rng.uniform(0.9, 1.1),
    }
    text = declaration(plain, guess, f"rig {seed}: one mass, one encoder", [r.start for r in made])
    (folder / "campaign.toml").write_text(text, encoding="utf-8")
    known = [n for n in missing if EFFECTS[n].known]
    return {
        "missing": known if len(known) == len(missing) else ["unknown"],
        "effects": list(missing),
        "parameters": parameters,
        "axis": {k: getattr(plain, k) for k in ("inertia", "viscous", "h0", "rate")},
        "floor": floor,
        "rig": axis,
    }
