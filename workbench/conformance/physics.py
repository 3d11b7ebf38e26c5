"""Checks of what an effect says it holds, on paths walked in the one order in which the property shows."""

from math import pi

import numpy as np

from workbench.conformance.result import within
from workbench.conformance.scene import along, drawn, output, scene
from workbench.definition import Effect

TURNED = (
    "q",
    "dq",
    "v",
    "a",
    "u",
    "tau",
    "tau_inertia",
    "dir",
    "motor_q",
    "load_q",
)  # signals that change sign with the motion
STATIC = ("q", "motor_q", "load_q", "ratio", "pole_pairs")  # what a conservative force may depend on
CYCLE = 2000  # samples
GIVEN = 1e-6  # share of the force times the path that a passive force may seem to give, by the rule of the integral
SAME = 1e-9  # relative difference of forces that ought to be the same


def _shapes(effect: Effect) -> list[Effect]:
    """The effect as drawn, and with the free shape parameters a third and three times as large, inside their bounds."""
    made = []
    for factor in (1.0, 1.0 / 3.0, 3.0):
        free = {n: effect.parameters[n] for n in effect.shape if not effect.parameters[n].fixed}
        made.append(effect(**{n: float(np.clip(factor * p.value, p.lower, p.upper)) for n, p in free.items()}))
    return made if effect.shape else made[:1]


def passive(effect: Effect) -> tuple[bool, str]:
    """Over closed cycles of several sizes and shapes, once settled, the force takes energy and gives none."""
    least = np.inf
    for shaped in _shapes(drawn(effect)):
        there = scene(shaped)
        theta = 2.0 * pi / CYCLE * np.arange(4 * CYCLE + 1)
        for size in (0.1, 0.6, 1.0):
            for form in (np.sin(theta), np.sin(theta) + 0.6 * np.sin(3.0 * theta + 1.0) - 0.6 * np.sin(1.0)):
                q = size * there.length * form
                force = along(shaped, q, 2.0 * pi / there.omega / CYCLE)
                dq = np.diff(q)[-CYCLE:]
                work = 0.5 * (force[-CYCLE - 1 : -1] + force[-CYCLE:]) @ dq
                least = min(least, work / max(np.abs(force).max() * np.abs(dq).sum(), 1e-300))
    passed = bool(least >= -GIVEN)
    return passed, f"Over closed cycles it takes at least {least:.2g} of the largest force times the path" + (
        "." if passed else ": there it gives energy away."
    )


def rate_independent(effect: Effect) -> tuple[bool, str]:
    """The force follows the path, not the time in which it is walked, nor the steps in which it is taken."""
    effect = drawn(effect)
    slow, fast = (output(effect, scene(effect, faster=f).signals) for f in (1.0, 7.0))
    there = scene(effect)
    dq = there.signals["dq"]
    finer = np.concatenate([[0.0], np.repeat(dq[1:] / 3.0, 3)]).cumsum()
    coarse = along(effect, np.concatenate([[0.0], dq[1:]]).cumsum(), there.dt)
    size = np.abs(slow).max()
    time = np.abs(slow - fast).max() / size
    steps = np.abs(along(effect, finer, there.dt)[3::3] - coarse[1:]).max() / size
    return within(max(time, steps), SAME, "Seven times as fast, and in steps of a third, the force differs by")


def _mirrored(effect: Effect) -> tuple[np.ndarray, np.ndarray]:
    """Output along a scene, and along the same scene with every motion the other way."""
    effect = drawn(effect)
    signals = scene(effect).signals
    return output(effect, signals), output(effect, {n: -x if n in TURNED else x for n, x in signals.items()})


def odd(effect: Effect) -> tuple[bool, str]:
    """The other way round, the output is the negative."""
    there, back = _mirrored(effect)
    return within(np.abs(there + back).max() / np.abs(there).max(), SAME, "Mirrored, the output is not its negative by")


def even(effect: Effect) -> tuple[bool, str]:
    """The other way round, the output is the same."""
    there, back = _mirrored(effect)
    return within(np.abs(there - back).max() / np.abs(there).max(), SAME, "Mirrored, the output is not the same by")


def conservative(effect: Effect) -> tuple[bool, str]:
    """A function of position alone, so that no closed path takes or gives energy."""
    moving = [r for r in effect.reads if r not in STATIC]
    if moving or effect.states:
        reason = f"reads {', '.join(moving)}" if moving else "has a memory"
        return False, f"It {reason}, so its force is no function of position alone."
    return True, "A function of position alone, so closed paths cost nothing."
