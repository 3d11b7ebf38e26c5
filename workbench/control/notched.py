"""A notch behind any law: u = N(z) w, N(z) = (b0 + b1 z^-1 + b2 z^-2)/(1 + b1 z^-1 + a2 z^-2), w what the law commands.

Tustin's image of (s^2 + 2 depth damping w s + w^2)/(s^2 + 2 damping w s + w^2), prewarped at its centre w, as drives compute it
(Franklin, Powell, Workman 1998, section 6.1.2).
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from workbench.control.law import Controller, Law
from workbench.errors import WorkbenchError

COEFFICIENTS = ("b0", "b1", "b2", "a2")
OWN = tuple(f"notch_{n}" for n in COEFFICIENTS)  # parameters of a law with a notch behind it


def coefficients(notch, sample_time: float) -> tuple:
    """Return (b0, b1, b2, a2) of a notch with centre (Hz), damping and depth, numbers or arrays of a shape; a1 is b1.

    Raises WorkbenchError where its centre is not below half the sampling rate.
    """
    centre = np.asarray(notch.centre)
    if not ((centre > 0.0) & (centre < 0.5 / sample_time)).all():
        raise WorkbenchError(
            f"a notch at {float(np.max(centre)):g} Hz cannot be computed every {1e3 * sample_time:g} ms: its centre has to lie "
            f"below {0.5 / sample_time:g} Hz."
        )
    w = 2.0 * np.pi * notch.centre
    k = w / np.tan(0.5 * w * sample_time)
    wide, deep = 2.0 * notch.damping * w * k, 2.0 * notch.depth * notch.damping * w * k
    whole = k * k + wide + w * w
    return (k * k + deep + w * w) / whole, 2.0 * (w * w - k * k) / whole, (k * k - deep + w * w) / whole, (k * k - wide + w * w) / whole  # fmt: skip


def response(notches: Sequence, theta: np.ndarray, sample_time: float) -> np.ndarray:
    """Return the product of the sampled notches' responses at theta (f,), rad a sample; 1 where there is none.

    Notches of arrays (n, 1) give (n, f).
    """
    out = np.ones(theta.size, dtype=complex)
    for notch in notches:
        out = out * behind(coefficients(notch, sample_time), theta)
    return out


def behind(numbers: tuple, theta: np.ndarray) -> np.ndarray:
    """Return N (f,) of numbers (b0, b1, b2, a2) at theta (f,), rad a sample."""
    (b0, b1, b2, a2), back = numbers, np.exp(-1j * theta)
    return (b0 + b1 * back + b2 * back**2) / (1.0 + b1 * back + a2 * back**2)


def numbers_of(controller: Controller) -> tuple[float, float, float, float] | None:
    """Return (b0, b1, b2, a2) of the notch behind a controller of one lane, or None."""
    if not set(OWN) <= set(controller.law.parameters):
        return None
    return tuple(float(np.ravel(controller.parameters[n])[0]) for n in OWN)


def passed(u, numbers, first, second):
    """Return (what a notch of numbers (b0, b1, b2, a2) lets through, its next two states)."""
    b0, b1, b2, a2 = numbers
    through = b0 * u + first
    return through, b1 * u - b1 * through + second, b2 * u - a2 * through


def notched(controller: Controller, notch, sample_time: float) -> Controller:
    """Return the controller with a notch behind its law. notch: centre (Hz), damping, depth; scalars, or (lanes,) arrays."""
    values = dict(zip(OWN, coefficients(notch, sample_time), strict=True))
    return replace(controller, law=law_of(controller.law), parameters={**controller.parameters, **values})


@cache
def law_of(base: Law) -> Law:
    """Return a law with a notch behind it."""

    def step(s, z, p):
        after, u = base.step(s, z, p)
        through, first, second = passed(u, (getattr(p, n) for n in OWN), z.notch_first, z.notch_second)
        return {**after, "notch_first": first, "notch_second": second}, through

    return replace(
        base,
        name=f"{base.name}, notch",
        parameters=(*base.parameters, *OWN),
        states=(*base.states, "notch_first", "notch_second"),
        step=step,
        before=base,
    )
