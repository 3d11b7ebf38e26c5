"""Whose an error of the angle is: an encoder disc's on the output, one's on the motor, or the gear's between them."""

from workbench.definition import SENSOR, Effect, catalogue
from workbench.plant import TWO_MASS, Plant


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
    return next((n for _, n in effect.reduces.values() if n and catalogue()[n].port == SENSOR), "")
