"""What a paper printed beside what was obtained: deviation, whether it is met, by a fit, or excused within a bound."""

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.report import numbers
from workbench.report.contents import BAD, GOOD, Cell, Marked, Table

RESULT, FIT, DERIVED, INPUT = "result", "fit", "derived", "input"  # kinds of a row


@dataclass(frozen=True)
class Printed:
    """One printed number beside what was obtained. tolerance: of the relative deviation; factor: instead of it, by which an
    error may be larger or smaller. unit: SI.

    kind: "result", "fit" (its numbers were fitted to the print, and a row of the same printed number says what is had without),
    "derived" (a ratio of others) or "input" (put in as printed), which count for nothing. of: the printed number that the row is of; `what` where empty.
    reason, within: why a row that is missed is excused, computed from what was found, and the factor up to which that holds.
    """

    what: str
    printed: float
    obtained: float
    tolerance: float = 0.05
    unit: str = "1"
    factor: float = 0.0
    kind: str = RESULT
    of: str = ""
    reason: str = ""
    within: float = 0.0

    @property
    def deviation(self) -> float:
        """(obtained - printed)/printed."""
        return (self.obtained - self.printed) / self.printed

    @property
    def ratio(self) -> float:
        """How many times too large or too small."""
        r = self.obtained / self.printed if self.obtained > 0.0 else float("inf")
        return max(r, 1.0 / r)

    @property
    def met(self) -> bool:
        return self.ratio <= self.factor if self.factor else abs(self.deviation) <= self.tolerance

    @property
    def explained(self) -> bool:
        """Whether it is met, or excused by a reason within the factor up to which that holds."""
        return self.met or bool(self.reason) and self.ratio <= self.within

    @property
    def verdict(self) -> Cell:
        if self.kind == INPUT and self.met:
            return "put in as printed"
        if self.met:
            said = f"within a factor of {self.factor:g}" if self.factor else f"within {numbers.percent(self.tolerance)}"
            return Marked(f"fitted, {said}" if self.kind == FIT else said, GOOD)
        if self.explained:
            return Marked(f"missed: {self.reason}", BAD)
        return Marked(f"missed, and more than a factor of {self.within:g} off" if self.reason else "missed", BAD)


def reproduction_table(rows: Sequence[Printed], caption: str) -> Table:
    """Printed value, obtained value, deviation, and what that comes to."""
    cells = tuple(
        (
            r.what,
            f"{numbers.exact(r.printed, 4)}\u00a0{numbers.unit(r.unit)}".strip(),
            numbers.quantity(r.obtained, r.unit),
            ("+" if r.deviation > 0 else "") + numbers.percent(r.deviation),
            r.verdict,
        )
        for r in rows
    )
    return Table(("what", "printed", "obtained", "deviation", "verdict"), cells, caption, "wrrrp")


def places_table(places: Sequence[tuple[str, str]]) -> Table:
    """Where the counterpart of each figure and table of a paper is. places: (what, chapters here)."""
    return Table(("in the paper", "here"), tuple(places), "Counterparts of what the paper shows.", "wp")


def counted(rows: Sequence[Printed]) -> dict[str, float]:
    """Figures by which a study may be judged: printed results, those that a row meets (and those of them that only a fit
    does), and rows without an excuse that holds. What is derived or was put in is none of the results."""
    results: dict[str, list[Printed]] = {}
    for r in rows:
        if r.kind not in (DERIVED, INPUT):
            results.setdefault(r.of or r.what, []).append(r)
    met = {n: [r for r in each if r.met] for n, each in results.items()}
    return {
        "reproduction_rows": float(len(results)),
        "reproduction_met": float(sum(bool(m) for m in met.values())),
        "reproduction_fitted": float(sum(bool(m) and all(r.kind == FIT for r in m) for m in met.values())),
        "reproduction_unexplained": float(sum(not r.explained for r in rows)),
    }


def as_table(rows: Sequence[Printed]) -> list[dict]:
    """The rows as results.json holds them."""
    return [{**vars(r), "deviation": r.deviation, "met": r.met, "explained": r.explained} for r in rows]
