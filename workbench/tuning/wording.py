"""What is said of gains that do not keep all of a goal."""

import numpy as np

from workbench.finding import CONSTRAINT_DROPPED, RESPONSE_LIMITS, SENSITIVITY_EXCEEDED, UNSTABLE, Finding

NOT_CONVERGED = "not converged"
# what verification asks of gains -> what is wrong with them, and what would mend it
WRONG = {
    UNSTABLE: (
        "the sampled loop is unstable (largest modulus of its eigenvalues)",
        "State a sensitivity limit: the linear axis in continuous time knows neither delay nor sampling.",
    ),
    SENSITIVITY_EXCEEDED: (
        "the sensitivity peak exceeds {limit:g}",
        "Report it with the axis: the program should have kept this limit.",
    ),
    NOT_CONVERGED: (
        "the program stopped before its tolerance",
        "Compare with the gains of neighbouring amplitudes.",
    ),
}


def dropped(lost: np.ndarray, best: np.ndarray, amplitudes: int, bound: float) -> Finding:
    """Say at which of so many amplitudes no gains keep the error. lost (n,), rad or m; best (n,): the least error there, of the step."""
    i = int(best.argmax())
    sentence = (
        f"At {lost.size} of {amplitudes} amplitudes ({lost[0]:.3g} to {lost[-1]:.3g}) no gains keep the error below {bound:.1%} of the step; "
        f"the best is {best[i]:.1%} at {lost[i]:.3g}. The bound was dropped there, and the gains are the fastest."
    )
    evidence = {"amplitudes": float(lost.size), "bound": bound, "best": float(best[i])}
    remedy = "Sample faster, delay less, or let an integrator remove the error."
    return Finding(CONSTRAINT_DROPPED, "error", sentence, evidence, remedy)


def doubted(kind: str, wrong: np.ndarray, size: np.ndarray, amplitude: np.ndarray, limit: float) -> Finding:
    """Say where gains are wrong in one of the ways of WRONG. wrong (n,): whether; size (n,): how far; amplitude (n,), rad or m."""
    i = int(np.argmax(np.where(wrong, size, -np.inf)))
    text, remedy = WRONG[kind]
    sentence = f"At {int(wrong.sum())} of {wrong.size} amplitudes {text.format(limit=limit)}: {size[i]:.4g} at {amplitude[i]:.3g}."
    return Finding(kind, "gains", sentence, {"worst": float(size[i]), "amplitude": float(amplitude[i])}, remedy)


def limited(record: str, share: np.ndarray, amplitude: np.ndarray) -> Finding:
    """Say where a record's frequency response allows less. share (n,): of Kp, over what the model alone would have; infinite where it is not capped."""
    capped = np.isfinite(share)
    i = int(share.argmin())
    sentence = (
        f"At {int(capped.sum())} of {capped.size} amplitudes the frequency response of record '{record}' allows less "
        f"than the model of one mass: at {amplitude[i]:.3g} Kp is {share[i]:.0%} of what it would be."
    )
    evidence = {"amplitudes": float(capped.sum()), "share": float(share[i])}
    return Finding(
        RESPONSE_LIMITS, "gains", sentence, evidence, "Put a notch on the mode, delay less, or stiffen the joint."
    )
