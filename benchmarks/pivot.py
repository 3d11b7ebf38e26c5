"""Operator banks: how long a dense fit takes beside a simplex search, a describing function in closed loop, and a loop.

Asked of them: a dense fit within 50 ms and 50 times faster than the search, a response within 20 ms, 10 Msample/s of a bank,
and 10 s of the pivot's 12 kHz loop within 0.5 s.
"""

import importlib
from pathlib import Path
from time import perf_counter

import numpy as np

from benchmarks._timing import milliseconds
from workbench.hysteresis import Bank, nonnegative
from workbench.hysteresis.fit import grid, solved, stacked
from workbench.study.running import steps_of

STUDY = Path(__file__).parent.parent / "studies" / "vcm_pivot"


def main() -> None:
    """Print times, and their ratios where two do the same."""
    steps = steps_of(STUDY).__name__
    records, ladder, responses, loop, machine = (
        importlib.import_module(f"{steps}.{n}") for n in ("records", "ladder", "responses", "loop", "machine")
    )
    seen = [e.record for e in records.measured(records.AMPLITUDE, records.Noise())]
    radii, rates = grid(seen, 12, 8)
    dense = milliseconds(lambda: solved(*stacked(seen, radii, rates)))
    start = perf_counter()
    ladder.simplex(seen, ladder.starts(1)[0])
    search = 1e3 * (perf_counter() - start)
    bank = nonnegative(seen, radii, rates).bank
    frequencies = np.geomspace(5.0, 300.0, 28)
    described = milliseconds(lambda: responses.described(loop.CALIBRATED, bank, 0.5, frequencies))
    small = Bank(0.2, np.geomspace(0.02, 1.0, 10), np.ones(10), np.geomspace(3.0, 6000.0, 6), np.ones(6))
    x = np.sin(np.linspace(0.0, 300.0, 1_000_000))
    run = milliseconds(lambda: small.run(x, 1e-4), 5)
    wave = 0.5 * np.sin(2 * np.pi * 10.0 * loop.TS * np.arange(round(10.0 * loop.RATE)))
    whole = milliseconds(lambda: machine.Machine(loop.CALIBRATED).run(machine.Given(wave)), 3)
    for said, value, unit in (
        ("dense passive fit, 360 points by 21 columns", dense, "ms"),
        ("simplex search, 2000 evaluations", search, "ms"),
        ("  over the dense fit", search / dense, "x"),
        (f"describing function in closed loop, {frequencies.size} frequencies", described, "ms"),
        ("bank of 10 + 6 elements", x.size / run / 1e3, "Msample/s"),
        ("10 s of the 12 kHz loop, pivot of 60 + 10 elements", whole, "ms"),
    ):
        print(f"  {said:<62}{value:10.2f} {unit}")


if __name__ == "__main__":
    main()
