"""Modes of a frequency response: a sum of resonances behind a delay, fitted one after another.

    a/u = exp(-s T) sum_k (r_k s^2 + p_k s)/(s^2 + 2 z_k w_k s + w_k^2) + c

Friction at reversals adds to the damping of a mode: sweep slowly at a constant speed while the drive shakes.
The first is the body on its bearing (presliding stiffness and viscous friction, or nothing); c stands for modes above the
band. Poles and delay are searched, residues and c solved for (variable projection); a mode starts where one would take
away most, and stays where it takes away a share and the Bayesian information criterion says that it earns its numbers.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from workbench.errors import WorkbenchError
from workbench.threads import one_thread

if TYPE_CHECKING:
    from workbench.frequency.response import Response

COHERENT = 0.5  # coherence from which on a line counts
MODEL = 0.01  # share of |H| that the model may be wrong by at a line, however sure the line is
MOST = 6  # modes at most
STARTS = (0.005, 0.02, 0.06, 0.2)  # damping ratios of starts
RISES = 1.25  # factor by which a mode must rise above the rest of the response to be one
SURE = 0.5  # half width of its damping's interval over its damping, at most
LARGEST = 0.5  # damping ratio above which a resonance is no mode but a slope
NORMAL = 1.96
PARAMETERS = 4  # of a mode: pole and residue
LINES = 8  # that a fit needs
WORTH = 0.2  # of what is left that a further mode must take away: neighbouring lines share errors, and noise looks like modes
ROUNDS = 60  # of a search, at most


@dataclass(frozen=True)
class Mode:
    """frequency Hz, damping ratio, each with the half width of its 95 % interval. rise: peak over the rest of the response."""

    frequency: float
    frequency_half: float
    damping: float
    damping_half: float
    rise: float


@dataclass(frozen=True, eq=False)
class Modes:
    """modes by frequency. poles (k, 2): w, z, the body's first. residues (2 k + 1,): r, p of each, and c. delay: s.

    misfit: rms of what is left over its standard deviation; 1 is noise alone.
    """

    modes: tuple[Mode, ...]
    poles: np.ndarray
    residues: np.ndarray
    delay: float
    misfit: float

    def at(self, frequency: np.ndarray) -> np.ndarray:
        """Return acceleration over drive at frequency (n,) Hz."""
        omega = 2 * np.pi * np.asarray(frequency, dtype=float)
        return _columns(omega, self.poles) @ self.residues * np.exp(-1j * omega * self.delay)

    @property
    def system(self):
        """Position over drive without the delay, as python-control's TransferFunction."""
        import control

        s2 = np.array([1.0, 0.0, 0.0])
        total = control.TransferFunction([self.residues[-1]], s2)
        for (w, z), (r, p) in zip(self.poles, self.residues[:-1].reshape(-1, 2), strict=True):
            # (r s^2 + p s)/(s^2 D) = (r + p/s)/D
            total += control.TransferFunction([r, p], [1.0, 2 * z * w, w**2, 0.0])
        return total


def _columns(omega: np.ndarray, poles: np.ndarray) -> np.ndarray:
    """Return (n, 2 k + 1): s^2/D and w s/D of each pole, and one."""
    s = 1j * omega[:, None]
    w, z = poles[:, 0], poles[:, 1]
    d = s**2 + 2 * z * w * s + w**2
    both = np.stack([s**2 / d, s / d], axis=2).reshape(omega.size, -1)
    return np.concatenate([both, np.ones((omega.size, 1))], axis=1)


