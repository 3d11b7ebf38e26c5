"""What a study of measured records shows for the effects that its trace added, and against those that it did not."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np

from workbench.definition import Effect
from workbench.finding import capital, title
from workbench.identification.fit import fitted_on, identify
from workbench.identification.result import Fit
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, ROLES, VALIDATION
from workbench.report.contents import Table
from workbench.residual.repeats import between, repeats
from workbench.tracing.result import Trace
from workbench.tracing.tracing import trace

Say = Callable[[str], None]


def percent(value: float) -> str:
    return f"{100 * value:.2f} %"


@dataclass(frozen=True)
class Step:
    """One effect that a trace added: its held-out gain with one standard error, and the errors from then on."""

    effect: str
    gain: float
    scatter: float
    identification: float
    validation: float


def steps(found: Trace) -> tuple[Step, ...]:
    """Return the steps of a trace. Errors follow from the shares of the residual's power, which telescope.

    A gain is that of the step in which the effect was added; NaN where it came in when others were asked again.
    """
    result, left = [], dict.fromkeys(ROLES, 1.0)
    nothing = SimpleNamespace(gain=float("nan"), scatter=float("nan"))
    for cause in found.causes:
        leaders = (ranked[0] for ranked in found.steps if ranked)
        one = next((c for c in leaders if (c.effect, c.at) == (cause.effect, cause.at)), nothing)
        left[IDENTIFICATION] *= 1.0 - cause.share_identification
        left[VALIDATION] *= 1.0 - cause.share_validation
        errors = [getattr(found.before, role) * float(np.sqrt(left[role])) for role in ROLES]
        result.append(Step(cause.effect, one.gain, one.scatter, *errors))
    return tuple(result)


def steps_table(found: Trace) -> Table:
    """Return the evidence for each added effect as a table."""
    rows = [("as declared", "", percent(found.before.identification), percent(found.before.validation))]
    for s in steps(found):
        gain = f"{100 * s.gain:.1f} ± {100 * s.scatter:.1f} %"
        rows.append((f"and {title(s.effect)}", gain, percent(s.identification), percent(s.validation)))
    return Table(
        ("Model", "Held-out gain", "Identification error", "Validation error"),
        tuple(rows),
        "Effects in the order in which the trace added them. Held-out gain: share of the residual's power taken away on "
        "blocks of the identification record that the fit did not see, with one standard error. The choice was made by it "
        "alone; the validation error was only looked at.",
        "prrr",
    )


@dataclass(frozen=True)
class Tried:
    """A hypothesis beside a model: its held-out gain with one standard error, and the errors with it."""

    hypothesis: str
    effect: str
    gain: float
    scatter: float
    identification: float
    validation: float


def tried(
    plant: Plant, passes: Sequence[InverseDynamics], hypotheses: Mapping[str, Effect], say: Say = lambda _: None
) -> tuple[Tried, ...]:
    """Return what each hypothesis (its words -> effect) comes to when it alone is added to `plant`.

    An effect that the trace offers anyway may be given with a label, so that it is judged with the values it carries.
    """
    own = {e.named: e for e in hypotheses.values()}
    ranked = {c.effect: c for c in trace(plant, passes, say, most=1, only=tuple(own), own=tuple(own.values())).ranked}
    result = []
    for words, e in hypotheses.items():
        fit = identify(plant + e, passes)
        one = ranked[e.named]
        result.append(Tried(words, e.named, one.gain, one.scatter, fit.identification, fit.validation))
    return tuple(result)


def tried_table(results: Sequence[Tried], beside: Fit) -> Table:
    """Return hypotheses as a table, each with whether it holds on held-out blocks and on the validation record."""
    rows = [("the traced model", "", percent(beside.identification), percent(beside.validation), "")]
    for r in results:
        lower = r.validation < beside.validation
        verdict = ("carries over" if lower else "does not carry over") if r.gain > 3.0 * r.scatter else "not borne out"
        gain = f"{100 * r.gain:.1f} ± {100 * r.scatter:.1f} %"
        rows.append((capital(r.hypothesis), gain, percent(r.identification), percent(r.validation), verdict))
    return Table(
        ("With", "Held-out gain", "Identification error", "Validation error", "What the data say"),
        tuple(rows),
        "Each hypothesis alone beside the traced model. Not borne out: its held-out gain is within three standard errors of "
        "nothing.",
        "prrrl",
    )


@dataclass(frozen=True)
class Attainable:
    """Over the rms of the drive: what does not repeat within a record, by role, and between the two records."""

    within: Mapping[str, float]
    share: Mapping[str, float]
    across: float


def attainable(fit: Fit, passes: Sequence[InverseDynamics]) -> Attainable:
    """Return how far one identification and one validation record repeat themselves and each other, seen beside `fit`.

    `across` is what is left on the validation record by whoever takes what `fit` lacks from the identification record, as
    it was measured there in the same state.
    """
    found = {}
    for role in ROLES:
        m = next(p.motion for p in passes if p.motion.record.role == role)
        s = fit.series[m.record.name]
        found[role] = m, s.residual, float(np.sqrt(np.mean(s.measured[s.keep] ** 2)))
    each = {role: repeats(m, r) for role, (m, r, _) in found.items()}
    whole = {role: rms for role, (*_, rms) in found.items()}
    (one, first, _), (other, second, _) = (found[role] for role in ROLES)
    return Attainable(
        {role: each[role].rms / whole[role] for role in ROLES},
        {role: each[role].share for role in ROLES},
        between(one, first, other, second).rms / whole[VALIDATION],
    )


def refitted(plant: Plant, passes: Sequence[InverseDynamics]) -> dict[str, Fit]:
    """Return role -> fit of the same plant to the records of that role alone: what differs between them."""
    fits = {}
    for role in ROLES:
        turned = [
            InverseDynamics(replace(p.motion, record=replace(p.motion.record, role=IDENTIFICATION)))
            for p in passes
            if p.motion.record.role == role
        ]
        fits[role] = identify(plant, fitted_on(turned))
    return fits
