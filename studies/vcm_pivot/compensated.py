"""The pivot compensated: responses before and after, what is left of 50 Hz, limits, disturbances."""

from dataclasses import dataclass

import numpy as np

from workbench.frequency.amplitude import BestLinear
from workbench.hysteresis import Bank

from . import limits
from .ladder import Preload
from .loop import CALIBRATED, PLANT, PRINTED, WEAK, integrator
from .machine import Compensation, Machine
from .records import MILLI, settled
from .responses import STEPPED, Stepped, decibel, described, linear_sensitivity, stepped

SIZES = (0.25, 0.5, 1.0, 1.5, 3.0)  # V of the reference
SHOWN = (0.25, 0.5, 1.5)
TEN = STEPPED.index(10.0)
HUMP = (49.0, 121.0)  # Hz
SHAKEN = 0.25  # V of the multisine: there the pivot is most nonlinear


@dataclass(frozen=True, eq=False)
class Compensated:
    """before, after: V -> stepped responses. cosine: before and after, (x, drive of the controller), V, of 50 Hz and 1 V."""

    before: dict[float, Stepped]
    after: dict[float, Stepped]
    cosine: tuple[tuple[np.ndarray, np.ndarray], ...]
    off: dict[str, float]
    off_small: dict[str, float]
    over: dict[str, dict[float, float]]
    weak: dict[str, float]
    disturbed: list[dict]
    linear: tuple[BestLinear, BestLinear]
    simplex: dict[float, float]  # V -> dB at 10 Hz with the operator of the paper's search

    def change(self, size: float) -> np.ndarray:
        """|S| after over before, dB, at the stepped frequencies."""
        return decibel(self.after[size].sensitivity) - decibel(self.before[size].sensitivity)

    @property
    def hump(self) -> float:
        """How much |S| rises at most, dB, at 0.25 and 1.5 V."""
        return max(float(self.change(a).max()) for a in (0.25, 1.5))

    def at(self, where: str, frequency: float) -> dict[str, float]:
        """What each remedy changes, dB, of a disturbance somewhere at one frequency: the least of it over the amplitudes."""
        rows = [d for d in self.disturbed if d["where"] == where and d["frequency"] == frequency]
        return {
            "compensation": max((d["compensation"] for d in rows), key=abs),
            "observer": max(d["observer"] for d in rows),
        }

    def hump_off(self, size: float) -> float:
        """How far |S| after compensation is from that of the loop without friction, dB, from 50 to 120 Hz."""
        f = self.after[size].frequency
        inside = (f > HUMP[0]) & (f < HUMP[1])
        off = decibel(self.after[size].sensitivity) - decibel(linear_sensitivity(CALIBRATED, f))
        return float(np.abs(off[inside]).max())


def machine(bank: Bank, **changes) -> Machine:
    """Return the calibrated loop with a bank (mV/V) compensated."""
    return Machine(CALIBRATED, compensation=Compensation(bank.times(1.0 / MILLI), **changes))


def linearity(x: np.ndarray, u: np.ndarray) -> float:
    """Return rms of what is left of u beside its best multiple of x, over the rms of u."""
    return float(np.sqrt(np.mean((u - x * (x @ u) / (x @ x)) ** 2) / np.mean(u**2)))


def compensated(bank: Bank, simplex: Bank, say) -> Compensated:
    """Run the loop before and after compensation by a bank (mV/V). simplex: as the paper's search found it."""
    base, better = limits.BASE, machine(bank)
    say("stepping sines before and after compensation")
    before, after = ({a: stepped(m, a) for a in SIZES} for m in (base, better))
    cosine = []
    for m in (base, better):
        seen = settled(m, 50.0, 1.0, 10)
        cosine.append((seen["x"].mean(axis=0), seen["c"].mean(axis=0)))
    say("looking for the limits of compensation")
    return Compensated(
        before,
        after,
        tuple(cosine),
        limits.mismatch(better, base, 1.5),
        limits.mismatch(better, base, 0.25),
        {p.name: limits.over_compensated(p, better.compensation) for p in (CALIBRATED, PRINTED)},
        {
            "with the pivot": limits.with_pivot(WEAK),
            "compensated": limits.fully(WEAK, bank),
            "without friction": limits.on_bare_integrator(WEAK),
        },
        limits.disturbances(better, base, (0.25, 1.5)),
        tuple(limits.linear_approximation(m, SHAKEN) for m in (base, better)),
        {a: limits.change(machine(simplex), base, a) for a in SIZES},
    )


