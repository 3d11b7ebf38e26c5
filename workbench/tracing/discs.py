"""Whose an error of the angle is: an encoder disc's on the output, one's on the motor, or the gear's between them."""

from collections.abc import Sequence
from math import hypot, pi

from workbench.definition import SENSOR, Effect, catalogue
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import ONE_MASS, TWO_MASS, Plant

# Relative error of a ratio of orders, to one another and to a motor's turn: their intervals are a few per mille. Halved, orders 5 and 6 of a shaft
# are strangers; doubled, two waves hardly ever are. A pulley's error of less than two periods is one at half and at twice of it
MEETS = 0.01
# Counts, by which a turn may miss a whole number of them, as a count is written with ten digits and more. A tenth and ten times as much say the same
# of 36 geared axes of one encoder: six sit behind the gear, which is what their makers wrote beside them, and seventeen have a motor's counts
WHOLE = 0.01
SEATED = "Where the encoder sits tells: on the motor's shaft its disc errs once a turn, behind the gear the gear does; no motion tells the two apart."


def on_the_motor(effect: Effect, place: str, plant: Plant) -> Effect | None:
    """Return an effect of an encoder's disc for one that turns with the motor, in front of a gear; None where there is no other encoder
    that says what the gear adds: of one mass the two are the same wave."""
    ratio = plant.geometry.gear_ratio
    if not effect.harmonic or plant.kind != TWO_MASS or place != "sensor.position" or ratio == 1.0:
        return None
    return effect(**{effect.harmonic: ratio * effect.parameters[effect.harmonic].value})


def of_the_disc(effect: Effect, place: str, plant: Plant) -> str:
    """Return the name that a gear's error of the angle bears where one mass turns without a gear, "" elsewhere: nothing but the disc of its
    encoder errs there, once a turn or as often as a resolver has poles."""
    geared = plant.kind == TWO_MASS or not plant.rotary or plant.geometry.gear_ratio != 1.0
    if geared or not place.startswith("sensor."):
        return ""
    return _disc_of(effect)


def once_a_turn(wave: Effect, plant: Plant) -> bool:
    """Whether a wave's order is that of the motor's turn in front of a gear, which a shaft has, however little of it the travel holds."""
    ratio = plant.geometry.gear_ratio
    return plant.rotary and ratio != 1.0 and abs(wave.parameters["order"].value / ratio - 1.0) < MEETS


def count_of(inverses: Sequence[InverseDynamics]) -> float:
    """Return the count of the drive's encoder, rad or m, 0 where unknown."""
    return max((p.motion.counts for p in inverses), default=0.0)


def behind_the_gear(plant: Plant, count: float) -> bool:
    """Whether an encoder cannot sit in front of a gear by its count, rad of the output: its own disc's turn holds a whole number of them, 2 pi/count
    where it sits behind, 2 pi/(count ratio) in front. Of one that holds a whole number either way, or neither, nothing is said."""
    if count <= 0.0:
        return False
    turn, ratio = 2.0 * pi / count, plant.geometry.gear_ratio
    in_front = round(turn) / ratio
    return abs(turn - round(turn)) < WHOLE and abs(in_front - round(in_front)) > 0.5 / ratio


def on_the_shaft(wave: Effect, plant: Plant, count: float = 0.0) -> str:
    """Return the name that a wave of the one reading bears which repeats once a motor's turn in front of a gear, or along a slide, "" where it is
    none: a disc's error. A wave generator's, a gear's, has two waves a turn. count: of the encoder, rad, 0 where unknown: one that sits
    behind the gear for certain errs once a turn of the motor by the gear alone.

    Of one mass an encoder on the motor and a gear in front of an encoder err alike: the gear is its rival (`SEATED`). On two, the load says
    which. What is named follows from where the one encoder sits as a rule: of 110 geared axes of other authors 32 say that it is the
    motor's, 19 that it is the output's. How far a slide goes in a turn no campaign says; of two readings of slides that others let err in
    waves both were a disc's, on a lead screw and on a fork's sprocket, and none a screw's.
    """
    if wave.at != "sensor.position" or "order" not in wave.parameters:  # of two masses a gear errs at the joint
        return ""
    slides = plant.kind == ONE_MASS and not plant.rotary
    shaft = slides or (once_a_turn(wave, plant) and not behind_the_gear(plant, count))
    return _disc_of(wave) if shaft and _first_leads(wave) else ""


def of_the_gear(disc: str) -> tuple[str, ...]:
    """Return the traced errors of a gear that a disc's is told from by its order alone."""
    return tuple(e.name for e in catalogue().values() if e.traced and any(n == disc for _, n in e.reduces.values()))


def _disc_of(wave: Effect) -> str:
    """Return the error of a disc that a gear's error of the angle is at one of its values, "" where there is none."""
    return next((n for _, n in wave.reduces.values() if n and catalogue()[n].port == SENSOR), "")


def _first_leads(wave: Effect) -> bool:
    """Whether the first harmonic of a wave is its largest; of one that has no other it is."""
    sizes = [
        hypot(p.value, wave.parameters[name.replace("sine", "cosine", 1)].value)
        for name, p in wave.parameters.items()
        if name.startswith("sine")
    ]
    return not sizes or sizes[0] == max(sizes)  # none of a wave of which a campaign holds the amplitude alone
