"""The sampled loop in lanes, beside C written by hand, NumPy over scenarios, python-control and do-mpc.

One second at 10 kHz with 2 substeps: one mass with n elements of hysteresis, encoder, filtered velocity, reversals, 33
knots of scheduled gains, torque limit, running metrics; 64 random scenarios. Engines take turns, so that what the machine
does beside falls on all of them; a ratio is the median over the turns, with the smallest and largest in brackets. Answers
are compared before anything is timed.
"""

from statistics import median
from time import perf_counter

import numpy as np

from benchmarks import _loop_c as c
from benchmarks import _loop_peers as peers
from benchmarks._loop_work import ELEMENTS, SAMPLES, SCENARIOS, Work, work
from workbench.simulate.closed import simulate
from workbench.simulate.oracle import run_arrays
from workbench.simulate.run import run_lanes

TURNS, SLOW_TURNS = 11, 3
NUMPY_SAMPLES, NUMPY_COPIES = 100, 64
PEER_SAMPLES = {"python-control": 300, "do-mpc": 100}
AIMS = (
    "lanes / C <= 0.40 and single lane / C <= 1.3, with equal bits",
    "python-control and do-mpc / lanes >= 500",
)


def seconds(call) -> float:
    start = perf_counter()
    call()
    return perf_counter() - start


def turns(calls: dict, repeats: int) -> dict[str, list[float]]:
    """Time each call once a turn; the first turn, which compiles and warms, does not count."""
    times = {name: [] for name in calls}
    for turn in range(repeats + 1):
        for name, call in calls.items():
            t = seconds(call)
            if turn:
                times[name].append(t)
    return times


def ratio(a: list[float], b: list[float], scale: float = 1.0) -> str:
    each = [scale * x / y for x, y in zip(a, b, strict=True)]
    digits = 0 if median(each) > 20 else 2
    return f"{median(each):.{digits}f} [{min(each):.{digits}f}, {max(each):.{digits}f}]"


def same(final: dict, metrics: np.ndarray) -> str:
    """How the rows that C returns agree with those of the lanes."""
    apart = [n for i, n in enumerate(c.METRICS) if not np.array_equal(final[n], metrics[:, i])]
    return "bits equal" if not apart else f"BITS DIFFER: {', '.join(apart)}"


def measured(w: Work, strict, free) -> dict[str, tuple[str, str]]:
    """Return engine -> (ratio, answer) for one number of elements."""
    bound, result = w.bound(), {}
    lanes = lambda: run_lanes(bound, threads=1)  # noqa: E731
    final, _ = lanes()
    fast = {"lanes": lanes, "single lane": lambda: run_lanes(bound, lanes=1, threads=1)}
    if strict is not None:
        fast |= {"C": c.caller(strict, w, SAMPLES), "C, contracted": c.caller(free, w, SAMPLES)}
    times = turns(fast, TURNS)
    if strict is not None:
        answer = same(final, fast["C"]())
        result["lanes / C"] = ratio(times["lanes"], times["C"]), answer
        result["lanes / C, contracted"] = ratio(times["lanes"], times["C, contracted"]), ""
        single = same(run_lanes(bound, lanes=1, threads=1)[0], fast["C"]())
        result["single lane / C"] = ratio(times["single lane"], times["C"]), single
    per_step = median(times["lanes"]) / (SCENARIOS * SAMPLES * 2)
    result["lanes, ns a step"] = f"{1e9 * per_step:.2f}", ""
    short = w.bound(NUMPY_SAMPLES, NUMPY_COPIES)
    rows, again = run_arrays(short)[0], run_lanes(short, threads=1)[0]
    equal = all(np.array_equal(again[n], v) for n, v in rows.items() if n in again)
    slow = turns({"lanes": lanes, "NumPy": lambda: run_arrays(short)}, SLOW_TURNS)
    scale = SAMPLES / NUMPY_SAMPLES / NUMPY_COPIES
    result["NumPy / lanes"] = ratio(slow["NumPy"], slow["lanes"], scale), "bits equal" if equal else "BITS DIFFER"
    for name, make in (("python-control", peers.python_control), ("do-mpc", peers.do_mpc)):
        n = PEER_SAMPLES[name]
        try:
            run = make(w, n)
        except ImportError:
            result[f"{name} / lanes"] = "-", f"{name} is not installed here: pip install servo-workbench[bench]"
            continue
        ours = simulate(w.plant, peers.LOOP, w.controller, w.scenarios, n * 1e-4, record=("q",)).trajectories["q"][:, 0]
        apart = np.abs(np.ravel(run()) - ours).max()
        slow = turns({"lanes": lanes, name: run}, SLOW_TURNS)
        scale = SAMPLES / n * SCENARIOS
        result[f"{name} / lanes"] = ratio(slow[name], slow["lanes"], scale), f"within {apart:.0e} rad"
    return result


def main() -> None:
    strict, free = c.compiled(c.STRICT), c.compiled([])
    if strict is None:
        print("There is no C compiler here, so the loop is not compared with C.")
    found = {n: measured(work(n), strict, free) for n in ELEMENTS}
    print(f"{'':26s}" + "".join(f"n = {n:<24d}" for n in ELEMENTS) + "answers")
    for name in found[ELEMENTS[0]]:
        cells = "".join(f"{found[n][name][0]:<28s}" for n in ELEMENTS)
        answers = ", ".join(dict.fromkeys(found[n][name][1] for n in ELEMENTS))
        print(f"{name:26s}{cells}{answers}")
    print("\nAimed at: " + "; ".join(AIMS) + ".")


if __name__ == "__main__":
    main()
