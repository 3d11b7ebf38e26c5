"""Everything of the rig that is compiled: friction with memory, the laws of its effects, and the integrator.

It is one module because numba's cache looks at the file of the function that it has kept, not at those of what this calls.
"""

from typing import NamedTuple

import numba
import numpy as np

RATE = 20_000  # Hz, of the integration
PER_CONTROL = 5  # steps a control sample: 4 kHz
H = 1.0 / RATE
LIMIT = 3.0  # N*m, of the drive
DEPTH = 512  # turning points remembered
MOVER, LOAD, JOINT = 0, 1, 2  # where a law acts; the axis of one mass is its mover
WIDTH = 5  # parameters a law may have
STATES = 4  # and states


class Axis(NamedTuple):
    """The facts of an axis, SI as seen at the output. What is zero does nothing.

    Friction with memory: h0 (1 - exp(-rate x)) at the mover, h1, rate1 beside it, h2, rate2 in the joint. The joint of two
    masses: k2 and c2 act on the deflection, less lost motion of half width gap, plus a tooth error tooth sin(turns q + phase);
    at moments it slips by slid, and stays there.
    Drive: delay and lag in s, fall of the torque constant, torque in steps of grain. Encoder: reads
    q + error sin(error_turns q + error_phase) + trend t, and skips counts at moments. Clock of the (load) position: late by
    late + skew t.
    """

    inertia: float
    viscous: float
    h0: float
    rate: float
    h1: float = 0.0
    rate1: float = 0.0
    load_inertia: float = 0.0
    load_viscous: float = 0.0
    load_h: float = 0.0
    k2: float = 0.0
    c2: float = 0.0
    h2: float = 0.0
    rate2: float = 0.0
    gap: float = 0.0
    tooth: float = 0.0
    tooth_turns: float = 0.0
    tooth_phase: float = 0.0
    delay: float = 0.0
    lag: float = 0.0
    fall: float = 0.0
    grain: float = 0.0
    error: float = 0.0
    error_turns: float = 0.0
    error_phase: float = 0.0
    trend: float = 0.0
    lost: float = 0.0
    lost_every: float = 1.0
    slid: float = 0.0
    slid_every: float = 1.0
    slid_seed: float = 0.0
    late: float = 0.0
    skew: float = 0.0
    count: float = 4.848e-6


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
def rub(points, memory, x, rate):
    """Move a contact to x; return its force of height one. memory: depth, way, force and position of the last call."""
    moved = x - memory[3]
    if moved != 0.0:
        depth, way, force = int(memory[0]), memory[1], memory[2]
        if way == 0.0:
            way = np.sign(moved)
        elif moved * way < 0.0:
            depth, way = turn(points, depth, way, memory[3], force)
        depth, way, force = turning(points, depth, way, x, rate)
        memory[0], memory[1], memory[2], memory[3] = depth, way, force, x
    return memory[2]


@numba.njit(cache=True)
def masing(position, rate):
    """Return the force (n,) of height one along a position (n,) that begins relaxed, virgin curve 1 - exp(-rate x)."""
    out = np.empty(position.size)
    points, memory = np.empty((DEPTH, 2)), np.zeros(4)
    for n in range(position.size):
        out[n] = rub(points, memory, position[n] - position[0], rate)
    return out


# --- laws -------------------------------------------------------------------------------------------------------------
# law(p, s, q, v, d, t, u) is a torque that resists the motion: p its parameters (p[0] its size, zero where it is absent),
# s its states, q and v the motion at its place (deflection in the joint), d the friction of height one there, t the bench
# clock, u the applied torque.


@numba.njit(cache=True)
def stribeck(p, s, q, v, d, t, u):
    return p[0] * np.exp(-((v / p[1]) ** 2)) * d


@numba.njit(cache=True)
def cogging(p, s, q, v, d, t, u):
    return p[0] * (np.sin(p[1] * q + p[2]) + p[3] * np.sin(2.0 * p[1] * q + p[4]))


@numba.njit(cache=True)
def asymmetry(p, s, q, v, d, t, u):
    return p[0] * (abs(d) + p[1] * abs(v))


@numba.njit(cache=True)
def nonlinear_viscous(p, s, q, v, d, t, u):
    return p[0] * v * abs(v)


@numba.njit(cache=True)
def offset(p, s, q, v, d, t, u):
    return p[0]


@numba.njit(cache=True)
def cable(p, s, q, v, d, t, u):
    return p[0] * (q - p[1])


@numba.njit(cache=True)
def weight(p, s, q, v, d, t, u):
    return p[0] * np.sin(q + p[1])


