"""Parameters by output error: moved until the simulated drive of the records' loops is nearest to the measured one.

In a closed loop the drive is what the controller makes of the position error, so the drive alone holds both. The search
is Levenberg-Marquardt within the parameters' bounds; its Jacobian is two lanes of one simulation a parameter.

Source: Gautier, Janot and Vandanjon 2013, "A new closed-loop output error method for parameter identification of robot
dynamics"; Branch, Coleman and Li 1999 (trust region within bounds).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.control.law import Controller
from workbench.errors import WorkbenchError
from workbench.identification.bounded import scales
from workbench.identification.fit import fitted_on, seen
from workbench.identification.problem import LOGARITHMIC, Problem, to_search
from workbench.identification.result import Fit
from workbench.identification.solve import Solution
from workbench.inverse.dynamics import InverseDynamics
from workbench.inverse.side_by_side import stacked
from workbench.output_error.rerun import DRIVE, outputs
from workbench.parameter import Parameter
from workbench.plant import Plant
from workbench.simulation import Loop

STEP = 1e-2  # of a derivative, as a share of the drive: well above what an encoder's counts make of it
TOLERANCE = 1e-6  # relative decrease of the cost, and of the step, at which the search stops
MOST = 30  # evaluations


class Loops:
    """The drives of the records' loops as functions of the free parameters x: linear ones, then shape ones on their scale."""

    def __init__(self, problem: Problem, loop: Loop, controller: Controller):
        self.problem, self.loop, self.controller = problem, loop, controller
        self.parameters = [problem.parameter(n) for n in (*problem.free_linear, *problem.free_shape)]
        self.linear = len(problem.free_linear)
        measured = [self.stack(p, p.motion.u) for p in problem.inverses]
        self.measured = np.concatenate(measured)

    def stack(self, inverse: InverseDynamics, drive: np.ndarray) -> np.ndarray:
        """Return a record's drive (n,) or drives (n, m), filtered, at its equations: a load's balance holds none."""
        smooth = inverse.motion.filter(np.atleast_2d(drive.T))
        rows = inverse.rows(self.problem.plant)
        each = [stacked(np.stack([x, np.zeros_like(x)][:rows]), inverse.motion.keep) for x in smooth]
        return each[0] if drive.ndim == 1 else np.stack(each, axis=1)

    def start(self) -> np.ndarray:
        values = [p.value for p in self.parameters[: self.linear]]
        return np.array([*values, *map(to_search, self.parameters[self.linear :])])

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds of x."""
        return tuple(
            np.array(
                [self.searched(k, p, value) for k, (p, value) in enumerate(zip(self.parameters, side, strict=True))]
            )
            for side in ([p.lower for p in self.parameters], [p.upper for p in self.parameters])
        )

    def searched(self, k: int, p: Parameter, value: float) -> float:
        if k < self.linear or p.scale not in LOGARITHMIC:
            return value
        return float(np.log(value)) if value > 0.0 else -np.inf

    def plant(self, x: np.ndarray) -> Plant:
        return self.problem.with_linear(self.problem.with_shape(x[self.linear :]), x[: self.linear])

    def drives(self, points: Sequence[np.ndarray]) -> np.ndarray:
        """Return the filtered drives (N, points), infinite where a loop is unstable."""
        plants = [self.plant(x) for x in points]
        found = []
        for p in self.problem.inverses:
            rows, finite = outputs(plants, p.motion, self.loop, self.controller)
            found.append(np.where(finite, self.stack(p, np.where(finite, rows[DRIVE], 0.0)), np.inf))
        return np.concatenate(found)

    def steps(self, x: np.ndarray) -> np.ndarray:
        """Return how far each parameter is moved for its derivative: as far as moves the required drive by STEP of it."""
        y, phi = self.problem.assemble(x[self.linear :])
        size = STEP * np.linalg.norm(y)
        shape = self.problem.tangents(x[self.linear :], x[: self.linear], y, phi)
        norms = np.concatenate([scales(phi), scales(shape)])
        largest = np.where([k >= self.linear for k in range(x.size)], STEP, np.inf)
        return np.minimum(size / norms, largest * np.maximum(np.abs(x), 1.0))

    def slopes(self, x: np.ndarray, steps: np.ndarray) -> np.ndarray:
        """Return d drives/d x (N, parameters), by central differences within the bounds."""
        if not x.size:
            return np.zeros((self.measured.size, 0))
        lower, upper = self.bounds()
        ahead, behind = np.minimum(x + steps, upper), np.maximum(x - steps, lower)
        points = []
        for k in range(x.size):
            for end in (ahead, behind):
                points.append(np.where(np.arange(x.size) == k, end, x))
        drives = self.drives(points)
        return (drives[:, 0::2] - drives[:, 1::2]) / (ahead - behind)


def refine(plant: Plant, inverses: Sequence[InverseDynamics], loop: Loop, controller: Controller) -> Fit:
    """Return the Fit of `plant` to the identification records by output error, from the plant's own values.

    Start from `identify(...).plant`: the search is local. Of the Fit, values, intervals and findings are those of the
    output error; predictions and errors are, as in every Fit, those of the drive that the measured motion needs; details:
    "output_error", the relative error of the simulated drive before and after. Records, loop and controller as for
    `rerun`. Raises WorkbenchError as it does.
    """
    problem = Problem(plant, fitted_on(inverses))
    loops = Loops(problem, loop, controller)
    x, first, steps = nearest_to_measured(loops)
    drive, slopes = loops.drives([x])[:, 0], loops.slopes(x, steps)
    fit = seen(problem, _solution(loops, x, drive, slopes), inverses)
    whole = np.linalg.norm(loops.measured)
    errors = [float(np.linalg.norm(loops.measured - u) / whole) for u in (first, drive)]
    return replace(fit, details={**fit.details, "output_error": tuple(errors)})


def nearest_to_measured(loops: Loops) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (x where what is simulated is nearest to what was measured, what is simulated at the start, steps of x)."""
    from scipy.optimize import least_squares

    x = loops.start()
    first = loops.drives([x])[:, 0]
    if not np.isfinite(first).all():
        raise WorkbenchError(
            "the records' loops go to infinity with the plant from which the search would start; identify it first, and "
            "compare the sign of the drive, the units of the gains and the delay with those of the bench."
        )
    steps = loops.steps(x)
    if x.size:
        x = least_squares(
            lambda x: loops.measured - loops.drives([x])[:, 0], x, lambda x: -loops.slopes(x, steps),
            bounds=loops.bounds(), x_scale=steps / STEP, ftol=TOLERANCE, xtol=TOLERANCE, max_nfev=MOST,
        ).x  # fmt: skip
    return x, first, steps


def _solution(loops: Loops, x: np.ndarray, drive: np.ndarray, slopes: np.ndarray) -> Solution:
    """The least squares about x, as that of every other fit: columns are the slopes, and the residual is the output error."""
    m = loops.linear
    c, phi, residual = x[:m], slopes[:, :m], loops.measured - drive
    return Solution(x[m:], c, residual + phi @ c, phi, float(residual @ residual), lambda: slopes[:, m:])
