"""The same loop with NumPy over scenarios, from the same programs: the fallback without lanes, and what lanes are held to."""

import numpy as np

from workbench.control.table import look_up
from workbench.kernel import arrays
from workbench.simulation import noise
from workbench.simulation.binding import Bound
from workbench.simulation.sampled import AMPLITUDE


def run_arrays(bound: Bound, record: tuple[str, ...] = (), every: int = 1):
    """Return (row -> (lanes,) final values, recorded (n, signals, lanes) or None), as workbench.simulation.run does."""
    design, loop, lanes, given = bound.design, bound.loop, bound.lanes, bound.given
    own = given.of_lanes(np.arange(lanes), bound.samples)
    x = {n: np.zeros(lanes) for n in design.rows}
    x |= {n: np.broadcast_to(v, (lanes,)) + np.zeros(lanes) for n, v in bound.initial.items() if n in x}
    columns = design.law.columns if design.law is not None else ()
    seeds = np.broadcast_to(bound.scenarios.seed, (lanes,))
    delays = np.broadcast_to(bound.delays, (lanes,))
    sent, kept, lane = [], [], np.arange(lanes)

    def stage(at: int, clocks: dict) -> None:
        piece = design.pieces[at]
        values = arrays.evaluate(piece.after, [x[n] if n in x else clocks[n] for n in piece.rows], bound.frontier[at])
        x.update({n: np.broadcast_to(v, (lanes,)) for n, v in zip(piece.outputs, values[0], strict=True)})

    for k in range(bound.samples):
        clocks = {"k": float(k), "t": float(k) * loop.sample_time, "window": float(k >= bound.window_from)}
        clocks |= dict(zip(given.shared_names, given.shared[k] if given.shared_names else (), strict=True))
        x |= {n: own[k, i] for i, n in enumerate(given.own_names)}
        stage(0, clocks)
        if columns:
            found = look_up(bound.table, *bound.grid, bound.base, x[AMPLITUDE])
            x.update({f"gain.{n}": v for n, v in zip(columns, found, strict=True)})
        stage(1, clocks)
        if record and k % every == 0:
            kept.append(np.stack([x[n] for n in record]))
        if design.noisy:
            x["noise"] = (noise.counts(seeds, k) - noise.MEAN) * bound.strength
        sent.append(x["u_c"])
        for j in range(loop.substeps):
            past = k * loop.substeps + j - delays
            stacked = np.stack(sent[max(0, len(sent) - 2 - int(np.max(delays)) // loop.substeps) :])
            first = len(sent) - len(stacked)
            acts = stacked[np.maximum(past // loop.substeps - first, 0), lane]
            x["u"] = np.where(past >= 0, acts, x["u"])
            stage(2, clocks | {"t": clocks["k"] * loop.sample_time + j * loop.substep})
    return x, np.stack(kept) if record else None
