"""What is said of the gains that hunt."""

from workbench.finding import Finding
from workbench.limit_cycle.gain_region import Region

KIND = "limit cycle"


def hunting(name: str, r: Region) -> Finding:
    """Say whether a controller hunts as it is tuned, and whether the prediction holds over the region."""
    at, figures = r.as_tuned, r.figures
    hunts = f"hunts at {r.omega[at]:.0f} rad/s" if r.exists[at] else "does not hunt"
    wrong, cases = int(figures["limit_cycle_wrong"]), int(figures["limit_cycle_cases"])
    agreed = "in all of them" if not wrong else f"in all but {wrong}"
    sentence = (
        f"With its {r.dials.first} times {r.first[at[0]]:.2g} and {r.dials.second} times {r.second[at[1]]:.2g}, {name} {hunts}. "
        f"Of {r.exists.size} cases {int(r.exists.sum())} hunt in simulation; in {cases} the third harmonic is at most 5 % and "
        f"the cycle above ten encoder counts, and {agreed} harmonic balance says rightly whether there is a limit cycle, its frequency within "
        f"{100 * figures['limit_cycle_frequency_error']:.2g} %."
    )
    return Finding(KIND, name, sentence, figures)
