"""The linear axis at each amplitude, in units of the sample: y'' + (loss/w_n + damping) y' + stiffness y = u."""

from dataclasses import dataclass, replace

import numpy as np

from workbench.errors import WorkbenchError
from workbench.tuning import sampled
from workbench.tuning.gains import check_amplitude


@dataclass(frozen=True)
class Axis:
    """amplitude (n,): rad or m. stiffness, loss (n,) and damping: k_e Ts^2/J, c_e w Ts^2/J and b Ts/J.

    unit_kp, unit_kd: SI gains of one unit here, J/Ts^2 and J/Ts.
    """

    clock: sampled.Clock
    amplitude: np.ndarray
    stiffness: np.ndarray
    loss: np.ndarray
    damping: float
    inertia: float

    @classmethod
    def of(cls, equivalent, inertia: float, viscous: float, loop) -> "Axis":
        """Return the axis of an Equivalent(amplitude, stiffness, loss), (n,) each, SI; WorkbenchError says what is wrong."""
        if not (np.isfinite(inertia) and inertia > 0.0):
            raise WorkbenchError(f"inertia is {inertia:g}; tuning needs a positive one.")
        if not (np.isfinite(viscous) and viscous >= 0.0):
            raise WorkbenchError(f"viscous damping is {viscous:g}; tuning needs one that is not negative.")
        for name, low in (("sample_time", True), ("delay", False), ("velocity_filter", False)):
            value = getattr(loop, name)
            if not (np.isfinite(value) and (value > 0.0 if low else value >= 0.0)):
                raise WorkbenchError(
                    f"the loop's {name} is {value:g} s; it must be {'above' if low else 'at least'} 0."
                )
        amplitude, stiffness, loss = (
            np.atleast_1d(np.asarray(a, dtype=float))
            for a in (equivalent.amplitude, equivalent.stiffness, equivalent.loss)
        )
        if not amplitude.shape == stiffness.shape == loss.shape or amplitude.ndim != 1 or not amplitude.size:
            raise WorkbenchError("amplitude, stiffness and loss must be arrays of one length, at least one value.")
        check_amplitude(amplitude)
        for name, values in (("stiffness", stiffness), ("loss", loss)):
            wrong = ~(np.isfinite(values) & (values >= 0.0))
            if wrong.any():
                i = int(np.argmax(wrong))
                raise WorkbenchError(
                    f"equivalent {name} at amplitude {amplitude[i]:g} is {values[i]:g}; it must be finite and not negative."
                )
        clock = sampled.Clock.of(loop)
        per = clock.sample_time**2 / inertia
        return cls(clock, amplitude, stiffness * per, loss * per, viscous * clock.sample_time / inertia, inertia)

    @property
    def unit_kp(self) -> float:
        return self.inertia / self.clock.sample_time**2

    @property
    def unit_kd(self) -> float:
        return self.inertia / self.clock.sample_time

    def behind(self, notch: tuple[float, float, float, float] | None) -> "Axis":
        """Return the axis whose law has a notch of numbers (b0, b1, b2, a2) behind it, or none."""
        return replace(self, clock=replace(self.clock, notch=notch))

    def take(self, rows) -> "Axis":
        """Return the axis at some of the amplitudes."""
        return replace(self, amplitude=self.amplitude[rows], stiffness=self.stiffness[rows], loss=self.loss[rows])

    def omega(self, kp: np.ndarray) -> np.ndarray:
        """Natural frequency of the closed loop times Ts, sqrt(kp + stiffness)."""
        return np.sqrt(kp + self.stiffness)

    def passive(self, kp: np.ndarray) -> np.ndarray:
        """Damping that the axis itself has at the closed loop's natural frequency: loss/w_n + b."""
        return self.loss / np.maximum(self.omega(kp), 1e-300) + self.damping

    def zeta(self, kp: np.ndarray, kd: np.ndarray) -> np.ndarray:
        """Damping ratio of the closed loop."""
        return (kd + self.passive(kp)) / (2.0 * self.omega(kp))

    def steps(self, kp: np.ndarray):
        """The exact sampled plant, with the damping that goes with kp; see sampled.steps."""
        return sampled.steps(self.stiffness, self.passive(kp), self.clock)
