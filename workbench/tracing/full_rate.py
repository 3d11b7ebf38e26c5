"""Whole records have the last word on what a search among decimated ones has found."""

from collections.abc import Iterator, Sequence

import numpy as np

from workbench.identification.fit import end_of_search, fitted_on, identify, with_fitted
from workbench.identification.result import Fit
from workbench.inverse.dynamics import InverseDynamics
from workbench.inverse.prehistory import begun_at
from workbench.plant import TWO_MASS, Plant
from workbench.processes import shared
from workbench.tracing.candidates import brought
from workbench.tracing.judge import ScoredCandidate
from workbench.tracing.preparing import Declared
from workbench.tracing.starting import FURTHER

SETTLED = 1e-5  # relative decrease of the cost at which a fit on whole records is as good as it is compared
# Of what two balances leave, by which it falls plainly; all additions together take that much more than those that stand alone. Of 232 axes
# five asked so, and took 13 % and more: neither halved nor doubled it changes any
FALLS = 0.05
HALF = 0.5  # of the power that the search had an addition take: halved or doubled, three axes with a gap or a cable keep their causes
RISEN = 0.05  # relative rise of the drive's error from which it has plainly risen


def nested_fits(
    late: Declared, added: Sequence[ScoredCandidate], found: Plant, seen: Sequence[InverseDynamics]
) -> tuple[list[ScoredCandidate], list[Fit]]:
    """Return what whole records bear out of what was added, and the fits: of the declared plant, and with one more of these each.

    found: the plant that the search ended with. seen: the decimated records that it has seen last, by name.
    The search looks at decimated records and compares commands; a fit of the drive itself has the last word. It starts from the
    values that the search ended with, because a declared model that lacks much is fitted to values far from the machine's;
    and from the fit before it where that comes to nothing.
    """
    whole = begun_at(fitted_on(late.inverses), [p.motion.record.found for p in seen])
    inverses, plants = with_fitted(late.inverses, whole), [late.plant]
    for j in added:
        plants.append(valued(brought(plants[-1], j.candidate, found), found))
    # no search needs another one's result
    ends = [None, *shared(lambda p: _end(p, whole), plants[1:])]
    fits = [late.fit]
    kept: list[ScoredCandidate] = []
    for i, j in enumerate(added):
        plant = brought(fits[-1].plant, j.candidate, found)
        end = ends[i + 1] if i == len(kept) else None  # else it is of a plant with what was not borne out
        again = [(valued(plant, found), end), (plant, None)]
        again += [(valued(plant, j.refitted.plant), None)] if j.refitted else []
        better = _confirmed(fits[-1], again, j.score.gain, inverses, whole)
        if better is not None:
            kept.append(j)
            fits.append(better)
    if len(kept) == len(added) or ends[-1] is None:
        return kept, fits
    last = identify(plants[-1], inverses, ends[-1], solved=True)
    if not (is_confirmed(fits[-1], last) and last.details["cost"] < (1.0 - FALLS) * fits[-1].details["cost"]):
        return kept, fits
    # one needs another (a body that hides behind a spring, and the mass that was counted in): together they stand
    between = (
        identify(p, inverses, end, solved=end is not None) for p, end in zip(plants[1:-1], ends[1:-1], strict=True)
    )
    return list(added), [fits[0], *between, last]


def _confirmed(
    before: Fit,
    starts: Sequence[tuple[Plant, np.ndarray | None]],
    gain: float,
    inverses: Sequence[InverseDynamics],
    whole: Sequence[InverseDynamics],
) -> Fit | None:
    """Return the first fit from these starts that is borne out and takes half of what the search had its addition take, else the best one that is
    borne out, None where none is. A gap's width may have become that of its flanks beside a law that bends them, and is nothing without.

    whole: the records that are fitted. Starts of which no end is known are searched side by side.
    """
    found: list[Fit] = []
    for plant, theta in _ended(starts, whole):
        fit = identify(plant, inverses, theta, solved=theta is not None)
        if is_confirmed(before, fit):
            if fit.details["cost"] <= (1.0 - HALF * gain) * before.details["cost"]:
                return fit
            found.append(fit)
    return min(found, key=lambda fit: fit.details["cost"], default=None)


def _ended(
    starts: Sequence[tuple[Plant, np.ndarray | None]], whole: Sequence[InverseDynamics]
) -> Iterator[tuple[Plant, np.ndarray | None]]:
    """Yield starts with where a search from each ends: the first as soon as it is asked for, the others together."""
    (plant, theta), *others = starts
    yield plant, _end(plant, whole) if theta is None else theta
    yield from zip((p for p, _ in others), shared(lambda p: _end(p, whole), [p for p, _ in others]), strict=True)


def _end(plant: Plant, whole: Sequence[InverseDynamics]) -> np.ndarray | None:
    return end_of_search(plant, whole, SETTLED, FURTHER)


def settled(plant: Plant, inverses: Sequence[InverseDynamics]) -> Fit:
    """Return the fit of a plant on whole records, as near to its end as the others are that it is held against."""
    end = _end(plant, fitted_on(inverses))
    return identify(plant, inverses, end, solved=end is not None)


def is_confirmed(before: Fit, after: Fit) -> bool:
    """Whether whole records bear out what a fit has and the one before has not: the error of the drive falls.

    Of two masses it may be the load's balance alone in which it shows: then what both leave falls plainly, and the drive's
    error does not rise plainly.
    """
    if after.identification < before.identification:
        return True
    falls = before.plant.kind == TWO_MASS and after.details["cost"] < (1.0 - FALLS) * before.details["cost"]
    return falls and after.identification < (1.0 + RISEN) * before.identification


def valued(plant: Plant, other: Plant) -> Plant:
    """Return `plant` with the values that its free parameters have in `other`.

    What is fixed in `plant` stays as it was declared: `other` may have set it free, which is a cause of its own.
    """
    known = {e.key: e.parameters for e in other.effects}
    values = {
        e.key: {n: known[e.key][n].value for n, p in e.parameters.items() if not p.fixed}
        for e in plant.effects
        if e.key in known
    }
    return plant.with_values(values)
