"""What a paper printed beside what was obtained: deviation, and whether a stated tolerance is met, or why it cannot be."""

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.report import numbers
from workbench.report.contents import BAD, GOOD, Cell, Marked, Table


@dataclass(frozen=True)
class Printed:
    """One printed number. tolerance: of the relative deviation. reason: why it is not reproducible, where it is not; a row
    that meets its tolerance needs none. unit: SI."""

    what: str
    printed: float
    obtained: float
    tolerance: float
    unit: str = "1"
    reason: str = ""

    @property
    def deviation(self) -> float:
        """(obtained - printed)/printed."""
        return (self.obtained - self.printed) / self.printed

    @property
    def met(self) -> bool:
        return abs(self.deviation) <= self.tolerance

    @property
    def explained(self) -> bool:
        """Whether the tolerance is met, or a reason is stated."""
        return self.met or bool(self.reason)

    @property
    def verdict(self) -> Cell:
        if self.met:
            return Marked(f"within {numbers.percent(self.tolerance)}", GOOD)
        return Marked(f"not reproducible: {self.reason}" if self.reason else "missed", BAD)


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
    """Figures by which a study may be judged: rows, those that meet their tolerance, and those without either."""
    return {
        "reproduction_rows": float(len(rows)),
        "reproduction_met": float(sum(r.met for r in rows)),
        "reproduction_unexplained": float(sum(not r.explained for r in rows)),
    }


def as_table(rows: Sequence[Printed]) -> list[dict]:
    """The rows as results.json holds them."""
    return [{**vars(r), "deviation": r.deviation, "met": r.met} for r in rows]
