"""Everything that is fitted: on one frequency as the paper, on several, with noise, and with converters."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.hysteresis import Bank, Fitted, nonnegative, pruned, shaped
from workbench.hysteresis.fit import gains, grid, left_out

from . import ladder
from .records import AMPLITUDE, HELD_OUT, MANY, PEAK_TO_PEAK, Extracted, Noise, against_true, floor, measured

HALF = 0.5  # reach of the radii of a model that is used beyond its records
EVENS = (0.0, 0.5, 1.0)


@dataclass(frozen=True)
class Sizes:
    """starts: of the simplex search; dense, many, few: plays and creep elements; even: see `nonnegative`."""

    starts: int
    dense: tuple[int, int]
    many: tuple[int, int]
    few: tuple[int, int]
    even: float


@dataclass(frozen=True, eq=False)
class Ladder:
    """One set of records, fitted in every way. floor: of the extraction; true: method -> gain against the pivot itself."""

    name: str
    seen: list[Extracted]
    floor: float
    simplex: list[ladder.Simplex]
    passive: Fitted
    dense: Fitted
    shaped: Fitted
    preload: ladder.Preload
    preload_gain: float
    smallest: ladder.Preload
    smallest_gain: float
    rank: tuple[int, float]

    @property
    def best_simplex(self) -> ladder.Simplex:
        return min(self.simplex, key=lambda s: s.gain)

    def true(self, bank: Bank) -> float:
        return against_true(bank, self.seen)


def climbed(name: str, conditions, noise: Noise, sizes: Sizes) -> Ladder:
    """Return every fit of one set of records."""
    seen = measured(conditions, noise)
    records = [e.record for e in seen]
    few, dense = grid(records, *sizes.few), grid(records, *sizes.dense)
    preload, smallest = ladder.fit_preload(records), ladder.fit_preload(records[:1])
    return Ladder(
        name,
        seen,
        floor(seen),
        [ladder.simplex(records, s) for s in ladder.starts(sizes.starts)],
        pruned(records, *sizes.few) if len(few[0]) else nonnegative(records, *few),
        nonnegative(records, *dense),
        shaped(records, *dense),
        preload,
        ladder.preload_gain(preload, records),
        smallest,
        ladder.preload_gain(smallest, records[:1]),
        ladder.identifiable(conditions, ladder.printed()),
    )


@dataclass(frozen=True, eq=False)
class Broad:
    """The model that is used: fitted on several frequencies. left: `even` -> gain on records left out. held: on tests."""

    seen: list[Extracted]
    floor: float
    fit: Fitted
    left: dict[float, float]
    tests: list[Extracted]
    held: list[float]
    few: Fitted
    few_held: list[float]
    rank: tuple[int, float]

    @property
    def bank(self) -> Bank:
        """mV/V."""
        return self.fit.bank


def broad(noise: Noise, sizes: Sizes) -> Broad:
    """Return the model fitted on several frequencies, and how it does on what it has not seen."""
    seen, tests = measured(MANY, noise), measured(HELD_OUT, Noise())
    records = [e.record for e in seen]
    radii, rates = grid(records, *sizes.many, HALF)
    fit = nonnegative(records, radii, rates, sizes.even)
    few = pruned(records, *sizes.few, starts=2)
    return Broad(
        seen,
        floor(seen),
        fit,
        {even: left_out(records, radii, rates, even) for even in EVENS},
        tests,
        ladder.held_out(fit.bank, tests),
        few,
        ladder.held_out(few.bank, tests),
        ladder.identifiable(MANY, ladder.printed()),
    )


@dataclass(frozen=True, eq=False)
class Identified:
    """Both readings of the paper's amplitudes without noise, the first with it, several frequencies, and with converters."""

    peak: Ladder
    amplitude: Ladder
    noisy: Ladder
    broad: Broad
    converted: dict[str, float]


def identified(noise: Noise, count: float, sizes: Sizes, say) -> Identified:
    """Return every fit. count: of the converters, V."""
    say("fitting the records of one frequency")
    peak, amplitude = (
        climbed(n, c, Noise(), sizes) for n, c in (("peak to peak", PEAK_TO_PEAK), ("amplitude", AMPLITUDE))
    )
    noisy = climbed("peak to peak, with noise", PEAK_TO_PEAK, noise, sizes)
    say("fitting the records of several frequencies")
    return Identified(peak, amplitude, noisy, broad(noise, sizes), converted(noise, count, sizes))


def converted(noise: Noise, count: float, sizes: Sizes) -> dict[str, float]:
    """Return floors and gains of the same records through converters of 16 bits, noise-free and with noise."""
    found = {}
    for name, conditions in (("peak to peak", PEAK_TO_PEAK), ("amplitude", AMPLITUDE)):
        for said, one in (
            ("", Noise(averages=noise.averages, count=count)),
            (", with noise", with_count(noise, count)),
        ):
            seen = measured(conditions, one)
            records = [e.record for e in seen]
            fit = nonnegative(records, *grid(records, *sizes.dense))
            found[f"{name}{said}: floor"] = floor(seen)
            found[f"{name}{said}: dense"] = fit.gain
            found[f"{name}{said}: dense, against the pivot"] = against_true(fit.bank, seen)
    return found


def with_count(noise: Noise, count: float) -> Noise:
    return Noise(noise.windage, noise.sensor, noise.averages, count)


def identities(seed: int = 1) -> tuple[float, float, float]:
    """Return errors of: x - play against a Maxwell-slip element; an inverse's round trip; play's describing function."""
    from workbench.description import first_harmonic
    from workbench.effects.hysteresis import maxwell_slip
    from workbench.effects.play import inverse, play_bank
    from workbench.kernel.step import build

    random = np.random.default_rng(seed)
    x = np.cumsum(random.standard_normal(20_000)) * 0.05
    dq = np.diff(x, prepend=x[0])
    radii, weights = (0.2, 0.5, 1.5), (9.0, -1.0, 0.2, -0.06)
    slip = maxwell_slip(radii)
    values = {n: p.value for n, p in slip.parameters.items()}
    elements = build(slip).run({"dq": dq, "dt": 1e-3}, values)
    bank = Bank(0.0, radii, np.ones(3), (), ())
    identity = np.abs(elements[: len(radii)].sum(axis=0) - bank.run(x, 1e-3)).max()

    def run(effect, signal):
        v = {n: p.value for n, p in effect.parameters.items()}
        columns = build(effect).run({"dq": np.diff(signal, prepend=0.0), "dt": 1e-3}, v)
        return np.array([v[n] for n in effect.linear]) @ columns

    there = run(play_bank(radii, weights), x - x[0])
    back = run(play_bank(*inverse(radii, weights)), there)
    amplitudes = np.array([0.3, 0.7, 2.0])
    stepped = first_harmonic(maxwell_slip((0.25,))(k1=1.0), amplitudes, 2 * np.pi * 10.0)
    closed = Bank(0.0, (0.25,), (1.0,), (), ()).response(amplitudes, 2 * np.pi * 10.0)
    off = np.abs(stepped.stiffness + 1j * stepped.loss - closed).max()
    return float(identity), float(np.abs(back - (x - x[0])).max()), float(off)


def worst(bank: Bank, tests: Sequence[Extracted]) -> float:
    return max(gains(bank, [t.record])[0] for t in tests)
