"""A control law: declarative data and short functions in CasADi SX, as an effect is, for the sampled loop to run.

`step(s, z, p)` returns ({state: next value}, command). It sees in `s`: r (target), y (reading), e = r - y, vh (filtered
velocity), dt (sample time), limit (of the drive; infinite where not stated), back (how far back a reversal counts), and the
columns of its table by name.
A law with a table also has `amplitude(s, z, p)`, which returns ({state: next value}, where to look up) and sees besides
stroke (distance since the last motion reversal), share (1 from rest, 1/2 after a reversal), reversal (1 in the sample in
which one is found) and count (the encoder's resolution).

Where there are two masses, y is the reading of the encoder that closes the loop. A law that wants more says so: `reads`
names what it sees besides, motor_y and load_y (both encoders), motor_vh and load_vh (their filtered velocities); and
`follows` says whose reversals count: "feedback", those of y, or "joint", those of the relative displacement
motor_y - load_y.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from workbench.control.table import Table
from workbench.errors import WorkbenchError, nearest

READINGS = ("motor_y", "load_y", "motor_vh", "load_vh")
FEEDBACK, JOINT = "feedback", "joint"
FOLLOWED = (FEEDBACK, JOINT)


@dataclass(frozen=True)
class Law:
    """See the module. parameters, columns (of the table), states: names. start(target, reading) -> {state: value}. before: the law
    that a notch is behind of, where there is one."""

    name: str
    parameters: tuple[str, ...]
    step: Callable
    states: tuple[str, ...] = ()
    columns: tuple[str, ...] = ()
    amplitude: Callable | None = None
    start: Callable | None = None
    reads: tuple[str, ...] = ()
    follows: str = FEEDBACK
    before: "Law | None" = None

    def __post_init__(self):
        for name in self.reads:
            if name not in READINGS:
                raise WorkbenchError(
                    f"law '{self.name}' reads '{name}', which is no reading; {nearest(name, READINGS)}"
                )
        if self.follows not in FOLLOWED:
            raise WorkbenchError(f"law '{self.name}' follows '{self.follows}'; {nearest(self.follows, FOLLOWED)}")

    @property
    def both(self) -> bool:
        """Whether the law asks for the readings of two encoders."""
        return bool(self.reads) or self.follows == JOINT


@dataclass(frozen=True, eq=False)
class Controller:
    """A law with its numbers.

    parameters: name -> scalar, or (lanes,) array with a value a lane. tables: none, one for all lanes, or several of
    one grid of knots. table (lanes,): which of the tables a lane uses; the first where absent. reversal: distance back
    that counts as a reversal, in SI; three counts of the encoder (of the coarser one, where two are followed) where absent.
    velocity_filter: time constant of the filtered difference, s, scalar or (lanes,); the loop's own where absent.
    """

    name: str
    law: Law
    parameters: Mapping[str, float | np.ndarray] = field(default_factory=dict)
    tables: tuple[Table, ...] = ()
    table: np.ndarray | None = None
    reversal: float | None = None
    velocity_filter: float | np.ndarray | None = None

    def __post_init__(self):
        if self.velocity_filter is not None and not (np.asarray(self.velocity_filter) >= 0.0).all():
            raise WorkbenchError(f"controller '{self.name}': the velocity filter must be finite and not negative.")
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        for name, value in self.parameters.items():
            if not np.isfinite(value).all():
                raise WorkbenchError(f"controller '{self.name}': {name} is not finite.")
        if len({t.grid for t in self.tables}) > 1:
            raise WorkbenchError(f"controller '{self.name}': its tables have different knots; use one grid for all.")

    def taken(self, lanes: np.ndarray) -> "Controller":
        """Return the controller whose lane k is lane lanes[k] of this one."""

        def of(value):
            return value if value is None or np.ndim(value) == 0 else value[lanes]

        parameters = {n: of(v) for n, v in self.parameters.items()}
        return replace(self, parameters=parameters, table=of(self.table), velocity_filter=of(self.velocity_filter))
