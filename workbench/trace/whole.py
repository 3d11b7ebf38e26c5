"""Whole records have the last word on what a search among thinned ones has found."""

from collections.abc import Sequence

from workbench.identify.fit import identify
from workbench.identify.passes import Passes
from workbench.identify.result import Fit
from workbench.plant import TWO_MASS, Plant
from workbench.trace.candidates import brought
from workbench.trace.judge import SHARE, Judgement
from workbench.trace.state import State

RISEN = 1.05  # of the drive's error, from which it has plainly risen


def on_whole(state: State, whole: Sequence[Passes]) -> float:
    """Return the nrmse of the drive that a state's model comes to on whole identification records, refined there."""
    found = State(state.problem.plant, whole, state.solution.theta)
    left = sum(float(part @ part) for part in found.problem.drive_part(found.solution.residual))
    return (left / found.power) ** 0.5 if found.power > 0.0 else 0.0


def in_turn(start: Fit, added: Sequence[Judgement], found: Plant, passes: Sequence[Passes]) -> list[Fit]:
    """Return `start` and the fits with one more effect each, up to the first that explains nothing on whole records.

    found: the plant that the search ended with.
    The search looks at thinned records and compares commands; a fit of the drive itself has the last word. It starts from the
    values that the search ended with, because a declared model that lacks much is fitted to values far from the machine's;
    and from the fit before it where that comes to nothing.
    """
    fits = [start]
    for j in added:
        plant = brought(fits[-1].plant, j.suspect, found)
        tried = (identify(p, passes) for p in (valued(plant, found), plant))
        better = next((fit for fit in tried if borne_out(fits[-1], fit)), None)
        if better is None:
            break
        fits.append(better)
    return fits


def borne_out(before: Fit, after: Fit) -> bool:
    """Whether whole records bear out what a fit has and the one before has not: the error of the drive falls.

    Of two masses it may be the load's balance alone in which it shows: then what both leave falls plainly, and the drive's
    error does not rise plainly.
    """
    if after.identification < before.identification:
        return True
    falls = before.plant.kind == TWO_MASS and after.details["cost"] < (1.0 - SHARE) * before.details["cost"]
    return falls and after.identification < RISEN * before.identification


def valued(plant: Plant, other: Plant) -> Plant:
    """Return `plant` with the values that the same effects have in `other`."""
    known = {e.key: {n: p.value for n, p in e.parameters.items()} for e in other.effects}
    return plant.with_values({e.key: known[e.key] for e in plant.effects if e.key in known})
