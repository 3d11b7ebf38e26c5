"""Signals over time that a run is given, at the control rate: a reference, what is added to the command, a drive, a temperature.

One that is the same in all scenarios is a clock of the kernel; one that is each scenario's own is a row of lanes.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from workbench.errors import WorkbenchError

REFERENCE, INJECTED, DRIVE = "reference", "injected", "u_c"  # DRIVE: the row of the command, where no law decides it
TEMPERATURE = "temperature"  # of the bench, K: a scenario's own number where it is not given over time


@dataclass(frozen=True, eq=False)
class Given:
    """names: in the order in which they lie. shared (samples, signals); own (samples, signals, lanes), or, with `which` (lanes,),
    (samples, signals, any number), of which that says each lane's."""

    shared_names: tuple[str, ...]
    own_names: tuple[str, ...]
    shared: np.ndarray
    own: np.ndarray
    which: np.ndarray | None = None

    @property
    def structure(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """What a design depends on: (names of the shared signals, names of each scenario's own)."""
        return self.shared_names, self.own_names

    def has(self, name: str) -> bool:
        return name in (*self.shared_names, *self.own_names)

    def last(self, name: str) -> np.ndarray | float:
        """Return the last value of a signal, scalar or (lanes,)."""
        if name in self.shared_names:
            return float(self.shared[-1, self.shared_names.index(name)])
        last = self.own[-1, self.own_names.index(name)]
        return last if self.which is None else last[self.which]

    def of_lanes(self, lanes: np.ndarray, samples: int) -> np.ndarray:
        """Return the own signals (samples, signals, n) of lanes (n,), for so many samples at most."""
        return np.take(self.own[:samples], lanes if self.which is None else self.which[lanes], axis=2)


def given_of(signals: Mapping[str, np.ndarray | None], samples: int, lanes: int) -> Given:
    """Return signals (n,) for all scenarios or (n, lanes), n >= samples, cut to `samples`; None is absent.

    Raises WorkbenchError for another shape, too few samples, or a value that is not finite.
    """
    shared, own = {}, {}
    for name, signal in signals.items():
        if signal is None:
            continue
        x = np.asarray(signal, dtype=float)
        called = "drive" if name == DRIVE else name
        if x.ndim not in (1, 2) or (x.ndim == 2 and x.shape[1] != lanes):
            raise WorkbenchError(
                f"the {called} has shape {x.shape}; (n,) for all scenarios or (n, {lanes}), one column a scenario, is needed."
            )
        if len(x) < samples:
            raise WorkbenchError(
                f"the {called} has {len(x)} samples, but the run has {samples}; give one value a control sample."
            )
        if not np.isfinite(x).all():
            raise WorkbenchError(f"the {called} is not finite throughout.")
        (own if x.ndim == 2 else shared)[name] = x[:samples]
    return Given(
        tuple(shared),
        tuple(own),
        np.stack([*shared.values()], axis=1) if shared else np.zeros((1, 0)),
        _side_by_side([*own.values()]) if own else np.zeros((1, 0, lanes)),
    )


def _side_by_side(signals: list[np.ndarray]) -> np.ndarray:
    """Return signals (n, lanes) as (n, signals, lanes); of one alone no copy is made."""
    return np.stack(signals, axis=1) if len(signals) > 1 else signals[0][:, None]
