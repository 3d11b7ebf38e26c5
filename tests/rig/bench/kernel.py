"""The compiled part of the bench: one axis, of one mass or two, under a cascade, with laws as nature may have them.

One module, because numba's cache looks at the file of the function that it has kept, not at those of what this calls.
"""

from typing import NamedTuple

import numba
import numpy as np

RATE = 40_000  # Hz, of the integration
H = 1.0 / RATE
GAUSS, LORENTZ, RATIONAL = 0, 1, 2  # shapes of a Stribeck peak; any other number is the exponent of exp(-|v/v_s|^p)
POWER, SATURATING = 0, 1  # of a drag over speed
TANH, CUBIC, ROOT = 0, 1, 2  # of a torque that saturates
SMOOTH_LOAD = 1.0 / 200.0  # s, in which contacts follow the load that they transmit


class Facts(NamedTuple):
    """The facts of an axis, SI. What is zero does nothing.

    Friction: h0 at the mover, load_h at the load, h2 in the joint, each over its bristles; behind play series_gap (half
    width) at the mover. Drag: curved sign(v) |v/curved_speed|^curved_power, or tanh(v/curved_speed). Peak: drop, drop_speed,
    drop_shape. mu of the load that a gear transmits: its weight and the share `behind` of the inertia; the joint's torque on
    two masses. Springs: spring (q - rest), the joint's k2, c2, k3 behind gap; k2 (1 + uneven sin(order ql + phase)) along
    the load's place. A window of friction in one direction. A cushion at cushion_at that sinks in and recovers (rates
    1/s). A mode: a part on a spring. fading: a force that forgets. Drive: delay, lag in s, fall (1 over a torque). The
    cascade: gain, stiffness, reset, smooth (Hz), forward (share of the inertia), count.
    disturbed: 0 at the mover, 1 at the load.
    """

    inertia: float
    viscous: float
    h0: float
    limit: float
    gain: float
    stiffness: float
    count: float
    forward: float = 0.0
    reset: float = 20.0
    smooth: float = 250.0
    load_inertia: float = 0.0
    load_viscous: float = 0.0
    load_h: float = 0.0
    k2: float = 0.0
    c2: float = 0.0
    k3: float = 0.0
    uneven: float = 0.0
    uneven_order: float = 0.0
    uneven_phase: float = 0.0
    h2: float = 0.0
    gap: float = 0.0
    series_gap: float = 0.0
    spring: float = 0.0
    rest: float = 0.0
    weight: float = 0.0
    weight_phase: float = 0.0
    offset: float = 0.0
    mu: float = 0.0
    behind: float = 0.0
    drop: float = 0.0
    drop_speed: float = 1.0
    drop_shape: float = 0.0
    asymmetry: float = 0.0
    asymmetry_viscous: float = 0.0
    curved: float = 0.0
    curved_kind: float = 0.0
    curved_power: float = 1.0
    curved_speed: float = 1.0
    cyclic: float = 0.0
    cyclic_order: float = 1.0
    cyclic_phase: float = 0.0
    window: float = 0.0
    window_from: float = 0.0
    window_to: float = 0.0
    window_edge: float = 1.0
    cushion: float = 0.0
    cushion_at: float = 0.0
    cushion_sinks: float = 0.0
    cushion_recovers: float = 0.0
    mode: float = 0.0
    mode_frequency: float = 1.0
    mode_damping: float = 0.0
    fading: float = 0.0
    fading_distance: float = 1.0
    delay: float = 0.0
    lag: float = 0.0
    fall: float = 0.0
    fall_kind: float = 0.0
    disturbed: float = 0.0


class Lists(NamedTuple):
    """What there is several of. bristles*, (n, 2): break-away distance, share of the height. Waves (n, 3): amplitude,
    order, phase: cogging (force), reading (the encoder's error), load_reading, tooth (the joint's). creeping (n, 2): rate
    in 1/s, stiffness."""

    bristles: np.ndarray
    load_bristles: np.ndarray
    joint_bristles: np.ndarray
    cogging: np.ndarray
    reading: np.ndarray
    load_reading: np.ndarray
    tooth: np.ndarray
    creeping: np.ndarray


@numba.njit(cache=True)
def waves(w, q):
    """sum A sin(order q + phase)."""
    y = 0.0
    for k in range(w.shape[0]):
        y += w[k, 0] * np.sin(w[k, 1] * q + w[k, 2])
    return y


@numba.njit(cache=True)
def slope(w, q):
    y = 0.0
    for k in range(w.shape[0]):
        y += w[k, 0] * w[k, 1] * np.cos(w[k, 1] * q + w[k, 2])
    return y


