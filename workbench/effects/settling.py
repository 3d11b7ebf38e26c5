"""What goes over to another level, in time or as it warms up: r (1 - exp(-e t))/e, at first with the rate r, at last r/e; e -> 0 is a steady change.

In time it counts from an instant of the bench clock. Of a clock that stands at an hour when the first record begins, or at the seconds since 1970,
exp(-e t) is nothing, and all that changes would be one part in 1e16 of it.
"""

from workbench.effects.elementary import expm1, where
from workbench.parameter import Parameter

SLOWEST = 1e-5  # 1/s: over an hour 2 % from a steady change
SINCE = {"since": Parameter(0.0, "s", "bench clock from which it counts", fixed=True, scale="begin")}


def gone_over(rate, t, settling):
    """Return r (1 - exp(-e t))/e: what a rate has come to."""
    return -rate * expm1(-settling * t) / settling


def counted(t, since):
    """Return t - t0, and nothing before t0: there it has not begun."""
    return where(t > since, t - since, 0.0)


def going_over(unit: str, meaning: str, settling: float) -> dict[str, Parameter]:
    """Return both parameters. unit, meaning: of the rate; settling: start of e, 1/s."""
    return {
        "rate": Parameter(0.0, unit, meaning),
        "settling": Parameter(
            settling, "1/s", "rate at which the change settles", lower=SLOWEST, upper=10.0, scale="settling"
        ),
    }
