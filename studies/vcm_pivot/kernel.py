"""The loop of the pivot, a sample after another: controller, compensation, observer, and the pivot at a finer step."""

import numba
import numpy as np

SUBSTEPS = 4


@numba.njit(nogil=True, error_model="numpy")
def run(
    reference, pushed, output, sensed, a, b, law, radii, springs, rates, weights, control, c_radii, c_springs, c_rates,
    c_weights, c, delay, source, observer, count, dt, out,
):  # fmt: skip
    h = dt / SUBSTEPS
    keep, gained = _fading(rates, h)
    c_keep, c_gained = _fading(c_rates, dt)
    play, creep = np.zeros(radii.size), np.zeros(rates.size)
    c_play, c_creep, ring = np.zeros(c_radii.size), np.zeros(c_rates.size), np.zeros(delay + 1)
    s, moved, said, heard = np.zeros(6), np.zeros(6), np.zeros(4), np.zeros(6)
    filtered = before = u = 0.0
    for k in range(reference.size):
        start = s[5]
        y = start + output[k] + sensed[k]
        if count > 0.0:
            y = count * np.floor(y / count + 0.5)
        own = _controlled(reference[k] - y, control, said)
        # the bank on its source
        at = y if source == 0 else reference[k]
        friction = _cancelled(at, at - before, c[0], c_radii, c_springs, c_keep, c_gained, c_weights, c_play, c_creep)
        before = at
        filtered += c[3] * (friction - filtered)
        ring[k % (delay + 1)] = c[1] * filtered
        given = ring[(k + 1) % (delay + 1)]
        net = own - _disturbed(y, u, observer, heard)
        whole = net + given
        u = net
        if count > 0.0:
            whole = count * np.floor(whole / count + 0.5)
            u = whole - given
        mean = 0.0
        for _ in range(SUBSTEPS):
            x = s[5]
            f = _friction(x, s[4], law, radii, springs, weights, play, creep)
            mean += f / SUBSTEPS
            _stepped(a, b, whole + pushed[k] - f, s, moved)
            for j in range(rates.size):
                creep[j] = keep[j] * creep[j] + gained[j] * (s[5] - x)
        out[0, k], out[1, k], out[2, k], out[3, k], out[4, k] = start, y, whole, own, mean


@numba.njit(nogil=True, error_model="numpy")
def _fading(rates, h):
    """What creep operators keep over h s, and what they gain of a displacement over it."""
    keep, gained = np.exp(-rates * h), np.empty(rates.size)
    for j in range(rates.size):
        gained[j] = -np.expm1(-rates[j] * h) / (rates[j] * h)
    return keep, gained


@numba.njit(nogil=True, error_model="numpy")
def _controlled(e, control, said):
    """Eq. (1): derivative by a backward difference, integral delayed by one sample, then the filter. said: its memory."""
    value = control[0] * (control[1] * e + control[2] * (e - said[0]) + said[1])
    said[1] += control[3] * e
    said[0] = e
    w = value - control[7] * said[2] - control[8] * said[3]
    own = control[4] * w + control[5] * said[2] + control[6] * said[3]
    said[3], said[2] = said[2], w
    return own


@numba.njit(nogil=True, error_model="numpy")
def _cancelled(at, way, stiffness, radii, springs, keep, gained, weights, play, creep):
    """The force of the compensation's bank."""
    friction = stiffness * at
    for i in range(radii.size):
        play[i] = max(at - radii[i], min(at + radii[i], play[i]))
        friction += springs[i] * (at - play[i])
    for j in range(keep.size):
        creep[j] = keep[j] * creep[j] + gained[j] * way
        friction += weights[j] * creep[j]
    return friction


@numba.njit(nogil=True, error_model="numpy")
def _disturbed(y, u, observer, heard):
    """What is at the input beside the drive less its compensation; that drive is a sample late. heard: two samples of each."""
    if observer.size == 0:
        return 0.0
    dy = observer[3] * y + observer[4] * heard[0] + observer[5] * heard[1]
    known = (
        dy
        - observer[0] * u
        - observer[1] * heard[2]
        - observer[2] * heard[3]
        - observer[6] * heard[4]
        - observer[7] * heard[5]
    )
    heard[5], heard[4] = heard[4], known
    heard[1], heard[0] = heard[0], y
    heard[3], heard[2] = heard[2], u
    return known


@numba.njit(nogil=True, error_model="numpy")
def _friction(x, v, law, radii, springs, weights, play, creep):
    """The pivot's force, and the cable's."""
    wide = 1.0 + law[3] * np.log(1.0 + abs(v) / law[4])
    f = law[0] * x + law[1] * x * x * x + law[2] * v + law[5] * (x - law[6])
    for i in range(radii.size):
        r = radii[i] * wide
        z = max(x - r, min(x + r, play[i]))
        play[i] = z
        f += springs[i] * (x - z)
    for j in range(creep.size):
        f += weights[j] * creep[j]
    return f


@numba.njit(nogil=True, error_model="numpy")
def _stepped(a, b, drive, s, moved):
    """Move the six states of eq. (2) by one substep, the drive held."""
    for i in range(6):
        total = b[i] * drive
        for j in range(6):
            total += a[i, j] * s[j]
        moved[i] = total
    for i in range(6):
        s[i] = moved[i]