def modelled(seen: Stepped, force: Bank | Preload) -> np.ndarray:
    """Return x over u of a model (mV/V) at the amplitudes that were met."""
    p = PLANT.response(seen.omega)
    return p / (1.0 + p * force.response(seen.amplitude, seen.omega) / MILLI)


def off_response(found: Compensated, force: Bank | Preload) -> tuple[float, float]:
    """Return the largest error of a model's response, dB and deg, over amplitudes and frequencies."""
    ratio = np.concatenate([modelled(found.before[a], force) / found.before[a].plant for a in SHOWN])
    return float(np.abs(decibel(ratio)).max()), float(np.abs(np.degrees(np.angle(ratio))).max())


def off_described(found: Compensated, bank: Bank) -> float:
    """Return the largest error, dB, of the describing function whose closed-loop amplitude is solved for."""
    return max(
        float(np.abs(decibel(described(CALIBRATED, bank, a, STEPPED).plant / found.before[a].plant)).max())
        for a in SHOWN
    )


def ceiling(found: Compensated, size: float) -> float:
    """Return what perfect compensation changes at 10 Hz, dB: friction gone, and no more."""
    return float(decibel(linear_sensitivity(CALIBRATED, (10.0,)))[0] - decibel(found.before[size].sensitivity[TEN]))


def figures(found: Compensated, bank: Bank, smallest: Preload) -> tuple[dict[str, float], dict[str, str]]:
    """Return (figures, units) of rows A11 to A20."""
    magnitude, phase = off_response(found, bank)
    after = found.after
    high = [i for i, f in enumerate(STEPPED) if f > 13.5]
    off, small = found.off, found.off_small
    forced, shown = (found.at(where, limits.TEN) for where in ("force", "output"))
    decibels = {
        "a11_magnitude": magnitude,
        "a11_preload_magnitude": off_response(found, smallest)[0],
        **{f"a12_change_at_{a:g}".replace(".", "_"): float(found.change(a)[TEN]) for a in (0.25, 0.5, 1.5, 3.0)},
        "a12_over_integrator": max(float(np.abs(after[a].over_integrator[TEN])) for a in (0.5, 1.0, 1.5)),
        "a13_over_integrator": max(float(np.abs(after[a].over_integrator[high]).max()) for a in (0.25, 0.5, 1.0, 1.5)),
        "a15_off_by_thirty": max(off["gain 0.7"], off["gain 1.3"]),
        "a15_off_by_ten": max(off["gain 0.9"], off["gain 1.1"]),
        "a16_two_samples_late": max(off["delay 2"], small["delay 2"]),
        "a18_hump": max(float(found.change(a)[i]) for a in (0.25, 1.5) for i in high),
        "a18_hump_off_linear": max(found.hump_off(a) for a in (0.25, 0.5, 1.5)),
        "a19_force_compensated": forced["compensation"],
        "a19_force_observer": forced["observer"],
        "a19_output_compensated": shown["compensation"],
        "a19_output_observer": shown["observer"],
        "a20_describing_function": off_described(found, bank),
    }
    plain = {
        "a14_linearity_before": linearity(*found.cosine[0]),
        "a14_linearity": linearity(*found.cosine[1]),
        "a17_decays_calibrated": limits.largest_decaying(found.over["calibrated"]),
        "a17_decays_printed": limits.largest_decaying(found.over["printed"]),
        "bare_integrator_left": limits.on_bare_integrator(CALIBRATED),
        "weak_loop_compensated": found.weak["compensated"],
    }
    return decibels | {"a11_phase": phase} | plain, dict.fromkeys(decibels, "dB") | {"a11_phase": "deg"}


def relative(response: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Return dB over the pure double integrator."""
    return decibel(response / integrator(omega))
