"""What the axes that hold an effect say to what the review says of it."""

from collections.abc import Mapping
from math import hypot

from workbench.plant import Plant
from workbench.report.contents import Marked, Table
from workbench.report.numbers import percent

from .axes import CYCLIC, LOADED, SERIES, STRIBECK
from .rivals import GEAR, SERIES_KEY, Judged
from .saying import EQUAL, NOTHING, Statement, better, verdict

WITH = {  # axis -> (the model that lacks its effect, the one that has it)
    STRIBECK: ("presliding", "presliding and Stribeck"),
    CYCLIC: ("presliding", "two orders"),
    LOADED: ("three waves", "three waves that fade under load"),
    SERIES: ("linear and cubic", "two compliances, T_fr and hysteresis"),
}


def statements(seen: Mapping[str, Judged]) -> list[Statement]:
    """Return what each axis says, by rules on the errors on records that no fit saw."""
    return [*_friction(seen[STRIBECK]), *_cyclic(seen[CYCLIC]), *_gear(seen[LOADED]), *_joint(seen[SERIES])]


def _said(axis: str, j: Judged, said: str, holds: bool, numbers: str) -> Statement:
    """A statement by an axis, whose records hold its effect where the model without it leaves more than noise and counts."""
    held = j.error(WITH[axis][0]) > NOTHING * j.floor
    return Statement(said, axis, verdict(holds, held), f"{numbers} Noise and counts leave {percent(j.floor)}.")


def _left(j: Judged, models: Mapping[str, str]) -> str:
    """Return what models leave on validation, as a list. models: words -> model."""
    return "left by " + ", by ".join(f"{words} {percent(j.error(m))}" for words, m in models.items())


def _estimate(j: Judged, model: str, effect: str, parameter: str, scale: float = 1.0, digits: int = 3) -> str:
    e = next(e for e in j.fits[model].estimates if (e.effect, e.parameter) == (effect, parameter))
    return f"{scale * e.value:.{digits}f} ± {scale * (e.high - e.low) / 2:.{digits}f}"


def _friction(j: Judged) -> list[Statement]:
    without, model = WITH[STRIBECK]
    fall = _estimate(j, model, "stribeck_friction", "drop", 1e3, 1)
    speed = _estimate(j, model, "stribeck_friction", "speed", 1.0, 3)
    fast = {m: percent(f.nrmse["id_staircase"]) for m, f in j.fits.items()}
    return [
        _said(STRIBECK, j, "Friction falls with speed before it rises (Stribeck)", better(j.error(model), j.error(without)),
              f"{_left(j, {'presliding alone': without, 'the fall beside it': model})}: {fall} mN·m at {speed} rad/s."),
        _said(STRIBECK, j, "LuGre describes dynamic friction, its fall with speed too", better(j.error("LuGre"), j.error(without)),
              f"{_left(j, {'LuGre': 'LuGre', 'presliding without the fall': without, 'presliding with it': model})}; of the staircase of speeds "
              f"{fast['LuGre']}, {fast[without]} and {fast[model]}."),
    ]  # fmt: skip


def _cyclic(j: Judged) -> list[Statement]:
    without, model = WITH[CYCLIC]
    printed = "two orders, as printed"
    return [
        _said(CYCLIC, j, "Friction is periodic in the motor's turn", better(j.error(model), j.error(without)),
              f"{_left(j, {'friction that is not': without, 'two orders': model})}."),
        _said(CYCLIC, j, "Cyclic friction: a sum of several orders", better(j.error(model), j.error("one order")),
              f"{_left(j, {'one order': 'one order', 'two': model})}."),
        _said(CYCLIC, j, "Cyclic friction as printed, (A + B v) times a series, without direction",
              j.error(printed) <= (1.0 + EQUAL) * j.error(model),
              f"{_left(j, {'it': printed, 'the same series with direction': model})}: without, its first part is cogging."),
    ]  # fmt: skip


