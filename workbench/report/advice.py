"""Which controller to take, as the first page says it: the file, how good it is, and by what margin it beats the next."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite

from workbench.finding import capital
from workbench.report import numbers
from workbench.verification.candidates import GRID_OVERSHOOT

EQUAL = 1.02  # ratio of two figures below which they are said to be as good
# Share of a time or an error by which two searches may part: two on the main study's declared model end at 142 and at 146 ms. With half as much the
# 7 % of error beside that would be called the effect's, with twice as much a fifth would not be.
LITTLE = 0.1
SPREAD = "over half to one and a half times inertia and friction"


@dataclass(frozen=True, eq=False)
class Advice:
    """controller: the recommended one. file: of its numbers, below the outputs, or "". rows: figures of all that were judged, the
    best first (verification.candidates.Candidate as mappings). displacement: SI unit of position."""

    controller: str
    file: str
    rows: tuple[Mapping[str, object], ...]
    displacement: str

    @property
    def allowed(self) -> bool:
        """Whether the controller keeps what was asked of it."""
        return _allowed(self.rows[0])


def _allowed(row: Mapping) -> bool:
    """Whether a controller comes to rest and overshoots no more than a point-to-point motion may."""
    return isfinite(float(row["time_grid"])) and float(row["overshoot_grid"]) <= GRID_OVERSHOOT


def headline(a: Advice) -> str:
    """Return the advice in two sentences: what to take, and the margin to the next."""
    best, *others = a.rows
    where = f" ({a.file})" if a.file else ""
    if not a.allowed:
        return (
            f"No controller that was tuned keeps the overshoot asked for; {a.controller}{where} comes nearest, with "
            f"{numbers.percent(best['overshoot_grid'])} in the worst case {SPREAD}."
        )
    text = (
        f"Take {a.controller}{where}: {SPREAD}, it is within 1 % of the target after {_time(best['time_grid'])} at most and ends "
        f"{_error(best, a)} off at most."
    )
    following = next(filter(_allowed, others), None)
    return text + (f" {_margin(best, following, a)}" if following else "")


def _margin(best: Mapping, other: Mapping, a: Advice) -> str:
    """Return how much worse the next one is, in time and in error."""
    name = f"{capital(str(other['name']))}, the next best,"
    time, error = (_ratio(other[k], best[k]) for k in ("time_grid", "error_grid"))
    if time == error == 1.0:
        return f"{name} is as good."
    slower = _differing(time, "takes as long", "takes {} longer", "takes {} less", "takes {} times as long")
    off = _differing(error, "ends as near", "ends {} farther off", "ends {} nearer", "ends {} times as far off")
    link = "and" if (time < 1.0) == (error < 1.0) or 1.0 in (time, error) else "but"
    return f"{name} {slower} {link} {off} ({_time(other['time_grid'])}, {_error(other, a)})."


def _ratio(value: float, than: float) -> float:
    """Return by what factor a figure differs; 1 where two are as good, or no factor says it."""
    value, than = float(value), float(than)
    if not (0.0 < value < inf and 0.0 < than < inf) or 1.0 / EQUAL < value / than < EQUAL:
        return 1.0
    return value / than


def _differing(ratio: float, same: str, more: str, less: str, times: str) -> str:
    """Return a ratio in words: per cent below twice as much, a factor from there on."""
    if ratio == 1.0:
        return same
    if ratio < 2.0:
        return (more if ratio > 1.0 else less).format(numbers.percent(abs(ratio - 1.0)))
    return times.format(numbers.number(ratio, 2 if ratio < 100.0 else 3))


def _within(value: float) -> str:
    return f"within 1 % after {_time(value)}" if isfinite(float(value)) else "never within 1 %"


def _time(value: float) -> str:
    return numbers.scaled(float(value), "s") if isfinite(float(value)) else "never"


def _error(row: Mapping, a: Advice) -> str:
    return numbers.scaled(float(row["error_grid"]), a.displacement)


def advice_of(tables: Mapping[str, object], files: Sequence[str], displacement: str) -> Advice | None:
    """Return the advice of a study's results; None where no controller was recommended. files: of the recommended one."""
    found = tables.get("recommended")
    if not found or not found.get("candidates"):
        return None
    first = sorted(files, key=lambda f: not f.endswith(".h"))
    return Advice(str(found["controller"]), first[0] if first else "", tuple(found["candidates"]), displacement)


def worth_in_short(tables: Mapping[str, object], displacement: str) -> str:
    """Return what knowing the found effect is worth to the controller that was tuned without it, too; "" where none was."""
    blind = next(iter(tables.get("comparison_tuned_on_declared", ())), None)
    if blind is None:
        return ""
    knowing = next((r for r in tables["comparison"] if r["controller"] == blind["controller"]), blind)
    was, now = (
        f"{numbers.scaled(r['final_error'], displacement)} off, {_within(r['time_1pct'])}" for r in (blind, knowing)
    )
    told = f"To the controller that is worth this: tuned with what was found, {blind['controller']} ends {now}; without, {was}."
    return f"{told} So little may be the search's doing." if _alike(blind, knowing) else told


def _alike(one: Mapping[str, float], other: Mapping[str, float]) -> bool:
    """Whether two controllers, tuned by two searches, part by as little as searches from other seeds may."""
    times, errors = ((float(one[n]), float(other[n])) for n in ("time_1pct", "final_error"))
    return all(isfinite(a) and isfinite(b) and abs(a - b) <= LITTLE * max(a, b) for a, b in (times, errors))
