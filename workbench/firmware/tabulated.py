"""Laws without memory as tables: a force over the place or over the speed, its knots where it bends.

Exponentials and sines have no place in 32 bits; between the knots of such a table a force runs straight.
"""

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from workbench.compensation import Compensator
from workbench.compensation.parts import parameters
from workbench.compensation.structure import PREFIX, Structure, values_of
from workbench.definition import Effect, namespace
from workbench.errors import WorkbenchError
from workbench.kernel import arrays
from workbench.kernel.program import Program, read
from workbench.kernel.split import split
from workbench.kernel.step import apply
from workbench.plant import Plant
from workbench.simulation import Loop

PLACES = {"q", "motor_q", "load_q"}
STEADY = {"ratio", "pole_pairs", "locked", "dt"}

FIRST = 64  # intervals that are looked into: a wave of the place has to be met by some of them
INSIDE = (0.19, 0.37, 0.5, 0.71, 0.86)  # where within an interval; uneven, so that no wave hides there
TOLERANCE = 1e-3  # of the largest value: half of it takes 1.4 times the knots
MOST = 4096  # knots: 48 kB of table


@dataclass(frozen=True, eq=False)
class Curve:
    """knots (n,), values (n,): straight in between, held beyond the ends."""

    knots: np.ndarray
    values: np.ndarray

    @property
    def slopes(self) -> np.ndarray:
        """(n,), the last zero."""
        return np.append(np.diff(self.values) / np.diff(self.knots), 0.0)

    def __call__(self, x) -> np.ndarray:
        return np.interp(x, self.knots, self.values)


def _curve(law: Callable[[np.ndarray], np.ndarray], low: float, high: float, said: str) -> Curve:
    """Return the table of a law over [low, high] within TOLERANCE of its largest value; WorkbenchError where that takes too many."""
    knots = np.linspace(low, high, FIRST + 1)
    while True:
        values = law(knots)
        inner = knots[:-1, None] + np.diff(knots)[:, None] * np.array(INSIDE)
        off = np.abs(law(inner.ravel()).reshape(inner.shape) - np.interp(inner, knots, values)).max(axis=1)
        bent = off > TOLERANCE * max(float(np.abs(values).max()), 1e-300)
        if not bent.any():
            return _thinned(Curve(knots, values))
        if knots.size + int(bent.sum()) > MOST:
            raise WorkbenchError(
                f"a table of {said} from {low:.3g} to {high:.3g} needs more than {MOST} knots; state a smaller range."
            )
        knots = np.sort(np.append(knots, 0.5 * (knots[:-1] + knots[1:])[bent]))


def _thinned(found: Curve) -> Curve:
    """Return a table without knots that lie on the line between those beside them."""
    kept = [0]
    size = TOLERANCE * max(float(np.abs(found.values).max()), 1e-300)
    last = found.knots.size - 1
    while kept[-1] < last:
        start, end = kept[-1], kept[-1] + 1
        while end < last and _straight(found, start, end + 1, 0.1 * size):
            end += 1
        kept.append(end)
    return Curve(found.knots[kept], found.values[kept])


def _straight(found: Curve, start: int, end: int, size: float) -> bool:
    """Whether the knots between two run along the line that joins them, within a size."""
    x, y = found.knots[start : end + 1], found.values[start : end + 1]
    return bool(np.all(np.abs(y - np.interp(x, x[[0, -1]], y[[0, -1]])) <= size))


