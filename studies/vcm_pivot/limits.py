"""What compensation does not bear: too much of it, another pivot, a late one, disturbances that it does not see."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.frequency.amplitude import BestLinear, best_linear, multisine

from .loop import CALIBRATED, RATE, Preset
from .machine import NOTHING, REFERENCE, Compensation, Given, Machine, pivot
from .records import MILLI
from .responses import decibel, stepped

TEN, FIFTY = 10.0, 50.0
GAINS = (1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 30.0, 40.0)
DECAYED = 0.02  # of the pulse's own swing left at the end: a limit cycle leaves ten times as much
KICK, WAIT = 0.1, 1.4  # s: one period of 10 Hz, then a reference that stands
OBSERVER = 200.0  # Hz
LINES = np.arange(5, 301, 2)  # odd, of a period of 1 s
REALISATIONS, PERIODS = 8, 2


def change(
    machine: Machine, base: Machine, amplitude: float, frequency: float = TEN, where: str = "reference"
) -> float:
    """Return how much the error at one frequency changes from one machine to another, dB."""
    after, before = (stepped(m, amplitude, (frequency,), where).sensitivity[0] for m in (machine, base))
    return float(decibel(after) - decibel(before))


def left_swinging(machine: Machine, amplitude: float = 0.5) -> float:
    """Return the swing of x at the end, over that during a pulse of the reference; infinite where it grew without end."""
    t = np.arange(round((KICK + WAIT) * RATE)) / RATE
    wave = np.where(t < KICK, amplitude * np.sin(2 * np.pi * t / KICK), 0.0)
    x = machine.run(Given(wave))["x"]
    last, first = x[-round(0.2 * RATE) :], x[: round(KICK * RATE)]
    with np.errstate(over="ignore", invalid="ignore"):
        found = float(np.ptp(last) / np.ptp(first))
    return found if np.isfinite(found) and np.abs(last).max() < 1e3 * amplitude else np.inf


def over_compensated(preset: Preset, compensation: Compensation) -> dict[float, float]:
    """Return compensation gain -> what still swings at the end, up to the first that does not decay."""
    found = {}
    for g in GAINS:
        found[g] = left_swinging(Machine(preset, compensation=compensation.but(gain=g)))
        if found[g] > DECAYED:
            break
    return found


def largest_decaying(found: dict[float, float]) -> float:
    """Return the largest gain up to which every one decays."""
    good = [g for g, left in found.items() if left <= DECAYED]
    return max(good, default=0.0)


def mismatch(compensated: Machine, base: Machine, amplitude: float) -> dict[str, float]:
    """Return dB at 10 Hz with gains that are off, delays, low passes, and a pivot that is not the one identified."""
    c = compensated.compensation
    found = {}
    for g in (0.5, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 2.0):
        found[f"gain {g:g}"] = change(replace(compensated, compensation=c.but(gain=g)), base, amplitude)
    for d in (1, 2, 5, 10, 15):
        found[f"delay {d}"] = change(replace(compensated, compensation=c.but(delay=d)), base, amplitude)
    for cut in (1000.0, 300.0, 100.0):
        found[f"low pass {cut:g} Hz"] = change(replace(compensated, compensation=c.but(cut=cut)), base, amplitude)
    for name, other in (
        ("friction 0.7", pivot().scaled(0.7)),
        ("friction 1.3", pivot().scaled(1.3)),
        ("break-away 0.7", pivot().scaled(breakaway=0.7)),
        ("break-away 1.3", pivot().scaled(breakaway=1.3)),
    ):
        found[name] = change(replace(compensated, pivot=other), replace(base, pivot=other), amplitude)
    return found


def disturbances(compensated: Machine, base: Machine, amplitudes: Sequence[float]) -> list[dict]:
    """Return a row a disturbance, amplitude and frequency: dB that compensation, from x and from the reference, an
    observer, and both change."""
    by_reference = replace(compensated, compensation=compensated.compensation.but(source=REFERENCE))
    machines = {
        "compensation": compensated,
        "from the reference": by_reference,
        "observer": replace(base, observer=OBSERVER),
        "both": replace(compensated, observer=OBSERVER),
    }
    return [
        {"where": where, "amplitude": a, "frequency": f}
        | {name: change(m, base, a, f, where) for name, m in machines.items()}
        for where in ("reference", "output", "force")
        for a in amplitudes
        for f in (TEN, FIFTY)
    ]


def linear_approximation(machine: Machine, amplitude: float) -> BestLinear:
    """Return the best linear approximation of x over the controller's command under odd random-phase multisines."""
    n = round(RATE)
    waves = np.stack([multisine(LINES, n, amplitude / np.sqrt(2.0), seed + 1) for seed in range(REALISATIONS)])
    kept = [machine.run(Given(np.tile(w, PERIODS + 1))) for w in waves]
    c, x = (np.stack([k[name][n:].reshape(PERIODS, n) for k in kept]) for name in ("c", "x"))
    return best_linear(waves, c, x, LINES)


def on_bare_integrator(preset: Preset) -> float:
    """Return what swings at the end where the friction is gone altogether: what compensation closes the loop on."""
    return left_swinging(Machine(preset, pivot=NOTHING))


def with_pivot(preset: Preset) -> float:
    return left_swinging(Machine(preset))


def fully(preset: Preset, bank) -> float:
    """Return what swings with the friction of `bank` (mV/V) compensated."""
    return left_swinging(Machine(preset, compensation=Compensation(bank.times(1.0 / MILLI))))


BASE = Machine(CALIBRATED)
