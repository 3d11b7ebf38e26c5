"""The forces at one place along given signals, each beside those that it needs: those that give the direction first."""

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from workbench import definition as fx
from workbench.definition import Effect
from workbench.effects.direction import DIRECTION, beside_memory, stop_direction
from workbench.errors import WorkbenchError
from workbench.kernel.step import build
from workbench.parameter import ROOM
from workbench.plant import ONE_MASS, Plant, carried, reads_load

Ran = Mapping[str, tuple[np.ndarray, tuple]]  # effect key -> (outputs (columns, n), what they are kept under)


def outputs_of(effect: Effect, signals: dict) -> np.ndarray:
    """Return the outputs (columns, n) of a force at its values."""
    return build(effect).run(signals, {n: p.value for n, p in effect.parameters.items()})


def linear_of(effect: Effect) -> tuple[float, ...]:
    """Return the values of the linear parameters, by which outputs are multiplied."""
    return tuple(effect.parameters[n].value for n in effect.linear) or (1.0,)


def forces_of(plant: Plant, place: str) -> list[Effect]:
    """Return the forces of a plant at a place, by key."""
    return sorted((e for e in plant.effects if e.port == fx.FORCE and e.at == place), key=lambda e: e.key)


def summed(parts: Sequence[Sequence[Effect]], ran: Ran, n: int) -> np.ndarray:
    """Return the sum (parts, n) of the forces of each part at their values."""
    return np.stack([sum((np.array(linear_of(e)) @ ran[e.key][0] for e in part), np.zeros(n)) for part in parts])


def run_forces(
    forces: Sequence[Effect],
    signals: dict,
    path: tuple,
    width: float,
    run: Callable[[Effect, dict, tuple], np.ndarray],
    carry: Callable[[Ran], tuple[np.ndarray, tuple]],
    without: str,
) -> Iterator[tuple[Effect, np.ndarray, tuple]]:
    """Yield (effect, outputs (columns, n), key) of forces: those with memory, which give the direction, then those that read it,
    then those that follow the load.

    forces: at least one, all at one place. signals: what they read, (n,) each; path: what the motion among them is kept under. width: of the direction where no
    hysteresis gives it, rad or m. run(effect, signals, key): an effect's outputs. carry(ran): (tau, tau_inertia) (2, n) by the forces
    that have run, and their key. without: what lacks a signal that is missing, as a clause.
    """
    place, paths = forces[0].at, dict.fromkeys(("q", "dq", "v", "a"), path)
    givers = [e for e in forces if e.provides]
    takers = sorted((e for e in forces if not e.provides), key=reads_load)
    # of their own, which follow the motion's direction: asked before a memory gives it
    contacts = beside_memory(forces)
    if contacts or (not givers and any("dir" in e.reads for e in takers)):
        takers = [e for e in takers if e.key not in {c.key for c in contacts}]
        givers = [stop_direction(width), *contacts, *givers]
    ran: dict[str, tuple] = {}
    for e in (*givers, *takers):
        if reads_load(e) and "tau" not in signals:
            (signals["tau"], signals["tau_inertia"]), key = carry(ran)
            paths |= {"tau": key, "tau_inertia": key}
        _check(e, signals, without)
        values = tuple(e.parameters[n].value for n in e.shape)
        key = (e.step, place, values, *dict.fromkeys(paths[r] for r in e.reads if r in paths))
        outputs = run(e, signals, key)
        count = len(e.linear or ("",))
        for i, given in enumerate(e.provides):
            signals[given] = outputs[count + i]
            paths[given] = key
        if e.name == DIRECTION:
            continue
        ran[e.key] = outputs[:count], key
        yield e, outputs[:count], key


def _check(e: Effect, signals: Mapping, without: str) -> None:
    """Refuse a force that reads what is not there."""
    missing = [r for r in e.reads if r not in signals]
    if "u" in missing:
        raise WorkbenchError(
            f"effect '{e.name}' is a force and reads 'u', the drive that it is a part of; a prediction must not see "
            "it: let it read 'tau', the torque that its contact carries."
        )
    if missing:
        raise WorkbenchError(f"effect '{e.name}' reads '{missing[0]}', which {without}.")


def force_along(plant: Plant, dt: float, counts: float, **moved: np.ndarray) -> np.ndarray:
    """Return every force (n,) of a plant of one mass together along a motion, N*m or N.

    moved: q, dq, v, a (n,) each, every dt s. counts: encoder resolution, the width of the direction where no hysteresis gives it.
    The bench is at room temperature. Raises WorkbenchError for a plant of two masses, whose joint a motion of one position does not tell.
    """
    if plant.kind != ONE_MASS:
        raise WorkbenchError("a motion of one position needs a plant of one mass; give each body as one.")
    n = moved["q"].size
    geometry = {"ratio": plant.geometry.gear_ratio, "pole_pairs": plant.geometry.pole_pairs}
    signals = {**moved, "dt": dt, "t": dt * np.arange(n), "locked": 0.0, "temperature": ROOM, **geometry}
    total = np.zeros(n)
    own = forces_of(plant, "axis")
    if not own:
        return total
    forces = run_forces(
        own, signals, (), max(2 * counts, 1e-12),
        run=lambda e, signals, _: outputs_of(e, signals),
        carry=lambda ran: (summed(carried(plant.kind, "axis", plant.effects), ran, n), ()),
        without="a motion alone does not have",
    )  # fmt: skip
    for e, outputs, _ in forces:
        for value, column in zip(linear_of(e), outputs, strict=False):
            total += value * column
    return total
