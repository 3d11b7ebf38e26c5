"""What is said of a gain table: how much stiffer its notch makes it, and what its schedule is worth beside fewer numbers."""

from collections.abc import Mapping

from workbench.design.regret import Regret
from workbench.design.worth import behind
from workbench.finding import Finding


def stiffer(centre: float, depth: float, low: float, high: float) -> Finding:
    """Say how much stiffer a table is, at its ratios, than it might be without its notch.

    centre: Hz. depth: gain. low, high: least and most of Kp over that which |S| would allow without one.
    """
    sentence = (
        f"The table has a notch at {centre:.0f} Hz to {depth:.2g} behind its law: with its ratios Kp is {low:.2f} to "
        f"{high:.2f} times what |S| would allow without one. Gains without their notch keep no margin."
    )
    return Finding("notch", "schedule", sentence, {"least": low, "most": high})


def worth_sentence(ours: Regret, others: Mapping[str, Regret]) -> str:
    """Say what the schedule of the description is worth: its worst regret in time and error beside those of the rivals."""
    text = "; ".join(f"{n} {_worst(r)}" for n, r in others.items())
    said = f"The schedule of the description comes to {_worst(ours)}; by the same search, {text}."
    rest = [n for n, r in others.items() if not behind(r, ours)]
    if not rest:
        return (
            said
            + " So the description is worth its schedule: fewer levels take longer, leave more or overshoot on some move."
        )
    held = " and ".join(rest)
    return said + f" So against {held} the description's curve buys nothing here that shows in the worst move."


def _worst(r: Regret) -> str:
    time, error, over = r.worst
    if r.restless:
        return f"no rest on {r.restless} of {r.time.size} moves"
    return f"{time:.2f} in time, {error:.2f} in error, an overshoot of {100.0 * over:.1f} %"
