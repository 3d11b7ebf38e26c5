"""Free-form laws of maps, and of creep: angle over angle, drive over command, a spectrum of relaxation times."""

from collections.abc import Sequence
from functools import cache

from workbench.definition import ANGLE, COMMAND, FORCE, Effect
from workbench.effects.elementary import clip, cos, expm1, sin
from workbench.effects.table import at as of
from workbench.effects.table import held_knots, increasing, names
from workbench.errors import WorkbenchError
from workbench.parameter import Parameter

STEEPEST = 0.9  # share of a rising command that may be lost: u' must go on rising, or it has no inverse


@cache
def _of_angle(harmonics: int):
    def step(s, z, p):
        angle, error = p.order * s.motor_q, 0.0
        for i, (a, b) in enumerate(zip(of(p, "sine", harmonics), of(p, "cosine", harmonics), strict=True), 1):
            error = error + a * sin(float(i) * angle) + b * cos(float(i) * angle)
        return {}, s.q + error

    return step


def angle_over_angle(order: float, harmonics: int = 4, at: str = "joint") -> Effect:
    """x_eff = x + sum_i A_i sin(i k q_m + p_i), i = 1..harmonics: the gear's error as a Fourier series over the base order k.

    order: k in 1/x, held; of a gear once a turn of the output it is 1, of its motor the ratio. A map, so its amplitudes are
    searched, from zero.
    """
    if not order > 0.0 or harmonics < 1:
        raise WorkbenchError(
            f"a kinematic curve needs an order above 0 and a harmonic or more; given: {order:g}, {harmonics}."
        )
    terms = {}
    for word in ("sine", "cosine"):
        for i, n in enumerate(names(word, harmonics), 1):
            terms[n] = Parameter(0.0, "x", f"{word} amplitude of harmonic {i}")
    return Effect(
        name="angle_over_angle",
        cause="a gear's error of several orders: the output leads and lags over the motor's turn",
        formula="x_eff = x + sum Ai sin(i k q_m + pi)",
        source="Fourier series; Ghorbel, Gandhi, Alpeter 2001",
        port=ANGLE,
        family="angle over angle",
        reduces={"order": (1.0, "encoder_eccentricity")},
        parameters=terms | {"order": Parameter(order, "1/x", "base order", lower=1e-9, fixed=True, scale="order")},
        reads=("q", "motor_q"),
        step=_of_angle(harmonics),
        places=("joint", "sensor"),
        at=at,
        traced=False,
        knots=("order",),
    )


@cache
def _of_command(count: int):
    def step(s, z, p):
        limits, losses = of(p, "knot", count), of(p, "loss", count - 1)
        inner = [clip(s.u, -k, k) for k in limits[:-1]] + [s.u]
        lost = [c * (b - a) for c, a, b in zip(losses, inner[:-1], inner[1:], strict=True)]
        return {}, s.u - sum(lost[1:], lost[0])

    return step


def drive_over_command(commands: Sequence[float], at: str = "command") -> Effect:
    """u' = u - sum_i c_i (part of u between U_i and U_(i+1)), odd: a share c_i of each further piece of command is lost.

    0 <= c_i <= 0.9, so that u' rises and has an inverse. Below U_1 nothing is lost (a gain of all commands is one of all
    forces); the last piece goes on beyond the last knot. commands (n >= 3,): U_i above 0, F.
    """
    knots = increasing(commands, "commands", True)
    n = len(knots)
    losses = {
        c: Parameter(0.0, "1", f"share lost of the command between knots {i} and {i + 1}", lower=0.0, upper=STEEPEST)
        for i, c in enumerate(names("loss", n - 1), 1)
    }
    return Effect(
        name="drive_over_command",
        cause="a drive that gives less than it is asked for as the command grows, by no catalogued law",
        formula="u' = u - sum ci (clip(u, -U(i+1), U(i+1)) - clip(u, -Ui, Ui))",
        source="linear interpolation between knots, de Boor 1978",
        port=COMMAND,
        family="drive over command",
        parameters=losses | held_knots(knots, "F"),
        reads=("u",),
        step=_of_command(n),
        holds=("odd",),
        places=("command",),
        at=at,
        traced=False,
        knots=names("knot", n),
    )


@cache
def _of_rates(count: int):
    def step(s, z, p):
        after, force = {}, 0.0
        for i, (k, rate) in enumerate(zip(of(p, "k", count), of(p, "knot", count), strict=True), 1):
            turned = rate * s.dt
            gone = -expm1(-turned)
            w = getattr(z, f"w{i}")
            after[f"w{i}"] = (w - gone * w) + (gone / turned) * s.dq
            force = force + k * after[f"w{i}"]
        return after, force

    return step


def creep_spectrum(rates: Sequence[float], at: str = "axis") -> Effect:
    """T = sum k_j (q - l_j), dl_j/dt = lambda_j (q - l_j), k_j >= 0 over held rates: a discrete relaxation spectrum.

    rates (n >= 3,): lambda_j in 1/s, increasing. Exact step as of creep.
    """
    knots = increasing(rates, "rates", True)
    n = len(knots)
    springs = {
        c: Parameter(0.0, "F/x", f"stiffness that relaxes at rate {i}", lower=0.0)
        for i, c in enumerate(names("k", n), 1)
    }
    return Effect(
        name="creep_spectrum",
        cause="a material that gives way over many times at once: cables, grease, a polymer",
        formula="T = sum kj (q - lj), dlj/dt = rate_j (q - lj)",
        source="Maxwell 1867; discrete relaxation spectrum, Ferry, Viscoelastic Properties of Polymers, 1980",
        port=FORCE,
        family="creep",
        parameters=springs | held_knots(knots, "1/s", "rate"),
        linear=tuple(springs),
        states={f"w{i}": 1 for i in range(1, n + 1)},
        reads=("dq", "dt"),
        step=_of_rates(n),
        holds=("passive", "odd"),
        places=("axis", "motor", "load", "joint"),
        at=at,
        traced=False,
        knots=names("knot", n),
    )
