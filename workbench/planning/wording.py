"""What is said of a plan: what it promises of a parameter, why not more, and along which motion two effects part."""

from collections.abc import Sequence
from math import degrees

from workbench.definition import Effect
from workbench.finding import capital, located
from workbench.identification.result import Estimate
from workbench.planning import lack
from workbench.planning.lack import Lack


def prospect(e: Estimate, now: float, then: float, why: str, *, best: bool) -> str:
    """Return what is promised of a parameter. now, then: half widths, shares of its value. best: whether no less is promised of any."""
    value = f"{e.value:.3g}" + ("" if e.unit in ("1", "") else f" {e.unit}")
    promised = _per_cent(then) + (" or better" if best else "")
    text = f"{capital(located(e.effect, e.at))}, {e.meaning}: {value}, now known to {_per_cent(now)}, with this motion to {promised}"
    return f"{text}; {why}." if why else f"{text}."


def _per_cent(part: float) -> str:
    return f"{100 * part:.2g} %" if part < 0.995 else "no better than its size"


def why(found: Lack) -> str:
    """Return why a parameter is not determined as well as was asked for, as a clause."""
    return {
        lack.ABSENT: "the effect is zero as it is fitted, and what is not there has no shape and no share of itself",
        lack.DARK: "no motion within the limits shows it in the drive",
        lack.TOGETHER: f"{', '.join(found.others)} are known only together (correlation up to {found.correlation:.3f}) by any "
        "motion within the limits",
        lack.BELOW_NOISE: "its part in the drive stays below the noise along every motion within the limits",
        lack.LONGER: f"against this noise it would take {found.seconds:.0f} s of such motion",
    }[found.reason]


def shown_nowhere(a: Effect, b: Effect) -> str:
    """Return that neither of two effects shows along any motion."""
    return (
        f"Neither {located(a.named, a.at)} nor {located(b.named, b.at)} shows along any motion within the limits, with the "
        "values that explain the records beside the declared model."
    )


def not_apart(a: Effect, b: Effect, angle: float, deviations: float, *, some: bool) -> str:
    """Return that no motion tells two effects apart. angle: rad, of the best. some: whether there is a motion at all."""
    return (
        f"No motion of {'this length ' if some else ''}within the limits tells {located(a.named, a.at)} from "
        f"{located(b.named, b.at)}: the best leaves them {_distance(angle, deviations)} apart."
    )


def apart(a: Effect, b: Effect, angle: float, deviations: float, motion: str, silent: Sequence[Effect]) -> str:
    """Return along which motion two effects lie apart. angle: rad. motion: a phrase. silent: those that show nowhere themselves."""
    names = located(a.named, a.at), located(b.named, b.at)
    sentence = f"To tell {names[0]} from {names[1]}, {motion}: along it they lie {_distance(angle, deviations)} apart."
    for e in silent:
        sentence += (
            f" {capital(located(e.named, e.at))} itself shows nowhere, with the values that explain the records."
        )
    return sentence


def _distance(angle: float, deviations: float) -> str:
    return f"{degrees(angle):.2g} degrees and {deviations:.{0 if deviations > 10.0 else 1}f} standard deviations"