@numba.njit(cache=True)
def rub(z, bristles, moved):
    """Move a contact by `moved`; return its force of height one: springs that slip at their break-away distances."""
    f = 0.0
    for k in range(z.size):
        d = bristles[k, 0]
        z[k] = min(max(z[k] + moved, -d), d)
        f += bristles[k, 1] * z[k] / d
    return f


@numba.njit(cache=True)
def rubbed(position, bristles):
    """Return the force (n,) of height one along a position (n,) that begins relaxed."""
    z, out, before = np.zeros(bristles.shape[0]), np.empty(position.size), position[0]
    for n in range(position.size):
        out[n] = rub(z, bristles, position[n] - before)
        before = position[n]
    return out


@numba.njit(cache=True)
def met(z, bristles, side, room, moved, half):
    """Move a contact that lies behind play by `moved`; return its force of height one, which flank touches, and the way left.

    side: 1 or -1 where a flank touches, 0 in between; room: way to the rear flank. A flank pushes and never pulls: it lets go
    where the bristles would have to be pulled, and nothing is felt until the other one has crossed the play.
    """
    if side == 0.0:
        room = room + moved
        if 0.0 < room < 2.0 * half:
            return 0.0, 0.0, room
        side = 1.0 if room >= 2.0 * half else -1.0
        moved = room - 2.0 * half if side > 0.0 else room
    f = rub(z, bristles, moved)
    if f * side >= 0.0:
        return f, side, 2.0 * half if side > 0.0 else 0.0
    return 0.0, 0.0, 2.0 * half if side > 0.0 else 0.0


@numba.njit(cache=True)
def played(position, half):
    """What follows a position (n,) behind play of this half width."""
    out, at = np.empty(position.size), position[0]
    for n in range(position.size):
        at = min(max(at, position[n] - half), position[n] + half)
        out[n] = at
    return out


@numba.njit(cache=True)
def peak(shape, x):
    """A Stribeck peak over x = |v|/v_s: 1 at rest, 0 far away."""
    if shape == GAUSS:
        return np.exp(-x * x)
    if shape == LORENTZ:
        return 1.0 / (1.0 + x * x)
    if shape == RATIONAL:
        return 1.0 / (1.0 + x)
    return np.exp(-(x**shape))


@numba.njit(cache=True)
def drag(kind, power, x):
    """A drag over x = v/v_s, odd."""
    return np.tanh(x) if kind == SATURATING else np.sign(x) * abs(x) ** power


@numba.njit(cache=True)
def applied_torque(kind, fall, u):
    """What iron makes of a command: less, the larger it is; slope one at zero."""
    if fall == 0.0:
        return u
    x = fall * u
    if kind == TANH:
        return np.tanh(x) / fall
    if kind == CUBIC:
        x = min(max(x, -1.0), 1.0)
        return u - x**3 / 3.0 / fall
    return u / np.sqrt(1.0 + x * x)


