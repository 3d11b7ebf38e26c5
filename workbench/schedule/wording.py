"""What is said of a schedule: how far it lies from the tuned gains, what it does between its knots, and whether it feeds energy in."""

from workbench.finding import SENSITIVITY_EXCEEDED, UNSTABLE, Finding

SUBJECT = "schedule"


def coarse(error: float, at: float, tolerance: float, knots: int, monotone: bool) -> Finding:
    """Say by how much gains between knots differ from the tuned ones. at: amplitude, SI. monotone: whether gains may not rise."""
    sentence = (
        f"Between {knots} knots the gains differ by up to {100 * error:.3g} % from the tuned ones, at an amplitude of {at:.3g} (SI); "
        f"{100 * tolerance:.3g} % was asked for."
    )
    remedy = "Use more knots an octave" + (", or allow gains that rise with amplitude." if monotone else ".")
    return Finding(
        "schedule", "interpolation", sentence, {"error": error, "amplitude": at, "tolerance": tolerance}, remedy
    )


def unstable(radius: float, at: float) -> Finding:
    """Say that an eigenvalue of this modulus is outside the unit circle at an amplitude, SI."""
    sentence = f"Under scheduled gains the linear axis is unstable at amplitude {at:.3g}: an eigenvalue of modulus {radius:.4g}."
    return Finding(UNSTABLE, SUBJECT, sentence, {"radius": radius, "amplitude": at}, "Use more knots an octave.")


def exceeded(peak: float, at: float, sensitivity: float) -> Finding:
    """Say that |S| has a higher peak at an amplitude, SI, than was tuned for."""
    sentence = f"Under scheduled gains the sensitivity peak is {peak:.3f} at amplitude {at:.3g}; {sensitivity:g} was tuned for."
    remedy = "Use more knots an octave, or tune for a lower sensitivity."
    return Finding(SENSITIVITY_EXCEEDED, SUBJECT, sentence, {"peak": peak, "amplitude": at}, remedy)


def passive(damping: float, pumping: float, at: float, *, moving: bool) -> Finding:
    """Say how much of the damping moving gains use up, at the amplitude (SI) where they use up most."""
    evidence = {"damping": damping, "pumping": pumping, "amplitude": at}
    share = pumping / damping
    text = f"{100 * share:.3g} % of it at an amplitude of {at:.3g} (SI)"
    if share >= 1.0:
        sentence = f"The gains feed in more than friction and Kd take out, {text}. A limit cycle is to be expected."
        remedy = "Freeze the gains between reversals, or bound their slope."
        return Finding("not passive", SUBJECT, sentence, evidence, remedy)
    sentence = f"Moving gains use up a part of the damping, at most {text}."
    return Finding(
        "passive",
        SUBJECT,
        sentence if moving else "Gains are frozen between reversals and feed no energy in.",
        evidence,
    )
