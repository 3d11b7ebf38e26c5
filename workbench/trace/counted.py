"""What an effect would explain of a machine that lacks nothing, for no reason but its encoders' counts.

Counts are noise in the motion, from which every column of the model is made, and least squares lean on a noisy column: an
inertia comes out too small, and setting a fixed one free explains a part of what the counts leave (errors in variables;
Fuller, Measurement Error Models, 1987). So the present model is made the machine: it moves between the counts, its drive is
what the model asks for, and its encoders read counts.
"""

from collections.abc import Sequence
from dataclasses import replace

from workbench.identify.passes import Passes, predicted
from workbench.identify.solve import NoValue
from workbench.motion import motion
from workbench.plant import Plant
from workbench.trace.candidates import Suspect
from workbench.trace.floor import read_again
from workbench.trace.result import Candidate
from workbench.trace.search import fitted, within_reach
from workbench.trace.state import State
from workbench.trace.thin import thin


def sound(passes: Sequence[Passes], plant: Plant) -> list[Passes]:
    """Return passes of the records that this plant would leave, without noise of the drive; none where counts are unknown."""
    found = []
    for p in passes:
        records = read_again(p)
        if records is None:
            return []
        band = p.motion.filter.bandwidth
        true, read = records
        drive = "torque" if "torque" in read.channels else "force"
        asked = predicted(Passes(motion(true, band)), plant)
        found.append(Passes(motion(replace(read, channels={**read.channels, drive: asked}), band)))
    return found


def of_counts(suspect: Suspect, state: State, whole: Sequence[Passes]) -> float:
    """Return the power that a suspect takes away of what counts alone leave of the drive, over that of the state's residual.

    whole: passes of the identification records as they are. 0 where nothing comes of it.
    """
    made = thin(sound(whole, state.plant))
    if not made:
        return 0.0
    try:
        alone = State(within_reach(state.plant, made), made)  # whose travel is not quite that of the records
        problem, solution = fitted(suspect, alone.problem, alone.solution, alone.residuals)
    except NoValue:
        return 0.0
    before, after = (
        sum(float(part @ part) for part in p.drive_part(s.residual))
        for p, s in ((alone.problem, alone.solution), (problem, solution))
    )
    return max(before - after, 0.0) / state.solution.cost if state.solution.cost > 0.0 else 0.0


def by_counts(c: Candidate, spurious: float) -> Candidate:
    """Return a candidate that does not earn its place, because of what it would take away of the counts alone."""
    more = (
        f" Of what counts alone would leave of a machine that lacks nothing it would take away {100 * spurious:.1f} %."
    )
    return replace(c, earns=False, sentence=c.sentence + more)
