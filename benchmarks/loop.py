"""The sampled loop in lanes, beside C written by hand, NumPy over scenarios, python-control and do-mpc.

One second at 10 kHz with 2 substeps: one mass with n elements of hysteresis, encoder, filtered velocity, reversals, 33
knots of scheduled gains, torque limit, running metrics; 64 random scenarios. Engines take turns, so that what the machine
does beside falls on all of them; a ratio is the median over the turns, with the smallest and largest in brackets. Answers
are compared before anything is timed.

Two masses (10 elements at the motor; in the joint linear and cubic stiffness and 4 elements) and LuGre friction, each for
one second at 4 kHz, are held against C alone. Strict C takes exp by the project's own arithmetic, so that bits are equal;
beside it stands C that may contract products into sums and takes the exp of its library.
"""

from statistics import median
from time import perf_counter

import numpy as np

from benchmarks import _loop_c as c
from benchmarks import _loop_peers as peers
from benchmarks._loop_work import ELEMENTS, SCENARIOS, TWO, Work, bristles, one_mass, two_masses
from workbench.simulation.closed import simulate
from workbench.simulation.oracle import run_arrays
from workbench.simulation.run import run_lanes

TURNS, SLOW_TURNS = 11, 3
NUMPY_SAMPLES, NUMPY_COPIES = 100, 64
PEER_SAMPLES = {"python-control": 300, "do-mpc": 100}
AIMS = (
    "lanes / C <= 0.40 and single lane / C <= 1.3, with equal bits",
    "python-control and do-mpc / lanes >= 500",
    "two masses and LuGre friction: lanes / C <= 0.50",
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


def same(w: Work, final: dict, metrics: np.ndarray) -> str:
    """How the rows that C returns agree with those of the lanes."""
    names = ["load.q" if w.kind == TWO and n == "q" else n for n in c.METRICS]
    apart = [n for i, n in enumerate(names) if not np.array_equal(final[n], metrics[:, i])]
    if not apart:
        return "bits equal"
    largest = np.abs(final[names[0]] - metrics[:, 0]).max()
    return f"BITS DIFFER: {', '.join(apart)}; positions within {largest:.0e} rad"


def measured(w: Work, strict, free) -> dict[str, tuple[str, str]]:
    """Return engine -> (ratio, answer) for one plant, beside C and NumPy."""
    samples = w.samples
    bound, result = w.bound(samples), {}
    lanes = lambda: run_lanes(bound, threads=1)  # noqa: E731
    final, _ = lanes()
    fast = {"lanes": lanes, "single lane": lambda: run_lanes(bound, lanes=1, threads=1)}
    if strict is not None:
        fast |= {"C": c.caller(strict, w, samples), "C, contracted, libm": c.caller(free, w, samples)}
    times = turns(fast, TURNS)
    if strict is not None:
        answer = same(w, final, fast["C"]())
        result["lanes / C"] = ratio(times["lanes"], times["C"]), answer
        result["lanes / C, contracted, libm"] = ratio(times["lanes"], times["C, contracted, libm"]), ""
        single = same(w, run_lanes(bound, lanes=1, threads=1)[0], fast["C"]())
        result["single lane / C"] = ratio(times["single lane"], times["C"]), single
    per_step = median(times["lanes"]) / (SCENARIOS * samples * w.loop.substeps)
    result["lanes, ns a step"] = f"{1e9 * per_step:.2f}", ""
    short = w.bound(NUMPY_SAMPLES, NUMPY_COPIES)
    rows, again = run_arrays(short)[0], run_lanes(short, threads=1)[0]
    equal = all(np.array_equal(again[n], v) for n, v in rows.items() if n in again)
    slow = turns({"lanes": lanes, "NumPy": lambda: run_arrays(short)}, SLOW_TURNS)
    scale = samples / NUMPY_SAMPLES / NUMPY_COPIES
    result["NumPy / lanes"] = ratio(slow["NumPy"], slow["lanes"], scale), "bits equal" if equal else "BITS DIFFER"
    return result


def beside_peers(w: Work) -> dict[str, tuple[str, str]]:
    """Return engine -> (ratio, answer) for the Python libraries."""
    bound, result = w.bound(w.samples), {}
    lanes = lambda: run_lanes(bound, threads=1)  # noqa: E731
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
        scale = w.samples / n * SCENARIOS
        result[f"{name} / lanes"] = ratio(slow[name], slow["lanes"], scale), f"within {apart:.0e} rad"
    return result


def table(found: dict[str, dict[str, tuple[str, str]]]) -> None:
    print(f"{'':30s}" + "".join(f"{head:<28s}" for head in found) + "answers")
    for name in next(iter(found.values())):
        cells = "".join(f"{result[name][0]:<28s}" for result in found.values())
        answers = ", ".join(dict.fromkeys(result[name][1] for result in found.values()))
        print(f"{name:30s}{cells}{answers}")


def main() -> None:
    strict, free = c.compiled(c.STRICT), c.compiled(c.FREE)
    if strict is None:
        print("There is no C compiler here, so the loop is not compared with C.")
    each = {n: one_mass(n) for n in ELEMENTS}
    table({f"n = {n}": measured(w, strict, free) | beside_peers(w) for n, w in each.items()})
    print()
    table({"two masses": measured(two_masses(), strict, free), "LuGre friction": measured(bristles(), strict, free)})
    print("\nAimed at: " + "; ".join(AIMS) + ".")


if __name__ == "__main__":
    main()
