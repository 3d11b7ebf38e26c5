"""The schedule itself: gains at knots, and the look-up that firmware repeats."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from workbench.control import Table, gains_at
from workbench.control.laws import RULES
from workbench.control.notched import coefficients
from workbench.errors import WorkbenchError, nearest
from workbench.finding import Finding
from workbench.frequency import Notch
from workbench.notebook import page
from workbench.tuning.gains import check_gains


@dataclass(frozen=True, eq=False)
class Schedule:
    """PD gains u = Kp(A) (r - y) - Kd(A) vh over the amplitude A of the equivalent motion; arrays read-only, SI.

    knots (m,): 2^e (1 + j/per_octave), consecutive, rad or m. kp (m,): N*m/rad or N/m. kd (m,): N*m*s/rad or N*s/m. Between
    knots both are linear in A; beyond them they are those of the end. rule: "frozen", gains are taken at each reversal and
    held to the next; "following", they move with the stroke; "error", with the stroke as far as it is no more than the error
    that is left; "closing", with the error, down to the lesser of the move and sixteen reversals. reversal: how far back a reversal counts, rad or m.
    sample_time: s, that they were tuned for. plant_digest, plant_lines: of the plant that was tuned (Plant.digest,
    Plant.digest_lines). velocity_filter: s, and notch: behind the law, of the law's own, where it was tuned with them. interpolation_error: largest relative difference of kp or kd from the tuned gains, between the knots
    too.
    """

    knots: np.ndarray
    kp: np.ndarray
    kd: np.ndarray
    per_octave: int
    rule: str = "frozen"
    reversal: float = 0.0
    sample_time: float = 0.0
    plant_digest: str = ""
    plant_lines: tuple[str, ...] = ()
    interpolation_error: float = 0.0
    findings: tuple[Finding, ...] = ()
    velocity_filter: float | None = None
    notch: Notch | None = None

    def __post_init__(self):
        for name in ("knots", "kp", "kd"):
            copy = np.array(getattr(self, name), dtype=float)
            copy.flags.writeable = False
            object.__setattr__(self, name, copy)
        check_gains(self.knots, self.kp, self.kd)
        if self.rule not in RULES:
            raise WorkbenchError(f"unknown rule '{self.rule}' of a schedule; {nearest(str(self.rule), RULES)}")
        if 1 << (52 - self._table.shift) > self.per_octave or self._coarse():
            raise WorkbenchError(
                f"schedule: the knots do not lie at 2^e (1 + j/{self.per_octave}), one after the other, per_octave a power of two."
            )

    def _coarse(self) -> bool:
        """The knots are not consecutive on the grid that per_octave states (few knots can lie on several grids)."""
        octave = np.exp2(np.floor(np.log2(self.knots[:-1])))
        return bool((np.diff(self.knots) * self.per_octave != octave).any())

    @property
    def numbers(self) -> tuple[float, float, float, float] | None:
        """(b0, b1, b2, a2) of the notch at the schedule's sample time, or None."""
        return None if self.notch is None else coefficients(self.notch, self.sample_time)

    @cached_property
    def _table(self) -> Table:
        return Table(self.knots, {"kp": self.kp, "kd": self.kd})

    def segment(self, amplitude) -> np.ndarray:
        """Return the number of the segment that each amplitude lies in, from the leading bits of the double; shape kept.

        Segment i is knots[i] <= A < knots[i + 1]; below the first knot it is 0, from the last on m - 1.
        """
        clipped = self._clip(amplitude)
        return (clipped.view(np.int64) >> self._table.shift) - self._table.offset

    def gains(self, amplitude) -> tuple[np.ndarray, np.ndarray]:
        """Return (kp, kd) at amplitudes of any shape: the arithmetic that the simulation and firmware repeat."""
        clipped = self._clip(amplitude)
        kp, kd = gains_at(self._table, clipped.ravel())
        return kp.reshape(clipped.shape), kd.reshape(clipped.shape)

    def _clip(self, amplitude) -> np.ndarray:
        amplitude = np.asarray(amplitude, dtype=float)
        if np.isnan(amplitude).any():
            raise WorkbenchError("schedule: an amplitude is not a number.")
        return np.array(np.clip(amplitude, self.knots[0], self.knots[-1]), order="C")

    def as_arrays(self) -> dict[str, np.ndarray]:
        """Return what a simulation needs: knots, kp, kd, and rows (m, 4), kp = rows[i, 0] + rows[i, 1] A, kd = rows[i, 2] + ..."""
        return {"knots": self.knots, "kp": self.kp, "kd": self.kd, "rows": self._table.rows}

    def noting(self, *findings: Finding) -> "Schedule":
        """Return this schedule with findings added."""
        return replace(self, findings=(*self.findings, *findings))

    def _repr_html_(self) -> str:
        """The gains at the knots, as a table and as a drawing."""
        sentence = (
            f"{self.knots.size} knots, rule '{self.rule}', tuned for a sample time of {1e6 * self.sample_time:.4g} µs; between "
            f"them the gains are within {self.interpolation_error:.2%} of the tuned ones."
        )
        rows = zip(self.knots, self.kp, self.kd, strict=True)
        return page(sentence, ("amplitude, rad or m", "kp, SI", "kd, SI"), rows, self._draw, graphs=2)

    def _draw(self, axes) -> None:
        for axis, values, name in zip(axes, (self.kp, self.kd), ("kp", "kd"), strict=True):
            axis.loglog(self.knots, values, ".-")
            axis.set_ylabel(f"{name}, SI")
        axes[-1].set_xlabel("amplitude, rad or m")