def tabulated(s: Structure, c: Compensator, loop: Loop, plant: Plant, travel) -> tuple[dict[str, Curve], dict]:
    """Return (tables, key of an effect -> names of the tables that stand for it).

    Effects of one side that are looked up over the same signal share a table: the first of them stands for all.
    """
    sums: dict[str, list[Callable]] = {}
    known: dict[str, tuple[str, ...]] = {}
    for i, e in enumerate(s.order):
        if e.key in s.silent or not _wild(i, e, s):
            continue
        over = _source_of(e)
        scale = loop.count if over == "place" else 1.0
        law = _evaluated(i, e, c, s)
        plain, turned = f"table_{over}_{e.at}", f"table_{over}_{e.at}_dir"
        new = []
        for name, one in ((plain, lambda x, law=law, k=scale: law(k * x, 0.0)),
                          (turned, lambda x, law=law, k=scale: law(k * x, 1.0) - law(k * x, 0.0))):  # fmt: skip
            if name == turned and "dir" not in e.reads:
                continue
            new += [name] if name not in sums else []
            sums.setdefault(name, []).append(one)
        known[e.key] = tuple(new)
    ends = {"v": (-plant.limits.speed, plant.limits.speed)}
    if travel is not None:
        ends["place"] = (travel[0] / loop.count, travel[1] / loop.count)
    found = {}
    for name, laws in sums.items():
        over = name.split("_")[1]
        if over not in ends:
            raise WorkbenchError("a force over the place is compensated over a travel; state travel=(lowest, highest).")
        made = _curve(lambda x, laws=laws: sum(law(x) for law in laws), *ends[over], "a force")
        found |= {name: made} if np.any(made.values) else {}
    return found, {k: tuple(n for n in names if n in found) for k, names in known.items()}


def _source_of(e: Effect) -> str:
    """Return what a table of an effect is over, "v" or "place"; WorkbenchError where no table can stand for it."""
    reads = set(e.reads) - STEADY - {"dir"}
    if e.states or not (reads <= PLACES or reads == {"v"}):
        raise WorkbenchError(
            f"effect '{e.named}' needs an exponential or a sine of more than the place or the speed, which this firmware does not "
            "have; compensate by a law that does without, such as a bank of stops."
        )
    return "v" if reads == {"v"} else "place"


def _wild(i: int, e: Effect, s: Structure) -> bool:
    """Whether what moves in an effect's step needs elementary functions: they alone hold a floor."""
    return any(line.op == ca.OP_FLOOR for line in _split_of(_step_of(i, e, s)).lines)


def _step_of(i: int, e: Effect, s: Structure) -> tuple[ca.Function, list[bool]]:
    """Return the step of effect i as a function of (signals, states, parameters), and which of its inputs stay the same."""
    names = tuple(f"{PREFIX}_{i}_{n}" for n in e.parameters)
    reads = {n: ca.SX.sym(n) for n in e.reads}
    z, p = ca.SX.sym("z", sum(e.states.values())), {n: ca.SX.sym(n) for n in names}
    following, output, _ = apply(e, reads, z, parameters(i, e, namespace(**p), ca.SX(1.0)))
    inputs = ca.vertcat(*reads.values(), z, *p.values(), ca.SX(0, 1))
    constant = [n in STEADY for n in e.reads] + [False] * z.numel() + [True] * len(names)
    return ca.Function("step", [inputs], [ca.vertcat(following, output)]), constant


def _split_of(step: tuple[ca.Function, list[bool]]) -> Program:
    """Return what is left of a step once its constants are cut out."""
    return split(read(step[0]), step[1])[1]


def _evaluated(i: int, e: Effect, c: Compensator, s: Structure) -> Callable:
    """Return (x, direction) -> force (n,) of an effect without memory over its one signal, in float64."""
    step, _ = _step_of(i, e, s)
    values = values_of(c, s)
    given = [values[f"{PREFIX}_{i}_{n}"] for n in e.parameters]
    steady = {"ratio": c.ratio, "pole_pairs": c.pole_pairs, "locked": 0.0, "dt": 0.0}

    def law(x, direction: float) -> np.ndarray:
        x = np.asarray(x, dtype=float)
        rows = [steady.get(n, direction if n == "dir" else x) * np.ones(x.size) for n in e.reads]
        rows += [v * np.ones(x.size) for v in given]
        return np.array(arrays.evaluate(read(step), rows)[0][-1]) * np.ones(x.size)

    return law
