"""Checks of hysteresis with memory: against an analytic stack of turning points, and what follows from it."""

import numpy as np

from workbench.conformance.result import within
from workbench.conformance.scene import along, drawn, scene
from workbench.definition import Effect, namespace
from workbench.description import equivalent, first_harmonic

SAME = 1e-9  # of the largest force
CURVE = 0.01  # of the curve's largest force: a bank of elements follows its curve within this
HARMONIC = 0.03  # of the largest stiffness and loss over the amplitudes
GRID = 512  # steps of the virgin curve over twice the length of the scene
TURNS = (0.6, -0.3, 0.2, -0.1, 0.05, -0.2, 0.5, -0.1, 0.7, -0.9, -0.2, -0.5, 0.8, 0.7, 0.75, 0.1, 0.95, -0.95, 0.4)


def _on_grid(effect: Effect) -> tuple[np.ndarray, np.ndarray, float]:
    """Return (path, virgin force, step): a path of whole double steps with many turning points; the curve in steps."""
    there = scene(effect)
    width = 2.0 * there.length / GRID
    stops = np.round(np.array((0.0, *TURNS)) * GRID / 4).astype(int) * 2
    path = [0]
    for a, b in zip(stops[:-1], stops[1:], strict=True):
        path += list(range(a, b, 2 if b > a else -2))[1:] + [b]
    virgin = along(effect, width * np.arange(GRID + 1), there.dt)
    return np.array(path), virgin, width


def masing_stack(path: np.ndarray, virgin: np.ndarray) -> np.ndarray:
    """Force of an exact Masing operator on a path of whole numbers, from its virgin curve at 0, 1, 2, ...

    From a turning point (x_r, F_r) the branch is F_r +- 2 y(|x - x_r|/2). Where it meets the turning point before that,
    both are forgotten and the branch of the earlier one goes on; beyond the first one the virgin curve does.
    """
    turns, forces, way, last = [], [0.0], 0, int(path[0])
    for x in path[1:].tolist():
        now = (x > last) - (x < last)
        if now == -way != 0:
            turns.append((last, forces[-1]))
        way = now or way
        while len(turns) > 1 and way * (x - turns[-2][0]) >= 0:
            del turns[-2:]
        if turns and abs(x) >= abs(turns[0][0]):
            turns.clear()
        if turns:
            at, force = turns[-1]
            forces.append(force + way * 2.0 * virgin[abs(x - at) // 2])
        else:
            forces.append(way * virgin[abs(x)])
        last = x
    return np.array(forces)


def masing(effect: Effect) -> tuple[bool, str]:
    """After every reversal the virgin curve follows, stretched by two, and passed turning points are forgotten."""
    effect = drawn(effect)
    path, virgin, width = _on_grid(effect)
    found = along(effect, width * path, scene(effect).dt)
    error = np.abs(found - masing_stack(path, virgin)).max() / np.abs(found).max()
    return within(float(error), SAME, "Over its largest value, the force differs from the stack of turning points by")


def wiping_out(effect: Effect) -> tuple[bool, str]:
    """A loop within a loop, once closed, leaves no trace."""
    effect = drawn(effect)
    there = scene(effect)
    width = 2.0 * there.length / GRID

    def to(*stops: float) -> np.ndarray:
        whole = [0, *(round(s * GRID / 2) for s in stops)]
        path = [0]
        for a, b in zip(whole[:-1], whole[1:], strict=True):
            path += list(range(a, b, 1 if b > a else -1))[1:] + [b]
        return along(effect, width * np.array(path), there.dt)

    worst = 0.0
    for outer, inner in (((0.4,), (0.1, 0.4)), ((0.8, -0.5), (0.2, -0.5)), ((0.5,), (0.45, 0.48, 0.47, 0.5))):
        straight, looped = to(*outer, 0.9 * np.sign(outer[-1])), to(*outer, *inner, 0.9 * np.sign(outer[-1]))
        tail = round((0.9 - abs(outer[-1])) * GRID / 2)
        worst = max(worst, np.abs(straight[-tail:] - looped[-tail:]).max() / np.abs(straight).max())
    return within(float(worst), SAME, "After an inner loop is closed, the force over its largest value differs by")


def virgin_curve(effect: Effect) -> tuple[bool, str]:
    """Driven from rest in one direction, the step follows the curve that is declared."""
    effect = drawn(effect)
    there = scene(effect)
    x = np.linspace(0.0, 2.0 * there.length, GRID + 1)
    curve = effect.virgin(x, namespace(**{n: p.value for n, p in effect.parameters.items()}))
    error = np.abs(along(effect, x, there.dt) - curve).max() / np.abs(curve).max()
    return within(float(error), CURVE, "Over its largest value, the force from rest differs from the virgin curve by")


def describing(effect: Effect) -> tuple[bool, str]:
    """The describing-function integrals of the virgin curve are the first harmonic of the settled cycle."""
    effect = drawn(effect)
    amplitudes = scene(effect).length * np.array([0.03, 0.1, 0.3, 1.0, 3.0])
    exact, stepped = equivalent(effect, amplitudes), first_harmonic(effect, amplitudes, 1.0, samples=1024)
    size = max(np.abs(exact.stiffness).max(), np.abs(exact.loss).max())
    error = max(np.abs(exact.stiffness - stepped.stiffness).max(), np.abs(exact.loss - stepped.loss).max()) / size
    return within(float(error), HARMONIC, "Stiffness and loss of the settled cycle differ from the integrals by")