class Fitting:
    """Weighted least squares of one response; theta = [log w, log z of each pole, delay in units of 1/omega[-1]]."""

    def __init__(self, response: "Response"):
        self.spread = 2 * np.pi * response.spread
        self.omega, self.value, self.resolution = response.omega, response.value, response.resolution
        self.weight = 1.0 / np.hypot(response.deviation, MODEL * np.abs(response.value))

    def poles(self, theta: np.ndarray) -> np.ndarray:
        return np.exp(theta[:-1]).reshape(-1, 2)

    def delay(self, theta: np.ndarray) -> float:
        return float(theta[-1] / self.omega[-1])

    def weighted(self, theta: np.ndarray, poles: np.ndarray) -> np.ndarray:
        """Return the columns of some poles, behind the delay of theta, as real and imaginary parts, (2 n, 2 k + 1)."""
        a = 0.0
        for side in (-self.spread, self.spread) if self.spread else (0.0,):
            omega = self.omega + side
            a = a + _columns(omega, poles) * np.exp(-1j * omega * self.delay(theta))[:, None]
        a = a * (self.weight / (2.0 if self.spread else 1.0))[:, None]
        return np.concatenate([a.real, a.imag])

    def solved(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (residues, weighted residual (2 n,) as real and imaginary parts)."""
        a, y = self.weighted(theta, self.poles(theta)), self.value * self.weight
        y = np.concatenate([y.real, y.imag])
        norms = np.linalg.norm(a, axis=0)
        q, r = np.linalg.qr(a / norms)
        residues = np.linalg.lstsq(r, q.T @ y, rcond=1e-10)[0] / norms
        return residues, y - a @ residues

    def narrowest(self, omega: np.ndarray) -> np.ndarray:
        """Return the damping ratio of a resonance as wide as the response's resolution: no narrower one can be told."""
        return np.clip(np.pi * self.resolution / omega, 1e-4, 0.9)

    def refined(self, theta: np.ndarray):
        """Return SciPy's solution from a start, poles within the band and a decade below it."""
        from scipy.optimize import least_squares

        k = (theta.size - 1) // 2
        low = np.tile(np.log([0.05 * self.omega[0], 1e-4]), k)
        low[1::2] = np.log(0.5 * self.narrowest(np.exp(theta[:-1:2])))
        high = np.tile(np.log([1.1 * self.omega[-1], 10.0]), k)
        low, high = np.append(low, -3.0), np.append(high, 3.0)
        start = np.clip(theta, low + 1e-9, high - 1e-9)
        return least_squares(lambda x: self.solved(x)[1], start, bounds=(low, high), x_scale="jac", max_nfev=ROUNDS)

    def start(self, theta: np.ndarray) -> np.ndarray:
        """Return theta with one more pole, where its two columns take away most beside those that are there."""
        between = np.geomspace(self.omega[0], self.omega[-1], 150)
        options = np.array([(w, z) for w in between for z in STARTS if z >= self.narrowest(w)])
        there = self.weighted(theta, self.poles(theta))
        basis, _ = np.linalg.qr(there / np.linalg.norm(there, axis=0))
        left = self.solved(theta)[1]
        new = self.weighted(theta, options)[:, :-1]
        new -= basis @ (basis.T @ new)
        pairs = new.reshape(len(new), -1, 2)
        grams = np.einsum("nki,nkj->kij", pairs, pairs)
        moments = np.einsum("nki,n->ki", pairs, left)
        gains = np.einsum("ki,kij,kj->k", moments, np.linalg.pinv(grams, hermitian=True), moments)
        return np.insert(theta, -1, np.log(options[int(np.argmax(gains))]))


def _coherent(response: "Response") -> "Response":
    """Return the lines that count."""
    return response.where(response.coherence > COHERENT)


@one_thread
def fit_modes(response: "Response", most: int = MOST) -> Modes:
    """Return the modes of a frequency response. WorkbenchError where too few of its lines are coherent."""
    used = _coherent(response)
    if used.frequency.size < LINES:
        raise WorkbenchError(
            f"record '{response.record}': {used.frequency.size} lines of its frequency response have a coherence above "
            f"{COHERENT:g}, and modes need {LINES}; record a multisine or noise in the drive, on top of a slow motion."
        )
    fitting = Fitting(used)
    body = np.array([np.log(used.omega[0]), 0.0, 0.0])
    best = fitting.refined(body)
    for _ in range(most):
        more = fitting.refined(fitting.start(best.x))
        if more.cost > (1.0 - WORTH) * best.cost or _criterion(more, used) >= _criterion(best, used):
            break
        best = more
    return _said(fitting, best, used)


def _criterion(solution, used: "Response") -> float:
    """Return the Bayesian information criterion, of noise whose size the fit itself tells but never below what is stated."""
    count = 2 * used.frequency.size
    modes = (solution.x.size - 1) // 2
    power = max(2 * solution.cost / count, 1.0)
    return count * np.log(power) + 2 * solution.cost / power + PARAMETERS * modes * np.log(count)


def _said(fitting: Fitting, solution, used: "Response") -> Modes:
    """Return a solution as modes, with intervals widened where the fit leaves more than the noise."""
    theta, count = solution.x, 2 * used.frequency.size
    poles, (residues, left) = fitting.poles(theta), fitting.solved(theta)
    freedom = max(count - theta.size - residues.size, 1)
    misfit = float(np.sqrt(left @ left / freedom))
    covariance = np.linalg.pinv(solution.jac.T @ solution.jac) * max(misfit, 1.0) ** 2
    half = NORMAL * np.sqrt(np.diag(covariance))
    found = []
    for k, (w, z) in enumerate(poles):
        inside = used.omega[0] < w < used.omega[-1] and fitting.narrowest(w) < z < LARGEST
        above = _rise(poles, residues, k)
        if inside and half[2 * k + 1] < SURE and above > RISES:
            f = w / (2 * np.pi)
            found.append(Mode(f, f * half[2 * k], z, z * half[2 * k + 1], above))
    return Modes(tuple(sorted(found, key=lambda m: m.frequency)), poles, residues, fitting.delay(theta), misfit)


def _rise(poles: np.ndarray, residues: np.ndarray, k: int) -> float:
    """Return how far a mode's resonance rises above what the response would be there without it."""
    w = poles[k : k + 1, 0]
    each = _columns(w, poles)[0] * residues
    own = each[2 * k] + each[2 * k + 1]
    rest = each.sum() - own
    return float(abs(each.sum()) / max(abs(rest), 1e-300))
