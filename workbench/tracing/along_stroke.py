"""What an inertia that changes along the stroke, or a drive's constant that does, would take of a residual, out of sample: of a crank, a toggle,
an arm that folds; of a coil that leaves its gap, a linear motor at the end of its magnets.

J(q) a + J'(q) v^2/2, J a sum of bells over the stroke, is fitted beside the declared model to all blocks but those it is asked of; and K(q) times
what the model drives. What either takes that is everywhere alike does not count: it is a mass, or a constant, that was declared wrong. No effect of
the catalogue is either, so this says "unknown" where an effect only dresses it: a crank is a kinematic error to the search, and a coil on springs
that leaves its gap two springs and a drive that saturates. Source: Lagrange's equation of one coordinate, T = J(q) a + J'(q) v^2/2.
"""

import numpy as np

from workbench.identification.cross_validation import Deviations, folds_of
from workbench.inverse.dynamics import InverseDynamics
from workbench.inverse.side_by_side import stacked
from workbench.plant import ONE_MASS
from workbench.tracing.foreseen import BLOCK, FOLDS
from workbench.tracing.state import State

# Bells over the stroke. Of 122 axes of one mass those whose inertia or force constant changes (four) have 0.90 and more of their residual's
# power from it, one with an eccentric encoder 0.99 (the same coordinate by another name), others 0.37 and less. Halved, a crank of two waves a
# turn has 0.93 instead of 1.00 and is a kinematic error; doubled, none changes
BELLS = 10
TURN = 2.0 * np.pi  # rad: what turns further than that comes to the same place again
LEAST = 1e-6  # of a column's power, added to it: what a block says little of stays small


# Squared residual of each block, out of sample, with what is alike everywhere and with what changes
Told = tuple[np.ndarray, np.ndarray]


def by_place(state: State) -> tuple[Told, ...]:
    """Return the squared residual of each block, out of sample, with one inertia and with one that changes along the stroke, (blocks,) each, and
    with one constant of the drive and one that changes; nothing of two masses, whose drive feels the load by the joint alone.

    With what is alike everywhere no more than as declared: where a fit to few blocks goes astray on the others, what changes would take that, too.
    """
    if state.plant.kind != ONE_MASS:
        return ()
    blocks = state.problem.blocks(BLOCK)
    model, residual = Deviations(state.problem, state.solution), state.solution.residual
    declared = np.array([residual[b] @ residual[b] for b in blocks])
    found = []
    for bells in (np.concatenate(records, axis=1).T for records in zip(*_columns(state), strict=True)):
        alike = np.column_stack([model.columns, bells[:, 0]])
        changing = _left(np.column_stack([model.columns, bells]), residual, blocks)
        found.append((np.minimum(_left(alike, residual, blocks), declared), changing))
    return tuple(found)


def _columns(state: State) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return of each record the drive (1 + BELLS, samples that count), filtered, that an inertia asks for which is everywhere one and each of the
    bells; and so the drive that a constant gives."""
    places = [p.motion.q for p in state.inverses]
    low, high = min(float(q.min()) for q in places), max(float(q.max()) for q in places)
    turns = state.plant.rotary and high - low > TURN
    return [
        _of_record(p, left, low, TURN / BELLS if turns else max(high - low, 1e-300) / (BELLS - 1), turns)
        for p, left in zip(state.inverses, state.residuals, strict=True)
    ]


def _of_record(
    p: InverseDynamics, left: np.ndarray, low: float, step: float, turns: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return these two of a record. left: its residual (n,)."""
    m = p.motion
    x = (m.q - low)[None, :] / step - np.arange(BELLS)[:, None]
    if turns:
        x -= BELLS * np.rint(x / BELLS)
    bell = np.exp(-0.5 * x**2)
    asked = m.filter(np.vstack([m.a, bell * m.a - 0.5 * bell * x / step * m.v**2]))
    modelled = m.filter(m.u) - left
    return _counted(asked, p), _counted(np.vstack([modelled, bell * modelled]), p)


def _counted(drives: np.ndarray, p: InverseDynamics) -> np.ndarray:
    """Return drives (k, n) of a record in the samples that count, (k, kept)."""
    return np.stack([stacked(d[None, :], p.motion.keep, p.counts) for d in drives])


def _left(columns: np.ndarray, residual: np.ndarray, blocks: list[slice]) -> np.ndarray:
    """Return the squared residual of each block by a fit to the others."""
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    grams = np.array([columns[b].T @ columns[b] for b in blocks])
    moments = np.array([columns[b].T @ residual[b] for b in blocks])
    left = np.empty(len(blocks))
    for out, rest in folds_of(len(blocks), FOLDS):
        gram = grams[rest].sum(axis=0)
        c = np.linalg.solve(gram + LEAST * np.eye(len(gram)), moments[rest].sum(axis=0))
        for i in out:
            r = residual[blocks[i]] - columns[blocks[i]] @ c
            left[i] = r @ r
    return left