@numba.njit(cache=True)
def loaded(p, s, q, v, d, t, u):
    """Friction by the torque that the gear passes on, which the integrator leaves in s[0]."""
    return p[0] * abs(s[0]) * d


@numba.njit(cache=True)
def drift(p, s, q, v, d, t, u):
    return p[0] * (t - p[1]) * d


@numba.njit(cache=True)
def cyclic(p, s, q, v, d, t, u):
    return p[0] * (np.sin(p[1] * q + p[2]) * d + p[3] * np.sin(p[1] * q + p[4]) * v)


@numba.njit(cache=True)
def creeping(p, s, q, v, d, t, u):
    """Two springs whose feet follow at the rates p[1] and p[2]; p[3] is the second's share of the first."""
    first, second = q - s[0], q - s[1]
    s[0] += H * p[1] * first
    s[1] += H * p[2] * second
    return p[0] * (first + p[3] * second)


@numba.njit(cache=True)
def forgetting(p, s, q, v, d, t, u):
    """dT = (p[0] dq - T |dq|)/p[1]: a force that forgets over the distance p[1]."""
    gone = np.exp(-abs(v) * H / p[1])
    s[0] = s[0] * gone + (1.0 - gone) * np.sign(v)
    return p[0] * s[0]


@numba.njit(cache=True)
def bristles(p, s, q, v, d, t, u):
    """LuGre: bristles that carry p[0] when sliding, p[1] long, p[2] more of it at rest, to p[3] rad/s; damping p[4] s."""
    g = p[1] * (1.0 + p[2] * np.exp(-((v / p[3]) ** 2)))
    before = s[0]
    s[0] = (before - np.sign(v) * g) * np.exp(-abs(v) * H / g) + np.sign(v) * g
    return p[0] / p[1] * (s[0] + p[4] * (s[0] - before) / H)


@numba.njit(cache=True)
def swinging(p, s, q, v, d, t, u):
    """A part of inertia p[0] on a spring and damper: p[1] Hz with the axis held, damping ratio p[2]."""
    w = 2.0 * np.pi * p[1]
    pull = w * w * (q - s[0]) + 2.0 * p[2] * w * (v - s[1])
    s[1] += H * pull
    s[0] += H * s[1]
    return p[0] * pull


@numba.njit(cache=True)
def hardening(p, s, q, v, d, t, u):
    return p[0] * q * q * q


@numba.njit(cache=True)
def second_slope(p, s, q, v, d, t, u):
    return p[0] * max(abs(q) - p[1], 0.0) * np.sign(q)


@numba.njit(cache=True)
def in_series(p, s, q, v, d, t, u):
    """The torque T at which T_f/K_f atan(T/T_f) + T_w/K_w (1 - exp(-T/T_w)) is |q|, by bisection.

    p: 1/T_f, K_f, T_w/T_f, K_w, and the stiffness of what is declared, whose torque it takes the place of.
    """
    x, tf = abs(q), 1.0 / p[0]
    tw = tf * p[2]
    low, high = 0.0, tf * np.tan(min(x * p[1] / tf, 1.5)) + 1e-12
    for _ in range(40):
        torque = 0.5 * (low + high)
        if tf / p[1] * np.arctan(torque / tf) + tw / p[3] * (1.0 - np.exp(-torque / tw)) < x:
            low = torque
        else:
            high = torque
    return 0.5 * (low + high) * np.sign(q) - p[4] * q


@numba.njit(cache=True)
def window(p, s, q, v, d, t, u):
    """Friction in one direction between two positions."""
    inside = 0.5 * (np.tanh((q - p[1]) / p[3]) - np.tanh((q - p[2]) / p[3]))
    return p[0] * inside * max(d, 0.0)


@numba.njit(cache=True)
def slip_at(k, every, seed):
    """The k-th moment: one in each interval of `every` s, anywhere in its middle part."""
    return every * (k + 0.2 + 0.6 * (np.sin(12.9898 * k + seed) * 43758.5453 % 1.0))


@numba.njit(cache=True)
def slips(p, s, q, v, d, t, u):
    """A clamp that slips at moments that nothing measured foretells, about every p[1] s, for p[3] s."""
    k = np.floor(t / p[1])
    x = (t - slip_at(k, p[1], p[2])) / p[3]
    kick = np.sin(np.pi * x) ** 2 if 0.0 < x < 1.0 else 0.0
    return p[0] * kick * (1.0 if np.sin(78.233 * k + p[2]) > 0 else -1.0)


