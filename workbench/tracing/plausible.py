"""Values that no machine has: a cause with such a value does not lead where a plausible one explains nearly as much."""

from collections.abc import Sequence

import numpy as np

from workbench.definition import Effect
from workbench.identification.intervals import on_bound
from workbench.inverse.bodies import POSITION, VELOCITY
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.tracing.discs import once_a_turn
from workbench.tracing.free_forms import MEMORY

LARGEST_ECCENTRICITY = 0.0175  # rad: a disc that reads a degree wrong would not have been mounted
# Slope of a wave in an angle or a scale: gears and discs stay below a few per cent. Of 232 axes one wave had 0.13, one 0.29, the others 0.04
# and less: halved, no change; doubled, one that dresses friction is believed
STEEPEST = 0.1
# Periods of a wave within the travel, below which it is not seen to return: a hose taut at one end of the stroke was a cogging of 1.7, a bath that
# a belt dips into, over a third of the stroke, friction of 1.5. Halved, they are again; doubled, two of 25 cyclic frictions that were missing (2.5
# and 2.8, others 4.4 and more) would be any curve; of thirteen cogging forces the travel held 5.2 and more
RETURNS = 2.0
# Order from which a wave is one of the axis' own turn, where the travel holds that: of friction that has three orders of a table's turn the first
# alone comes out at 0.94, over 1.07 turns. Doubled, it is any curve again; halved, it stays. An angle's wave of one turn is an encoder's, not a gear's
ONCE = 0.9
# The same beside a curve over place that was found before at that place: what its formula leaves of it is drawn by a wave of 2.1 periods (a dress
# pack that comes taut at both ends of a wrist's stroke). Halved, it is a cogging again; doubled, a cogging of five periods beside a cable is asked
# for a curve that says as much
BESIDE = 4.0
# Of the travel, that the reading of a position drifts within a record: mounts warm up by micrometres. Times the viscous friction a drift of
# ten times the travel is a constant force by another name. Halved or doubled, that one is implausible all the same; a right one had 3e-6
DRIFTS = 0.1
# A cable's force in the middle of the travel over its change along it, from which it is a constant force. Of six cables that were missing none
# had 0.3; a cylinder's rod, pushed out by 50 N that nobody declared, has 25: halved or doubled, neither changes
FAR = 10.0
# Presliding lengths that a body travels at least, where its friction is seen to slip: by then it has 95 % of its height, and what has not is a spring. Of
# fifteen memories that were found the largest had 0.14 of the travel (a contact that goes to and fro by 10 to 240 um), and a pendulum's gravity, that
# was called one, 0.9: halved or doubled, no change
SLIPS = 3.0
# Periods of a mode within the longest record, below which it is not seen to swing: what other joints of an arm ask of one was a mode of 13.5 s within
# half a minute, 2.4 periods. Modes that were missing had hundreds: halved or doubled, none of these changes
SWINGS = 5.0
FACTOR = 5.0  # by which a data-sheet value may be off before its unit is to be doubted; `check` allows as much
FRICTION = "friction over speed"
# parameters that may stand on their bound as a law of their own (a gap: no stiffness inside; a change that has not begun to settle; all of
# the inertia behind a contact, or none); so may an exponent at 1, which is a straight line
STANDS = ("k1", "settling", "share")


def implausible(effect: Effect, plant: Plant, declared: Plant, inverses: Sequence[InverseDynamics]) -> str:
    """Return why an effect's values are no machine's, as part of a sentence, or "".

    plant: solved, holds the effect. declared: what a corrected value was before.
    """
    for name, p in effect.parameters.items():
        if p.fixed:
            continue
        reach = _reach(effect.at, plant, inverses) if p.scale == "stroke" else np.inf
        if p.value > reach:
            way = "the joint's deflection" if effect.at == "joint" else "the travel"
            return f"its {p.meaning} of {p.value:.3g} is longer than {way} of {reach:.3g}"
        if _length(effect, name) and p.value * SLIPS > reach:
            return f"with its {p.meaning} of {p.value:.3g} it hardly slips along the travel of {reach:.3g}"
        bounded = p.upper - p.lower > 0.0 and (p.value != 0.0 or name in effect.linear)
        straight = name == "exponent" and p.lower == 1.0 and p.value < 0.5 * (p.lower + p.upper)
        if bounded and not straight and name not in STANDS and on_bound(p.value, p.lower, p.upper):
            if name in effect.linear and len(effect.linear) > 1:
                continue  # one part of it is not needed
            return f"its {p.meaning} stands on its bound"
    if effect.name in ("encoder_eccentricity", "kinematic_error"):
        values = effect.outside
        size = values["amplitude"].value
        if effect.name == "encoder_eccentricity" and size > LARGEST_ECCENTRICITY:
            return "an eccentricity of degrees would not have been mounted"
        if (read := _read_wrong(effect, plant)) > LARGEST_ECCENTRICITY:
            return f"its disc would read {np.degrees(read):.2g} degrees wrong, and would not have been mounted"
        if effect.name == "kinematic_error" and size * values["order"].value > STEEPEST:
            return f"with it the axis would run {100 * size * values['order'].value:.0f} % too fast in places"
        if effect.name == "kinematic_error" and not (returns(effect, inverses) or once_a_turn(effect, plant)):
            return f"the travel holds fewer than {RETURNS:g} of its periods, and does not show it to return"
    if effect.family == "mode" and (slow := _slow(effect, inverses)):
        return slow
    if effect.name == "cable_spring" and (far := _far(effect, inverses)) > FAR:
        return f"its force hardly changes along the travel: it is relaxed {far:.0f} travels away"
    if effect.family == FRICTION and "passive" not in effect.holds and _power(effect.at, plant, inverses) < 0.0:
        return "with it friction would drive the axis instead of braking it"
    if effect.name == "piecewise_stiffness" and _outer(effect, plant) < 0.0:
        return "beyond its threshold it would drive the axis away instead of holding it"
    if effect.at.startswith("sensor.") and "rate" in effect.parameters and (share := _drift(effect, inverses)) > DRIFTS:
        return f"with it the reading would drift by {100 * share:.0f} % of the travel within a record"
    known = {e.key: e for e in declared.effects}
    if effect.key in known:
        for name, p in known[effect.key].parameters.items():
            new = effect.parameters[name].value
            if p.fixed and p.value != 0.0 and not 1.0 / FACTOR < new / p.value < FACTOR:
                return f"its {p.meaning} would be {new / p.value:.3g} times the declared value"
    return ""


