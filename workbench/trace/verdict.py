"""What a trace comes to: verdict, causes and findings as sentences, and where an unexplained residual lives."""

from collections.abc import Sequence

import numpy as np

from workbench.effect import find
from workbench.finding import Finding, capital, title
from workbench.identify.passes import Passes
from workbench.identify.result import Fit
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.trace.candidates import ADDITION
from workbench.trace.result import CAUSE, UNKNOWN, Candidate, Cause

ABOVE_FLOOR = 2.0  # residual over floor at which something is plainly left that no candidate explains


def plainly_left(fit: Fit, floor) -> bool:
    """Whether something is left far above the noise floor that no candidate explains."""
    least = floor[IDENTIFICATION]
    return bool(least > 0 and fit.identification > ABOVE_FLOOR * least)


def _share(before: float, after: float) -> float:
    return 1.0 - (after / before) ** 2 if before > 0 else 0.0


def cause(candidate: Candidate, before: Fit, here: Fit, last: Fit) -> Cause:
    """Return the cause that a candidate became: its share from `before` to `here`, its parameters from the last fit."""
    effect = find(candidate.effect.partition(" ")[0])  # without its label
    estimates = tuple(e for e in last.estimates if (e.effect, e.at) == (candidate.effect, candidate.at))
    identification = _share(before.rms[IDENTIFICATION], here.rms[IDENTIFICATION])
    validation = _share(before.rms[VALIDATION], here.rms[VALIDATION])
    verb = "is declared with a wrong value" if candidate.kind != ADDITION else "is missing"
    sentence = (
        f"{capital(title(candidate.effect))} at the {candidate.at} {verb}: {effect.cause}. It explains "
        f"{100 * identification:.1f} % of the residual power on the identification records and {100 * validation:.1f} % "
        "on the validation record."
    )
    return Cause(candidate.effect, candidate.at, sentence, estimates, identification, validation)


def not_carried(causes: Sequence[Cause]):
    """Yield a finding for each cause that explains much less on validation than on identification."""
    for c in causes:
        if c.share_validation < 0.5 * c.share_identification:
            yield Finding(
                "not carried over", c.effect,
                f"{capital(title(c.effect))} explains {100 * c.share_identification:.0f} % on identification but only "
                f"{100 * c.share_validation:.0f} % on validation; do not rely on it before a second validation record.",
                {"identification": c.share_identification, "validation": c.share_validation},
            )  # fmt: skip


def verdict_sentence(verdict: str, causes: Sequence[Cause], before: Fit, after: Fit, floor) -> str:
    """Return the verdict as a person reads it, with the errors before and after."""
    if verdict == CAUSE:
        names = " and ".join(title(c.effect) for c in causes)
        is_are = "is" if len(causes) == 1 else "are"
        what = "missing" if len(causes) > 1 or "missing" in causes[0].sentence else "declared with a wrong value"
        return (
            f"{capital(names)} {is_are} {what}. With {'it' if len(causes) == 1 else 'them'}, the validation error falls from "
            f"{100 * before.validation:.2f} % to {100 * after.validation:.2f} % and the identification error from "
            f"{100 * before.identification:.2f} % to {100 * after.identification:.2f} % "
            f"(noise floor {100 * floor[IDENTIFICATION]:.2g} %)."
        )
    if verdict == UNKNOWN:
        return (
            f"Something is missing that no effect of the catalogue explains: the residual is "
            f"{before.identification / floor[IDENTIFICATION]:.1f} times the noise floor, and no candidate earns its place."
        )
    return (
        f"Nothing is missing: the residual, {100 * before.identification:.2f} % on identification, is "
        f"{before.identification / floor[IDENTIFICATION]:.2f} times the noise floor, and no effect of the catalogue "
        "explains a share of it that holds on held-out blocks."
        if floor[IDENTIFICATION] > 0
        else "Nothing is missing: no effect of the catalogue explains a share of the residual that holds on held-out blocks."
    )


def where(passes: Sequence[Passes], residuals: Sequence[np.ndarray]) -> dict[str, object]:
    """The coordinate in which the residual's power is most concentrated, in ten bins of equal population each."""
    signals = {"position": [], "velocity": [], "time": []}
    power = []
    for p, r in zip(passes, residuals, strict=True):
        m, keep = p.motion, p.motion.keep
        for name, values in (("position", m.q), ("velocity", m.v), ("time", m.t)):
            signals[name].append(values[keep])
        power.append(r[keep] ** 2)
    power = np.concatenate(power)
    best = {}
    for name, parts in signals.items():
        values = np.concatenate(parts)
        edges = np.quantile(values, np.linspace(0, 1, 11))
        index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, 9)
        shares = np.bincount(index, weights=power, minlength=10) / power.sum()
        k = int(np.argmax(shares))
        if shares[k] > best.get("share", 0.0):
            best = {"coordinate": name, "low": float(edges[k]), "high": float(edges[k + 1]), "share": float(shares[k])}
    return best