def _gear(j: Judged) -> list[Statement]:
    without, model = WITH[LOADED]
    fading = _estimate(j, model, GEAR.split("@")[0], "fading", 1.0, 2)
    return [
        _said(LOADED, j, "Trigonometric kinematic error: a sum of several waves", better(j.error(without), j.error("one wave")),
              f"{_left(j, {'none': 'no wave', 'one wave': 'one wave', 'three': without})}."),
        _said(LOADED, j, "Kinematic error falls with load", better(j.error(model), j.error(without)),
              f"{_left(j, {'three waves that stay': without, 'three that fade': model})}: by a factor of 1 + {fading} at 1 mrad of deflection."),
        _said(LOADED, j, "Trigonometric kinematic error: what it ignores limits accuracy", j.error(without) > 1.5 * j.floor,
              f"three waves leave {j.error(without) / j.floor:.2f} times what noise and counts do."),
    ]  # fmt: skip


def _joint(j: Judged) -> list[Statement]:
    without, model = WITH[SERIES]
    smooth, alone, effect = "two compliances", "two compliances and T_fr, no hysteresis", SERIES_KEY.split("@")[0]
    share = _estimate(j, model, effect, "share", 1.0, 2)
    most = j.fits[model].plant[SERIES_KEY].parameters["torque"].value
    rubbed = _estimate(j, model, effect, "friction", 1e3 * most, 0)
    return [
        _said(SERIES, j, "Multi-body compliance: the wave generator's share describes what a polynomial does not",
              better(j.error(smooth), j.error(without)),
              f"With hysteresis in each, {_left(j, {'a cubic joint': without, 'two compliances': smooth})}; the generator's share is {share}."),
        _said(SERIES, j, "Multi-body compliance: T_fr belongs into the wave generator's torque", better(j.error(model), j.error(smooth)),
              f"{_left(j, {'T_fr held at zero': smooth, 'T_fr free': model})}: {rubbed} mN·m."),
        _said(SERIES, j, "Multi-body compliance: its friction is too simple", better(j.error(model), j.error(alone)),
              f"{_left(j, {'T_fr as the only hysteresis': alone, 'Maxwell slip beside it': model})}."),
    ]  # fmt: skip


def _sizes(axis: str, plant: Plant) -> tuple[float, ...]:
    """Return how large a plant has what an axis holds: the fall of friction, both amplitudes of the cyclic part, the fading, the
    generator's share and T_fr."""

    def of(key: str, *names: str) -> list[float]:
        return [plant[key].parameters[n].value for n in names]

    if axis == STRIBECK:
        return tuple(of("stribeck_friction", "drop"))
    if axis == CYCLIC:
        return tuple(hypot(*of(f"cyclic_friction {which}@motor", "cosine", "sine")) for which in ("once", "twice"))
    if axis == LOADED:
        return tuple(of(GEAR, "fading"))
    most, friction, share = of(SERIES_KEY, "torque", "friction", "share")
    return share, most * friction


def deviations(seen: Mapping[str, Judged]) -> dict[str, float]:
    """Return axis -> how far the size of its effect was found off what was simulated, relative."""
    both = {a: (_sizes(a, j.fits[WITH[a][1]].plant), _sizes(a, j.axis.known)) for a, j in seen.items()}
    return {a: max(abs(x / y - 1.0) for x, y in zip(*pair, strict=True)) for a, pair in both.items()}


def over_floor(seen: Mapping[str, Judged]) -> float:
    """Return what the models with their axis's effect leave over what the axes themselves leave, at most."""
    return max(j.error(WITH[a][1]) / j.floor for a, j in seen.items())


def table(seen: Mapping[str, Judged]) -> Table:
    """Return what every model leaves on the records of its axis."""
    rows = []
    for axis, j in seen.items():
        for k, (model, fit) in enumerate(j.fits.items()):
            name = Marked(model, "strong") if model == WITH[axis][1] else model
            times = f"{fit.validation / j.floor:.2f}"
            rows.append((axis if k == 0 else "", name, percent(fit.identification), percent(fit.validation), times))
    return Table(
        ("Axis that holds", "Model", "Identification", "Validation", "Over the axis itself"), tuple(rows),
        "Errors over the drive's rms; the model with the effect in bold. Last column: validation over what the simulated plant itself "
        "leaves there, which is torque noise and encoder counts.", "plrrr",
    )  # fmt: skip