@numba.njit(cache=True)
def simulate(
    a,
    lists,
    start,
    per_control,
    reference,
    speed,
    acceleration,
    injected,
    pushed,
    level,
    closed,
    locked,
    q_log,
    ql_log,
    u_log,
):
    """Integrate one record from rest, everything relaxed; fills the logs (n,), one value a step.

    Per control sample: reference, speed, acceleration, injected (added to the command), pushed (a force on the body that
    nobody reports) and level (a factor on the mover's friction). not closed: the injected torque alone. u_log is the command
    before delay and lag, q_log and ql_log the encoders' readings before they count.
    """
    two = a.load_inertia > 0.0
    z, zl, zj = (
        np.zeros(lists.bristles.shape[0]),
        np.zeros(lists.load_bristles.shape[0]),
        np.zeros(lists.joint_bristles.shape[0]),
    )
    feet = np.zeros(lists.creeping.shape[0])
    q = v = ql = vl = applied = before = carried = pull = last = joint_last = 0.0
    side, room = 0.0, a.series_gap
    sunk = part = part_v = forgot = filtered = integral = command = 0.0
    q = reference[0]
    ql = last = part = q
    feet[:] = q
    load_last = ql
    at_rest = waves(lists.tooth, q)
    ts = per_control * H
    smooth = 1.0 - np.exp(-2.0 * np.pi * a.smooth * ts)
    home = read = a.count * np.floor((q + waves(lists.reading, q)) / a.count + 0.5)
    whole = int(a.delay / H)
    share = a.delay / H - whole
    keep = H / (a.lag + 0.5 * H) if a.lag > 0.0 else 1.0
    w = 2.0 * np.pi * a.mode_frequency
    for n in range(q_log.size):
        k = n // per_control
        y = q + waves(lists.reading, q)
        if n % per_control == 0:
            if closed:
                counted = a.count * np.floor(y / a.count + 0.5)
                filtered += smooth * ((counted - read) / ts - filtered)
                read = counted
                error = a.stiffness * (reference[k] - reference[0] - (read - home)) + speed[k] - filtered
                wanted = a.gain * (error + integral) + a.forward * acceleration[k] + injected[k]
                command = min(max(wanted, -a.limit), a.limit)
                if wanted == command:
                    integral += a.reset * ts * error
            else:
                command = min(max(injected[k], -a.limit), a.limit)
        u_log[n], q_log[n], ql_log[n] = command, y, ql + waves(lists.load_reading, ql)
        late = u_log[n - whole] if n >= whole else 0.0
        later = u_log[n - whole - 1] if n >= whole + 1 else 0.0
        late = applied_torque(a.fall_kind, a.fall, (1.0 - share) * late + share * later)
        if a.lag > 0.0:  # trapezoidal: no phase of its own
            applied += keep * (0.5 * (late + before) - applied)
            before = late
        else:
            applied = late
        # friction at the mover
        if a.series_gap > 0.0:
            d, side, room = met(z, lists.bristles, side, room, q - last, a.series_gap)
        else:
            d = rub(z, lists.bristles, q - last)
        last = q
        height = a.h0 * level[k]
        if a.drop != 0.0:
            height += a.drop * peak(a.drop_shape, abs(v) / a.drop_speed)
        if a.cyclic != 0.0:
            height += a.cyclic * np.sin(a.cyclic_order * q + a.cyclic_phase)
        height += a.mu * abs(carried)
        if a.window != 0.0:
            inside = 0.5 * (np.tanh((q - a.window_from) / a.window_edge) - np.tanh((q - a.window_to) / a.window_edge))
            height += a.window * inside * (1.0 if d > 0.0 else 0.0)
        force = height * d + a.viscous * v
        if a.asymmetry != 0.0:
            force += a.asymmetry * abs(d) + a.asymmetry_viscous * abs(v)
        if a.curved != 0.0:
            force += a.curved * drag(a.curved_kind, a.curved_power, v / a.curved_speed)
        if a.fading != 0.0:
            gone = np.exp(-abs(v) * H / a.fading_distance)
            forgot = forgot * gone + (1.0 - gone) * np.sign(v)
            force += a.fading * forgot
        # what depends on position and time there
        force += waves(lists.cogging, q) + a.offset
        for i in range(feet.size):
            force += lists.creeping[i, 1] * (q - feet[i])
            feet[i] += H * lists.creeping[i, 0] * (q - feet[i])
        if a.mode != 0.0:
            swing = w * w * (q - part) + 2.0 * a.mode_damping * w * (v - part_v)
            part_v += H * swing
            part += H * part_v
            force += a.mode * swing
        end = ql if two else q
        hung = a.spring * (end - a.rest)
        if a.weight != 0.0:
            hung += a.weight * np.sin(end + a.weight_phase)
        if a.cushion != 0.0:
            into = max(end - a.cushion_at - sunk, 0.0)
            hung += a.cushion * into
            sunk += H * (a.cushion_sinks * into - (a.cushion_recovers * sunk if into == 0.0 else 0.0))
        if not two:
            acceleration_now = (applied + pushed[k] - force - hung) / a.inertia
            carried += H / SMOOTH_LOAD * (a.behind * a.inertia * acceleration_now + hung - carried)
            v += H * acceleration_now
            q += H * v
            continue
        x = q - ql + waves(lists.tooth, q) - at_rest
        by_motor = 1.0 + slope(lists.tooth, q)
        taken = abs(x) > a.gap
        x = x - a.gap * np.sign(x) if taken else 0.0
        pull = a.k2 * (1.0 + a.uneven * np.sin(a.uneven_order * ql + a.uneven_phase)) * x + a.k3 * x * x * x
        if taken:
            pull += a.c2 * (by_motor * v - vl)
        if a.h2 != 0.0:
            pull += a.h2 * rub(zj, lists.joint_bristles, x - joint_last)
            joint_last = x
        carried += H / SMOOTH_LOAD * (pull - carried)
        on_mover, on_load = (pushed[k], 0.0) if a.disturbed == 0.0 else (0.0, pushed[k])
        v += H * (applied + on_mover - force - by_motor * pull) / a.inertia
        if not locked:
            resisted = a.load_viscous * vl + hung
            if a.load_h != 0.0:
                resisted += a.load_h * rub(zl, lists.load_bristles, ql - load_last)
                load_last = ql
            vl += H * (pull + on_load - resisted) / a.load_inertia
            ql += H * vl
        q += H * v