@numba.njit(cache=True)
def fan(p, s, q, v, d, t, u):
    """A fan of p[1] Hz that runs from p[2] s to p[3] s of the bench clock and shakes the axis."""
    return p[0] * np.sin(2.0 * np.pi * p[1] * t + p[4]) if p[2] < t < p[3] else 0.0


@numba.njit(cache=True)
def rattle(p, s, q, v, d, t, u):
    """A part that rattles at p[1] Hz while the speed, of either direction, is between p[2] and p[3]."""
    return p[0] * np.sin(2.0 * np.pi * p[1] * t + p[4]) if p[2] < abs(v) < p[3] else 0.0


@numba.njit(cache=True)
def hard_spot(p, s, q, v, d, t, u):
    """A place, p[2] wide, that is hard to pass backwards, the more so the more torque is on it."""
    return -p[0] * abs(u) * np.exp(-(((q - p[1]) / p[2]) ** 2)) * max(-d, 0.0)


LAWS = (
    stribeck, cogging, asymmetry, nonlinear_viscous, offset, cable, weight, loaded, drift, cyclic, creeping, forgetting,
    bristles, swinging, hardening, second_slope, in_series, window, slips, fan, rattle, hard_spot,
)  # fmt: skip
ROW = {law.__name__: k for k, law in enumerate(LAWS)}


def every_law():
    """The sum of all laws that act at one place, law k with row k of the tables of parameters, states and places.

    One function, of a text, and no closures one in another: these all bear one name, told apart by a counter of the process alone, and
    where one process reads what two others have compiled it may take the law of one for that of another.
    """
    given = "(p[{0}], s[{0}], q, v, d, t, u) if places[{0}] == place else 0.0"
    terms = [f"({law.__name__}{given.format(k)})" for k, law in enumerate(LAWS)]
    while len(terms) > 1:  # summed in pairs
        terms = [f"({' + '.join(terms[k : k + 2])})" for k in range(0, len(terms), 2)]
    named = {law.__name__: law for law in LAWS}
    exec(f"def total(p, s, places, place, q, v, d, t, u):\n    return {terms[0]}\n", named)  # noqa: S102
    return numba.njit(named["total"])


TOTAL = every_law()
LOADED, OFFSET, CABLE, WEIGHT = (ROW[n] for n in ("loaded", "offset", "cable", "weight"))


@numba.njit(cache=True)
def standing(p, s, places, q):
    """What of one mass pulls at the gear at rest: a constant load, a spring, a weight."""
    total = offset(p[OFFSET], s[OFFSET], q, 0.0, 0.0, 0.0, 0.0) if places[OFFSET] == MOVER else 0.0
    total += cable(p[CABLE], s[CABLE], q, 0.0, 0.0, 0.0, 0.0) if places[CABLE] == MOVER else 0.0
    return total + (weight(p[WEIGHT], s[WEIGHT], q, 0.0, 0.0, 0.0, 0.0) if places[WEIGHT] == MOVER else 0.0)


# --- the integrator ---------------------------------------------------------------------------------------------------


@numba.njit(cache=True)
def reading(axis, q, t):
    """What the encoder says, before it counts: eccentric, drifting, and some counts short after each moment of loss."""
    y = q + axis.error * np.sin(axis.error_turns * q + axis.error_phase) + axis.trend * t
    if axis.lost != 0.0:
        y += axis.lost * np.floor(t / axis.lost_every)
    return y


@numba.njit(cache=True)
def applied_torque(axis, u):
    """What the drive makes of a command: in steps, and less where iron saturates."""
    if axis.grain > 0.0:
        u = axis.grain * np.floor(u / axis.grain + 0.5)
    return u / np.sqrt(1.0 + axis.fall * u * u)


@numba.njit(cache=True)
def slid(axis, t):
    """By how much a coupling has slipped until t: by a step, one way or the other, at moments as those of `slips`."""
    total = 0.0
    if axis.slid != 0.0:
        for k in range(int(t / axis.slid_every) + 1):
            if t > slip_at(k, axis.slid_every, axis.slid_seed):
                total += axis.slid if np.sin(78.233 * k + axis.slid_seed) > 0 else -axis.slid
    return total


