"""A loop made ready: the stages of one plant structure and one law, each cut into what runs once and what runs always.

Values of parameters do not enter here, only which there are; so a design serves every identification of a plant.
"""

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca

from workbench.control.law import Law
from workbench.definition import Effect
from workbench.kernel.choice import with_choices
from workbench.kernel.program import Program
from workbench.kernel.split import split
from workbench.plant import TWO_MASS, Plant
from workbench.simulation.bodies import LAST, OUTPUT, deflection, substep
from workbench.simulation.dynamics import Symbols, directed
from workbench.simulation.sampled import READ, Sensing, command, inputs, metrics, reading, sense
from workbench.simulation.stage import Stage, stage


@dataclass(frozen=True, eq=False)
class Piece:
    """A stage cut in two. rows: names of the inputs that move; constants: names that `before` takes."""

    name: str
    rows: tuple[str, ...]
    constants: tuple[str, ...]
    outputs: tuple[str, ...]
    before: Program
    after: Program


def _piece(made: Stage, symbols: Symbols) -> Piece:
    constant = [n in symbols.constants for n in made.inputs]
    before, after = split(made.program, constant)
    return Piece(
        made.name,
        tuple(n for n in made.inputs if n not in symbols.constants),
        tuple(n for n in made.inputs if n in symbols.constants),
        made.outputs,
        before,
        with_choices(after),
    )


@dataclass(frozen=True, eq=False)
class Design:
    """pieces: sense, control (with metrics) and substep, in that order; start: the first reading; mass: of each body;
    joint: the effective deflection, where there are two masses.

    rows: every state and every value handed on, each one row of lanes.
    """

    symbols: Symbols
    law: Law | None
    pieces: tuple[Piece, Piece, Piece]
    start: Piece
    mass: Piece
    joint: Piece | None
    sensing: Sensing
    rows: tuple[str, ...]
    noisy: bool


@dataclass(frozen=True)
class _Structure:
    """What two plants share that differ in values alone: definitions, by identity, and where they act."""

    keys: tuple
    effects: tuple[Effect, ...]

    def __eq__(self, other):
        return self.keys == other.keys

    def __hash__(self):
        return hash(self.keys)


Names = tuple[tuple[str, ...], tuple[str, ...]]  # of the signals given over time: shared, and each scenario's own


def design(plant: Plant, law: Law | None, sensing: Sensing, *, noisy: bool, given: Names = ((), ())) -> Design:
    """Return the design for plants of this structure; law None: the drive is given, sample by sample."""
    keys = tuple((e.key, e.step, e.derive, e.port, e.holds, tuple(e.states.items())) for e in plant.effects)
    speed_limited = plant.limits.speed != float("inf")
    return _design(_Structure(keys, plant.effects), law, sensing, noisy, speed_limited, given)


@lru_cache(maxsize=64)
def _design(
    structure: _Structure, law: Law | None, sensing: Sensing, noisy: bool, speed_limited: bool, given: Names
) -> Design:
    effects = directed(structure.effects)
    symbols = Symbols()
    position = OUTPUT[sensing.kind]
    driven = inputs(symbols, *given)
    seen = sense(effects, law, symbols, sensing, driven)
    decided = metrics(symbols, position, driven)
    if law is not None:  # metrics see the command of this sample, not of the one before
        commanded = command(law, symbols, driven)
        u = commanded["u_c"]
        decided = commanded | {n: ca.substitute(ca.SX(x), symbols.state("u_c"), u) for n, x in decided.items()}
    moved, masses = substep(sensing.kind, effects, symbols, speed_limited=speed_limited, noisy=noisy)
    first = {n: v for n, v in reading(effects, symbols, sensing).items() if n in READ}
    x = deflection(effects, symbols)[1] if sensing.kind == TWO_MASS else None

    def ready(name, outputs):
        return _piece(stage(name, symbols.all, outputs), symbols)

    pieces = (ready("sense", seen), ready("control", decided), ready("substep", moved))
    gains = tuple(f"gain.{n}" for n in law.columns) if law is not None else ()
    rows = dict.fromkeys((*(n for p in pieces for n in (*p.rows, *p.outputs)), *gains, "q", "v", "u_c", "u"))
    return Design(
        symbols=symbols,
        law=law,
        pieces=pieces,
        start=ready("start", first),
        mass=ready("mass", masses),
        joint=None if x is None else ready("joint", {LAST: x}),
        sensing=sensing,
        rows=tuple(n for n in rows if n not in symbols.clocks),
        noisy=noisy,
    )
