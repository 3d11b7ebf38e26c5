"""One bounded number with its unit and meaning."""

from dataclasses import dataclass, replace
from math import inf, isfinite

from workbench.errors import WorkbenchError

ROOM = 293.15  # K: temperature at which data sheets state friction, and of a bench where nobody logged one


@dataclass(frozen=True)
class Parameter:
    """A number of an effect.

    value: SI. unit: a template in which F stands for the effort (N*m or N) and x for the displacement (rad or m).
    lower, upper: physical bounds, inclusive. fixed: known, not fitted (a fixed value can still be wrong).
    scale: how data gives a start for a shape parameter: "" (none needed: linear), "speed", "stroke", "place", "load", "time",
    "drift", "rate", "resonance", "settling", "order", "exponent", "number"; "begin" of one held where the first record begins; starts are derived from the records by that word.
    """

    value: float
    unit: str
    meaning: str
    lower: float = -inf
    upper: float = inf
    fixed: bool = False
    scale: str = ""

    def at(self, value: float, *, fixed: bool | None = None, where: str = "parameter") -> "Parameter":
        """Return this parameter with another value; WorkbenchError where it is not finite or outside its bounds."""
        value = float(value)
        if not isfinite(value):
            raise WorkbenchError(f"{where} is {value}; a finite number is needed.")
        if not self.lower <= value <= self.upper:
            raise WorkbenchError(
                f"{where} is {value:g}, outside its physical bounds {self.lower:g} to {self.upper:g} ({self.meaning})."
            )
        return replace(self, value=value, fixed=self.fixed if fixed is None else fixed)