@numba.njit(cache=True)
def simulate(axis, p, places, start, reference, speed, injected, closed, locked, q_log, ql_log, u_log):
    """Integrate one record from rest, friction relaxed; fills the logs (n,), one value a step.

    p (laws, WIDTH), places (laws,): parameters of the laws and where each acts (-1: nowhere). reference, speed, injected:
    what the cascade follows and the torque added to its command, per control sample; not closed: that torque alone.
    u_log is the command as the drive reports it, before delay and lag; q_log the encoder's reading before it counts.
    """
    two = axis.load_inertia > 0.0
    s = np.zeros((p.shape[0], STATES))
    points, memory = np.empty((4, DEPTH, 2)), np.zeros((4, 4))
    at, pace, dry, force = np.zeros((4, 3))
    damping = (axis.viscous, axis.load_viscous, axis.c2)
    friction = (axis.h0, axis.load_h, axis.h2)
    q, v, ql, vl, applied, before = 0.0, 0.0, slid(axis, start), 0.0, 0.0, 0.0  # at rest, the joint relaxed
    pull, gained = 0.0, 0.0  # of the joint, and the acceleration, a step before
    ts = PER_CONTROL * H
    smooth = 1.0 - np.exp(-2.0 * np.pi * 250.0 * ts)
    gain, stiffness = (axis.inertia + axis.load_inertia) * 2.0 * np.pi * 22.0, 2.0 * np.pi * 6.0
    if two:
        gain *= 0.6
    read, filtered, integral, command = (
        axis.count * np.floor(reading(axis, 0.0, start) / axis.count + 0.5),
        0.0,
        0.0,
        0.0,
    )
    home = read
    whole = int(axis.delay / H)
    part = axis.delay / H - whole
    keep = H / (axis.lag + 0.5 * H) if axis.lag > 0.0 else 1.0
    for n in range(q_log.size):
        t = start + n * H
        y = reading(axis, q, t)
        if n % PER_CONTROL == 0:
            k = n // PER_CONTROL
            if closed:
                counted = axis.count * np.floor(y / axis.count + 0.5)
                filtered += smooth * ((counted - read) / ts - filtered)
                read = counted
                error = stiffness * (reference[k] - (read - home)) + speed[k] - filtered
                wanted = gain * (error + integral) + injected[k]
                command = min(max(wanted, -LIMIT), LIMIT)
                if wanted == command:
                    integral += 2.0 * np.pi * 4.0 * ts * error
            else:
                command = min(max(injected[k], -LIMIT), LIMIT)
        u_log[n], q_log[n], ql_log[n] = command, y, ql
        late = u_log[n - whole] if n >= whole else 0.0
        later = u_log[n - whole - 1] if n >= whole + 1 else 0.0
        late = applied_torque(axis, (1.0 - part) * late + part * later)
        if axis.lag > 0.0:  # trapezoidal: no phase of its own
            applied += keep * (0.5 * (late + before) - applied)
            before = late
        else:
            applied = late
        # what each place sees: position, speed, friction of height one
        at[MOVER], pace[MOVER], dry[MOVER] = q, v, rub(points[0], memory[0], q, axis.rate)
        by_motor = 1.0
        if two:
            at[LOAD], pace[LOAD], dry[LOAD] = ql, vl, rub(points[3], memory[3], ql, axis.rate)
            tooth = np.sin(axis.tooth_turns * q + axis.tooth_phase) - np.sin(axis.tooth_phase)
            x = q - ql + slid(axis, t) + axis.tooth * tooth  # the encoders were set to zero with the joint relaxed
            by_motor += axis.tooth * axis.tooth_turns * np.cos(axis.tooth_turns * q + axis.tooth_phase)
            taken = abs(x) > axis.gap
            at[JOINT] = x - axis.gap * np.sign(x) if taken else 0.0
            pace[JOINT] = by_motor * v - vl if taken else 0.0
            dry[JOINT] = rub(points[2], memory[2], at[JOINT], axis.rate2) if axis.rate2 > 0.0 else 0.0
        s[LOADED, 0] = pull if two else standing(p, s, places, q) + p[LOADED, 1] * axis.inertia * gained
        for place in range(3 if two else 1):
            force[place] = damping[place] * pace[place] + friction[place] * dry[place]
            force[place] += TOTAL(p, s, places, place, at[place], pace[place], dry[place], t, applied)
        if axis.h1 != 0.0:
            force[MOVER] += axis.h1 * rub(points[1], memory[1], q, axis.rate1)
        pull = force[JOINT] + axis.k2 * at[JOINT]
        gained = (applied - force[MOVER] - by_motor * pull) / axis.inertia
        v += H * gained
        if two and not locked:
            vl += H * (pull - force[LOAD]) / axis.load_inertia
            ql += H * vl
        q += H * v


@numba.njit(cache=True)
def along(p, places, place, q, v, d, t, u):
    """The torque (n,) of the stateless laws at one place along a motion."""
    out, s = np.empty(q.size), np.zeros((p.shape[0], STATES))
    for n in range(q.size):
        out[n] = TOTAL(p, s, places, place, q[n], v[n], d[n], t[n], u[n])
    return out
