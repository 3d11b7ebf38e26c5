"""Run a bound design in lanes: chunks of lanes, shared by threads, which give the same bits as one."""

import os
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

import numpy as np

from workbench.kernel.cache import load
from workbench.simulation.binding import Bound
from workbench.simulation.design import Design
from workbench.simulation.source import Layout, places, source

LANES = 32
WORTH = 5000  # chunks times samples, about a millisecond, from which on threads are worth their start
_CORES = os.cpu_count() or 1


@lru_cache(maxsize=4)
def _pool(workers: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(workers)


if hasattr(os, "register_at_fork"):  # a forked child has none of its parent's threads
    os.register_at_fork(after_in_child=_pool.cache_clear)


@lru_cache(maxsize=128)
def kernel(design: Design, layout: Layout):
    """Return the module of the compiled loop."""
    return load(source(design, layout), "loop")


def _layout_of(bound: Bound, lanes: int, record: tuple[str, ...]) -> Layout:
    """How the kernel for these numbers is laid out."""
    most = int(np.max(bound.delays))
    delay = "none" if most == 0 else "uniform" if np.min(bound.delays) == most else "varying"
    varying = tuple(tuple(map(_varies, values)) for values in bound.frontier)
    slots = 1 if delay == "none" else 1 << (-(-most // bound.loop.substeps)).bit_length()
    return Layout(varying, bound.loop.substeps, lanes, delay, slots, record, *bound.given.structure)


def _chunked(values: np.ndarray, lanes: int, dtype=None) -> np.ndarray:
    """Return (..., n) as (chunks, ..., lanes), the last chunk filled with the last value."""
    return np.stack([_chunk(values, i, lanes, dtype) for i in range(-(-values.shape[-1] // lanes))])


def _chunk(values: np.ndarray, i: int, lanes: int, dtype=None) -> np.ndarray:
    """Return one chunk (..., lanes) of values (..., n), filled with the last value where they end."""
    own = values[..., i * lanes : (i + 1) * lanes]
    full = np.empty((*values.shape[:-1], lanes), dtype=dtype or values.dtype)
    full[..., : own.shape[-1]] = own
    full[..., own.shape[-1] :] = values[..., -1:]
    return full


def _begun(bound: Bound, layout: Layout, at: Mapping[str, int]) -> tuple[np.ndarray, np.ndarray]:
    """Return (rows of the state at the first sample (rows, lanes), constants that all lanes share). at: name -> row."""
    rows = len(set(at.values()))
    whole = np.zeros((rows + layout.extra_rows, bound.lanes))
    for name, value in bound.initial.items():
        if name in at:
            whole[at[name]] = value
    flat = [v for values in bound.frontier for v in values]
    varying = [v for v in flat if _varies(v)]
    if varying:
        whole[rows:] = varying
    return whole, np.array([v for v in flat if not _varies(v)], dtype=float)


def _varies(value) -> bool:
    """Whether a constant has a value of its own in each lane. A tuning asks it 100 000 times; `np.ndim` makes an array of every number."""
    return getattr(value, "ndim", 0) > 0


def _each(chunk: Callable[[int], None], chunks: int, threads: int) -> None:
    """Run every chunk, on no more threads than there are."""
    workers = min(threads, chunks)
    if workers > 1:
        list(_pool(workers).map(chunk, range(chunks)))
    else:
        for i in range(chunks):
            chunk(i)


def _passed(
    bound: Bound, at: Mapping[str, int], lanes: int, record: tuple[str, ...], every: int, named
) -> tuple[dict, dict]:
    """Return what a kernel is passed: (name -> the same for all chunks, name -> (chunks, n) values). named: what it asks for."""
    n = bound.lanes
    common = {
        "table": np.ascontiguousarray(bound.table).ravel(),
        "shared": np.ascontiguousarray(bound.given.shared).ravel(),
        "kept": np.array([at[name] for name in record], dtype=np.int64),
        "window_from": bound.window_from,
        "every": every,
        "shift": bound.grid[0],
        "offset": bound.grid[1],
        "delay": int(np.max(bound.delays)),
        "sample_time": bound.loop.sample_time,
        "h": bound.loop.substep,
    }
    each = {
        "base": _chunked(bound.base, lanes),
        "seeds": _chunked(np.broadcast_to(bound.scenarios.seed, (n,)), lanes, np.uint64),
        "strength": _chunked(bound.strength, lanes),
        "delays": _chunked(np.broadcast_to(bound.delays, (n,)), lanes),
    }
    return {k: v for k, v in common.items() if k in named}, {k: v for k, v in each.items() if k in named}


def run_lanes(
    bound: Bound, record: tuple[str, ...] = (), every: int = 1, lanes: int = LANES, threads: int | None = None,
    lasts: np.ndarray | None = None,
):  # fmt: skip
    """Return (row -> (lanes,) final values, recorded (n, signals, lanes) or None).

    lasts (lanes,): samples that each is run for at least, as long as the longest of its chunk; all of them where absent. What is
    recorded is undefined from there on.
    """
    layout = _layout_of(bound, lanes, record if lanes == 1 else ())
    at, made = places(bound.design, layout), kernel(bound.design, layout)
    n, chunks = bound.lanes, -(-bound.lanes // lanes)
    whole, constants = _begun(bound, layout, at)
    x = _chunked(whole, lanes)
    common, each = _passed(bound, at, lanes, record, every, made.GIVEN)
    common, each = common | {"constants": constants}, each | {"x": x.reshape(chunks, -1)}
    recorded = np.empty((-(-bound.samples // every), len(record), n)) if record else None

    def chunk(i: int) -> None:
        own = np.minimum(np.arange(i * lanes, (i + 1) * lanes), n - 1)
        samples = bound.samples if lasts is None else int(lasts[own].max())
        rows = -(-samples // every) if record else 0
        # of one chunk, what is given and what is recorded stay in the processor's cache; of all at once, moving them costs a kernel's time
        ring, out = np.zeros(layout.slots * lanes), np.empty((rows, len(record), lanes))
        given = common | {"ring": ring, "out": out.ravel(), "samples": samples}
        if "own" in made.GIVEN:
            given["own"] = bound.given.of_lanes(own, samples).ravel()
        made.run(*[each[name][i] if name in each else given[name] for name in made.GIVEN])
        if recorded is not None:
            here = recorded[:rows, :, i * lanes : (i + 1) * lanes]
            here[...] = out[..., : here.shape[-1]]

    _each(chunk, chunks, threads or (_CORES if chunks * bound.samples > WORTH else 1))
    final = {name: x[:, row].reshape(-1)[:n] for name, row in at.items()}
    return final, recorded
