"""Forces periodic in position: cogging, which conserves, and cyclic friction, which follows the direction or the speed."""

from collections.abc import Iterable
from math import atan2, hypot

from workbench.border import Border
from workbench.definition import FORCE, Effect, effect
from workbench.effects.elementary import cos, sin
from workbench.parameter import Parameter

ORDER = Parameter(1.0, "1/x", "order: periods in 2 pi of displacement", lower=1e-9, scale="order")


def _suffix(i: int) -> str:
    """Return what stands behind the name of a parameter of the i-th harmonic."""
    return "" if i == 1 else f"_{i}"


def _harmonics(numbers: Iterable[int]) -> tuple[dict[str, Parameter], dict[str, Parameter]]:
    """Return (inside, outside) of harmonics: sine and cosine as they are fitted, amplitude and phase as they are written."""
    inside, outside = {}, {}
    for i in numbers:
        name = ("first", "second", "third", "fourth")[i - 1] if i <= 4 else f"{i}th"
        inside[f"s{i}"] = Parameter(0.0, "F", f"sine amplitude, {name} harmonic")
        inside[f"c{i}"] = Parameter(0.0, "F", f"cosine amplitude, {name} harmonic")
        outside[f"amplitude{_suffix(i)}"] = Parameter(0.0, "F", f"amplitude of the {name} harmonic", lower=0.0)
        outside[f"phase{_suffix(i)}"] = Parameter(0.0, "rad", f"phase of the {name} harmonic")
    return inside, outside


@effect
def cogging(harmonics: int = 2) -> Effect:
    """T = A1 sin(k q + p1) + A2 sin(2 k q + p2) ..., k the order per radian of output (linear: per metre)."""
    numbers = range(1, harmonics + 1)

    def step(s, z, p):
        angle = p.order * s.q
        terms = [
            getattr(p, f"s{i}") * sin(float(i) * angle) + getattr(p, f"c{i}") * cos(float(i) * angle) for i in numbers
        ]
        return {}, sum(terms[1:], terms[0])

    def inward(o):
        inside = {"order": o["order"]}
        for i in numbers:
            a, phase = o[f"amplitude{_suffix(i)}"], o[f"phase{_suffix(i)}"]
            inside |= {f"s{i}": a * cos(phase), f"c{i}": a * sin(phase)}
        return inside

    def outward(given):
        outside = {"order": given["order"]}
        for i in numbers:
            s, c = given[f"s{i}"], given[f"c{i}"]
            outside |= {f"amplitude{_suffix(i)}": hypot(s, c), f"phase{_suffix(i)}": atan2(c, s)}
        return outside

    inside, outside = _harmonics(numbers)
    return Effect(
        name="cogging",
        cause="attraction between magnets and slots, or torque ripple of the commutation, periodic in position",
        formula=" + ".join(f"A{i} sin({'' if i == 1 else f'{i} '}k q + p{i})" for i in numbers).join(("T = ", "")),
        source="Hanselman, Brushless Permanent Magnet Motor Design, 2003",
        port=FORCE,
        family="force over position",
        parameters=inside | {"order": ORDER},
        linear=tuple(inside),
        reads=("q",),
        step=step,
        holds=("conservative",),
        border=Border(
            parameters=outside | {"order": ORDER},
            inward=inward,
            outward=outward,
            linear=tuple(n for n in outside if n.startswith("amplitude")),
        ),
    )


@effect
def cyclic_friction() -> Effect:
    """T = (a_d cos(k q) + b_d sin(k q)) dir + (a_v cos(k q) + b_v sin(k q)) v.

    Coulomb and viscous friction that vary over a turn. The form (A + B v) (a cos + b sin) in the literature has A and B
    redundant with a and b, so the products are fitted; and its first term has no direction, which makes it cogging and no
    friction: here it follows `dir`. By itself it drives the axis over half of the turn; it is passive only beside Coulomb
    and viscous friction as large as its amplitudes.
    """

    def step(s, z, p):
        angle = p.order * s.q
        c, d = cos(angle), sin(angle)
        return {}, (p.cosine * c + p.sine * d) * s.dir + (p.viscous_cosine * c + p.viscous_sine * d) * s.v

    return Effect(
        name="cyclic_friction",
        cause="friction that varies over a turn: teeth in mesh, an eccentric bearing, a seal that does not run true",
        formula="T = (ad cos(k q) + bd sin(k q)) dir + (av cos(k q) + bv sin(k q)) v",
        source="Armstrong-Helouvry 1991 (position-dependent friction); products of the harmonic-drive review's (A + B v)",
        port=FORCE,
        family="friction over position",
        parameters={
            "cosine": Parameter(0.0, "F", "cosine amplitude of Coulomb friction"),
            "sine": Parameter(0.0, "F", "sine amplitude of Coulomb friction"),
            "viscous_cosine": Parameter(0.0, "F*s/x", "cosine amplitude of viscous friction"),
            "viscous_sine": Parameter(0.0, "F*s/x", "sine amplitude of viscous friction"),
            "order": ORDER,
        },
        linear=("cosine", "sine", "viscous_cosine", "viscous_sine"),
        reads=("q", "dir", "v"),
        step=step,
    )
