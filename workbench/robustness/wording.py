"""What is said of errors over many cases: who is the most robust by either perspective, and what share of axes exceeds a limit."""

from collections.abc import Mapping

import numpy as np

from workbench.finding import Finding
from workbench.robustness.perspective import EQUAL, Order, Perspectives, Share, orders

KIND = "robustness"
TITLES = {"first": "largest error", "second": "spread of errors"}


def ranking(found: Mapping[str, Perspectives], cases: str, unit: str) -> tuple[Finding, ...]:
    """Return, for each perspective, a finding that says which controller is the most robust, and whether they agree."""
    both = orders(found)
    said = [_by_perspective(name, order, cases, unit) for name, order in zip(TITLES, both, strict=True)]
    return (*said, _agreement(*(order.names[0] for order in both), cases)) if len(found) > 1 else tuple(said)


def _by_perspective(name: str, order: Order, cases: str, unit: str) -> Finding:
    first, last = order.names[0], order.names[-1]
    also = f", {' and '.join(order.ties)} within {100 * EQUAL:.0f} % of it" if order.ties else ""
    sentence = (
        f"By the {name} perspective, the {TITLES[name]} over {cases}, {first} is the most robust "
        f"({_error(order.values[first], unit)}{also}) and {last} the least ({_error(order.values[last], unit)})."
    )
    return Finding(KIND, f"{name} perspective", sentence, order.values)


def _agreement(first: str, second: str, cases: str) -> Finding:
    """first, second: who is the most robust by either perspective."""
    sentence = (
        f"Over {cases} both perspectives put {first} first."
        if first == second
        else f"Over {cases} the perspectives disagree: {first} has the smallest largest error, {second} the smallest spread."
    )
    return Finding(KIND, "both perspectives", sentence)


def _error(value: float, unit: str) -> str:
    if not np.isfinite(value):
        return "not at rest at the end"
    factor, prefix = (1e6, "µ") if value < 1e-3 else (1e3, "m")
    return f"{factor * value:.3g} {prefix}{unit}"


def statement(share: Share, what: str) -> str:
    """Return a Clopper-Pearson statement as a sentence. what: "a final error of 100 µrad"."""
    return (
        f"of axes drawn from the declared distributions at most {100 * share.upper:.3g} % exceed {what}, "
        f"{100 * share.confidence:.4g} % confidence ({share.exceeded} of {share.count} draws did)"
    )
