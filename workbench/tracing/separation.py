"""Two effects that explain the same records, told apart: each fitted as a trace does, and the motion along which they differ most."""

from collections.abc import Sequence

import numpy as np

from workbench.definition import Effect
from workbench.errors import WorkbenchError, nearest
from workbench.identification.fit import fitted_on
from workbench.identification.problem import Problem
from workbench.identification.result import Fit
from workbench.identification.solve import solve
from workbench.inverse.dynamics import InverseDynamics
from workbench.planning import Sensing, Separation, sensing_of, separate
from workbench.planning.basis import Basis
from workbench.plant import Plant
from workbench.record import IDENTIFICATION
from workbench.tracing.candidates import WHOLE
from workbench.tracing.search import fitted


def separation_of(basis: Basis, first: str, second: str) -> tuple[Separation, Plant, Effect, Sensing]:
    """Return the motion that tells two effects apart; the plant without either, the first effect, and how its log sees.

    first, second: "effect" or "effect@place", as of `_candidate`. WorkbenchError where they are one, or there is none of this name.
    """
    (plant, a, left), (_, b, also) = _candidate(basis, first), _candidate(basis, second)
    if a.key == b.key:
        raise WorkbenchError(f"'{a.key}' is named twice; name two effects.")
    # an effect that is declared is taken out of the model that both share
    plant = plant.without(b.key) if b.key in (e.key for e in plant.effects) else plant
    sensing = sensing_of(basis.inverses, min(left, also), basis.load)
    return separate(plant, a, b, basis.envelope, sensing), plant, a, sensing


def _candidate(basis: Basis, text: str) -> tuple[Plant, Effect, float]:
    """Return (the plant without it, the effect with the values that explain the records, the rms of what is then left).

    text: "effect" or "effect@place". A declared effect keeps its fitted values; another one is fitted jointly with the
    declared model, as a trace does.
    """
    plant, (name, _, place) = basis.fit.plant, text.partition("@")
    for e in plant.effects:
        if name == e.name and place in ("", e.at):
            return plant.without(e.key), e, basis.fit.rms[IDENTIFICATION]
    known = WHOLE.candidates(plant)
    chosen = next((s for s in known if s.effect == name and place in ("", s.at)), None)
    if chosen is None:
        raise WorkbenchError(f"there is no candidate '{text}' for this plant; {nearest(text, _names_of(known, place))}")
    records = fitted_on(basis.inverses)
    declared = Problem(plant, records)
    beside, found = fitted(chosen, declared, solve(declared), _residuals(basis.fit, records))
    problem = beside.free
    solution = solve(problem, beside.free_start(found))
    effect = problem.at(solution.theta, solution.c)[chosen.key]
    return plant, effect, float(np.sqrt(solution.cost / solution.y.size))


def _names_of(known: Sequence, place: str) -> list[str]:
    """Return what candidates are called: with their places where one was asked for, else by name alone."""
    return [s.key if place else s.effect for s in known]


def _residuals(fit: Fit, inverses: list[InverseDynamics]) -> list[np.ndarray]:
    """Return what the fit leaves of each record (n,), zero where nothing counts."""
    found = []
    for p in inverses:
        series = fit.series[p.motion.record.name]
        left = np.zeros(series.time.size)
        left[series.keep] = series.residual[series.keep]
        found.append(left)
    return found
