"""What each effect that a trace added brought, in the order in which it was added."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from workbench.record import IDENTIFICATION, ROLES, VALIDATION
from workbench.tracing.result import Trace


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
