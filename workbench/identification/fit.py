"""Fit a plant to identification records, and see it on all records."""

from collections.abc import Sequence

import numpy as np

from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.identification import intervals, wording
from workbench.identification.by_record import own_estimates, spread
from workbench.identification.disagreement import disagreements
from workbench.identification.excitation import unexcited
from workbench.identification.problem import Problem
from workbench.identification.result import Fit, Series, Squares
from workbench.identification.solve import ITERATIONS, TOLERANCE, NoValue, Solution, solve
from workbench.inverse import prehistory
from workbench.inverse.balances import predicted
from workbench.inverse.dynamics import InverseDynamics
from workbench.inverse.wording import state_at_start, zeros_apart
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, ROLES, VALIDATION
from workbench.threads import one_thread


def fitted_on(inverses: Sequence[InverseDynamics]) -> list[InverseDynamics]:
    """Return the identification records among `inverses`, by name: in whatever order given, sums have the same last bits."""
    chosen = [p for p in inverses if p.motion.record.role == IDENTIFICATION]
    return sorted(chosen, key=lambda p: p.motion.record.name)


@one_thread
def identify(
    plant: Plant, inverses: Sequence[InverseDynamics], theta: np.ndarray | None = None, *, solved: bool = False
) -> Fit:
    """Fit `plant` on the identification records among `inverses` and evaluate it on all of them.

    theta: start of the free shape parameters on their search scale; the plant's values where absent. solved: that is where
    their search has ended before.
    """
    most = 0 if solved else ITERATIONS
    try:
        problem, solution, inverses = _begun(plant, inverses, theta, most)
    except NoValue:
        names = ", ".join(e.name for e in plant.effects if e.shape)
        raise WorkbenchError(
            f"one of the effects {names} has no value on these records with its declared parameters; check them and their units."
        ) from None
    return seen(problem, solution, inverses)


def end_of_search(
    plant: Plant, whole: Sequence[InverseDynamics], tolerance: float = TOLERANCE, most: int = ITERATIONS
) -> np.ndarray | None:
    """Return where the search for the shape parameters of a plant ends, on their search scale; None where it has no value on the records.

    tolerance, most: as of `solve`.
    """
    try:
        return solve(Problem(plant, whole), None, tolerance, most=most).theta
    except NoValue:
        return None


def _begun(plant: Plant, inverses: Sequence[InverseDynamics], theta: np.ndarray | None, most: int):
    """Return (problem, solution, inverses) with the starts of the records found beside the parameters, where they are open.

    Those that were found before stay where others leave no less; of records that are not fitted, by what is found at last.
    """

    def on(records: Sequence[InverseDynamics], theta: np.ndarray | None) -> tuple[Problem, Solution]:
        problem = Problem(plant, records)
        return problem, solve(problem, theta, most=most)

    def again(fit: tuple[Problem, Solution]) -> tuple[Problem, Solution] | None:
        problem, solution = fit
        found = prehistory.begun(problem.at(solution.theta, solution.c), problem.inverses)
        return None if found is None else on(found, solution.theta)

    problem, solution = prehistory.by_turns(on(fitted_on(inverses), theta), again, lambda fit: fit[1].cost)
    others = [p for p in inverses if p.motion.record.role != IDENTIFICATION]
    seen = prehistory.begun(problem.at(solution.theta, solution.c), others) or others
    known = dict(zip(map(id, others), seen, strict=True))
    return problem, solution, with_fitted([known.get(id(p), p) for p in inverses], problem.inverses)


def with_fitted(inverses: Sequence[InverseDynamics], found: Sequence[InverseDynamics]) -> list[InverseDynamics]:
    """Return `inverses` with others for their identification records. found: in the order of `fitted_on`."""
    known = dict(zip(map(id, fitted_on(inverses)), found, strict=True))
    return [known.get(id(p), p) for p in inverses]


def series_of(plant: Plant, inverse: InverseDynamics) -> tuple[Series, np.ndarray]:
    """Return one record seen through the evaluation filter, and the unfiltered prediction (n,)."""
    m = inverse.motion
    prediction = predicted(inverse, plant)
    both = m.filter(np.stack([m.u, prediction]))
    series = Series(
        m.record.name,
        m.record.role,
        m.t,
        m.q,
        m.v,
        both[0],
        both[1],
        m.keep,
        None if inverse.counts is None else inverse.counts[0],
    )
    return series, prediction


def _of_a_curve(f: Finding, plant: Plant) -> bool:
    """Whether a finding is of nothing but what a curve is at its knots: that is one law, which its band judges, and not twenty parameters."""
    curves = {e.key for e in plant.effects if e.knots}
    return {subject.rpartition(".")[0] for subject in f.subject.split(", ")} <= curves


def seen(problem: Problem, solution: Solution, inverses: Sequence[InverseDynamics]) -> Fit:
    """Return the Fit of a solved problem."""
    plant = problem.at(solution.theta, solution.c)
    names, cov, t, condition = intervals.covariance(problem, solution)
    estimates = intervals.estimates(plant, names, cov, t)
    linear = [n for n in names if n in problem.free_linear]
    owns = own_estimates(problem, solution, linear)
    apart = spread(plant, linear, owns)
    noise = float(np.sqrt(np.mean(solution.residual**2)))
    series, predictions = {}, {}
    for p in inverses:
        series[p.motion.record.name], predictions[p.motion.record.name] = series_of(plant, p)
    squares = {name: s.squares for name, s in sorted(series.items())}
    of_role = {r: sum((squares[n] for n in squares if series[n].role == r), Squares()) for r in ROLES}
    # a cause before what it causes: what is not excited is not determined
    half = dict(zip(names, t * np.sqrt(np.maximum(np.diag(cov), 0.0)), strict=True))
    said = [wording.unexcited(one) for one in unexcited(problem, solution, half, noise)]
    said += [wording.disagreement(one) for one in disagreements(problem, plant, linear, owns)]
    said += wording.undetermined(problem, estimates, names, cov)
    said = [f for f in said if not _of_a_curve(f, plant)]
    for told in (zeros_apart, state_at_start):
        said += told([p.motion.record for p in inverses], plant.displacement)
    return Fit(
        plant=plant,
        estimates=estimates,
        identification=of_role[IDENTIFICATION].nrmse,
        validation=of_role[VALIDATION].nrmse,
        nrmse={name: s.nrmse for name, s in squares.items()},
        rms={r: s.rms for r, s in of_role.items()},
        series=series,
        predictions=predictions,
        findings=tuple(said),
        condition=condition,
        details={"theta": solution.theta, "cost": solution.cost, "covariance": (names, cov, t)},
        spread=apart,
    )