def _read_wrong(wave: Effect, plant: Plant) -> float:
    """Return by how much, rad, the waves of a reading are off together where one of them is its disc's; 0 elsewhere. A crank's inertia is an eccentric
    encoder to the search, of a wave for each of its harmonics."""
    here = [e for e in plant.effects if e.at == wave.at and "amplitude" in e.outside and wave.at.startswith("sensor.")]
    if not any(e.harmonic for e in here):
        return 0.0
    return sum(e.outside["amplitude"].value for e in here)


def _length(effect: Effect, name: str) -> bool:
    """Whether a parameter is the length over which a body's friction gives way before it slips. A joint's hysteresis may never slip."""
    return effect.family == MEMORY and effect.at != "joint" and name.startswith("x0")


def _reach(place: str, plant: Plant, inverses: Sequence[InverseDynamics]) -> float:
    """Return how far the records go at a place, from end to end: a memory of a joint that is longer than it deflects is a spring."""
    if place == "joint":
        return max(float(np.ptp(p.bodies.body(plant, "joint")[1][POSITION])) for p in inverses)
    return max(float(np.ptp(p.motion.q)) for p in inverses)


def _power(place: str, plant: Plant, inverses: Sequence[InverseDynamics]) -> float:
    """Return the work that all friction at a place takes along the records."""
    row, total = int(place == "load"), 0.0
    for p in inverses:
        if p.rows(plant) <= row:
            continue  # a load that is held does not move
        speed = p.bodies.body(plant, place)[1][VELOCITY]
        for e, name, column in p.columns(plant):
            if e.at == place and e.family.startswith("friction"):
                total += (e.parameters[name].value if name else 1.0) * float(column[row] @ speed) * p.motion.dt
    return total


def _outer(bent: Effect, plant: Plant) -> float:
    """Return the stiffness beyond a threshold of all springs at its place, straight ones and this."""
    straight = (e.parameters["stiffness"].value for e in plant.effects if e.at == bent.at and "stiffness" in e.linear)
    return bent.parameters["k1"].value + bent.parameters["k2"].value + sum(straight)


def returns(wave: Effect, inverses: Sequence[InverseDynamics], periods: float = RETURNS, rotary: bool = False) -> bool:
    """Whether the travel shows an effect with an `order` to return: it holds as many of its periods; or, of a rotary axis, a turn, with which
    all that lives in its place returns, and the wave as good as one period."""
    travel = max(float(np.ptp(p.motion.q)) for p in inverses)
    order = wave.parameters["order"].value
    return order * travel >= periods * 2.0 * np.pi or (rotary and travel >= 2.0 * np.pi and order >= ONCE)


def _slow(mode: Effect, inverses: Sequence[InverseDynamics]) -> str:
    """Return that no record holds SWINGS periods of a mode, or ""."""
    longest = max(float(p.motion.t[-1] - p.motion.t[0]) for p in inverses)
    periods = mode.parameters["frequency"].value * longest
    return (
        f"the longest record holds {periods:.2g} of its periods, and does not show it to swing"
        if periods < SWINGS
        else ""
    )


def _drift(trend: Effect, inverses: Sequence[InverseDynamics]) -> float:
    """Return how far the reading of a position drifts within the longest record, over its travel; 0 of a drive's channel."""
    records = [p.motion.record for p in inverses]
    channel = trend.at.partition(".")[2]
    if not channel.endswith("position"):
        return 0.0
    travel = max(float(np.ptp(r.channels[channel])) for r in records)
    longest = max(float(r.time[-1] - r.time[0]) for r in records)
    return abs(trend.parameters["rate"].value) * longest / max(travel, 1e-300)


def _far(spring: Effect, inverses: Sequence[InverseDynamics]) -> float:
    """Return how many travels away from the middle of the travel a straight spring is relaxed."""
    low = min(float(p.motion.q.min()) for p in inverses)
    high = max(float(p.motion.q.max()) for p in inverses)
    values = {n: p.value for n, p in spring.parameters.items()}  # as it is fitted, or as it is written
    k = values["stiffness"]
    preload = values["preload"] if "preload" in values else -k * values["rest"]
    return abs(k * 0.5 * (low + high) + preload) / max(abs(k) * (high - low), 1e-300)
