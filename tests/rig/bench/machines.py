"""Machines of a bench, drawn at random, and what their engineer declares of them."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from rig.bench.contacts import lognormal, stretched
from rig.bench.kernel import Facts, Lists
from rig.bench.motions import Reach

NONE2, NONE3 = np.zeros((0, 2)), np.zeros((0, 3))
EMPTY = Lists(NONE2, NONE2, NONE2, NONE3, NONE3, NONE3, NONE3, NONE2)
COUNTED = 0.003  # of the largest acceleration: what counts may pretend in the band
# Of the effort. Where friction gives way within a count, what it holds at standstill is nobody's to tell: it is lighter.
HEAVY, LIGHT = (0.06, 0.25), (0.015, 0.06)


@dataclass(frozen=True)
class Timeline:
    """What goes with the bench clock t (n,): a factor on the mover's friction, and a force on the body."""

    level: Callable[[np.ndarray], np.ndarray] = np.ones_like
    push: Callable[[np.ndarray], np.ndarray] = np.zeros_like


@dataclass(frozen=True)
class Reported:
    """What reports make of the truth. late, skew: of the (load) position's clock, s and s/s; trend: of the drive, per s;
    lost: (moment, step) at which the load's encoder falls behind."""

    late: float = 0.0
    skew: float = 0.0
    trend: float = 0.0
    lost: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, eq=False)
class Machine:
    facts: Facts
    lists: Lists
    timelines: tuple[Timeline, ...] = ()
    reported: Reported = Reported()

    @property
    def two(self) -> bool:
        return self.facts.load_inertia > 0.0

    def put(self, **values: float) -> "Machine":
        return replace(self, facts=self.facts._replace(**values))

    def waved(self, name: str, waves: np.ndarray) -> "Machine":
        """With these waves (n, 3), or creeping elements (n, 2), beside those of the list of this name."""
        return replace(self, lists=self.lists._replace(**{name: np.concatenate([getattr(self.lists, name), waves])}))


@dataclass(frozen=True)
class Stated:
    """A declared parameter: its key, unit (in F and x), true value and whether it is from a data sheet. column: of the
    balance, which it scales."""

    key: str
    unit: str
    value: float
    fixed: bool = False
    column: str = ""


@dataclass(frozen=True)
class Declared:
    effect: str
    at: str
    parameters: tuple[Stated, ...]
    law: str = ""


@dataclass(frozen=True, eq=False)
class Stand:
    """A machine on its bench: what is true (with nothing missing), what is declared, and how far it may move.

    x0, d: of the declared virgin curves 1 - exp(-(x/x0)^d), place -> (x0, d). effort: a typical drive, J times acceleration.
    """

    name: str
    linear: bool
    machine: Machine
    declared: tuple[Declared, ...]
    reach: Reach
    effort: float
    load_count: float
    ratio: float = 1.0
    pole_pairs: int = 4
    curves: dict[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def coulomb(self) -> bool:
        return "axis" not in self.curves and "motor" not in self.curves


def log_uniform(rng, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


SCREW = {
    "inertia": (8.0, 80.0),
    "acceleration": (3.0, 12.0),
    "speed": (0.2, 0.8),
    "stroke": (0.1, 0.35),
    "count": (5e-8, 1e-6),
}
GIMBAL = {
    "inertia": (0.02, 0.2),
    "acceleration": (20.0, 80.0),
    "speed": (3.0, 9.0),
    "stroke": (0.8, 2.5),
    "count": (1e-6, 1e-5),
}
WAVE = {
    "inertia": (0.3, 3.0),
    "acceleration": (15.0, 60.0),
    "speed": (2.0, 6.0),
    "stroke": (1.0, 3.0),
    "count": (1e-6, 1e-5),
}
GEARED = {
    "inertia": (0.01, 0.5),
    "acceleration": (15.0, 60.0),
    "speed": (2.0, 6.0),
    "stroke": (0.8, 2.0),
    "count": (2e-6, 8e-6),
}
KINDS = {"screw stage": SCREW, "gimbal": GIMBAL, "strain-wave axis": WAVE, "geared two-mass axis": GEARED}


def dry(rng, count: float, stroke: float, coulomb: bool) -> np.ndarray:
    """The bristles of the mover. Where Coulomb friction is declared they give way by less than a count."""
    if coulomb:
        return lognormal(count * rng.uniform(0.1, 0.6), 0.5, 6)
    return lognormal(max(stroke * log_uniform(rng, 3e-4, 3e-3), 12 * count), rng.uniform(0.5, 1.4))


def friction(at: str, h0: float, curve: tuple[float, float] | None) -> Declared:
    column = {"axis": "dry", "motor": "dry", "load": "load_dry", "joint": "joint_dry"}[at]
    if curve is None:
        return Declared("coulomb_friction", at, (Stated("coulomb", "F", h0, column=column),), "c*sign(v)")
    x0, d = curve
    return Declared(
        "presliding_hysteresis", at,
        (Stated("h0", "F", h0, column=column), Stated("a", "1/x^d", x0**-d, column=column + "_x0"), Stated("d", "1", d)),
        "virgin curve h0(1-exp(-a x^d)), Masing",
    )  # fmt: skip


def drawn(rng, kind: str, rate: float, band: float) -> Stand:
    """A machine of one of KINDS, and what is declared of it; an encoder that a band (Hz) at this log rate is chosen for."""
    r = {k: log_uniform(rng, *v) for k, v in KINDS[kind].items()}
    # rms, in the band, of the acceleration that counts pretend: count/sqrt(12) (2 pi f)^2, white over the log's band
    of_count = (2 * np.pi * band) ** 2 / np.sqrt(12.0 * 5.0) * np.sqrt(2 * band / rate)
    r["count"] = min(r["count"], COUNTED * r["acceleration"] / of_count)
    return two_mass(rng, kind, r) if kind == "geared two-mass axis" else one_mass(rng, kind, r)


def one_mass(rng, kind: str, r: dict) -> Stand:
    effort, linear = r["inertia"] * r["acceleration"], kind == "screw stage"
    coulomb = bool(rng.random() < 0.5)
    bristles = dry(rng, r["count"], r["stroke"], coulomb)
    h0, viscous = effort * rng.uniform(*(LIGHT if coulomb else HEAVY)), effort * rng.uniform(0.06, 0.25) / r["speed"]
    curves = {} if coulomb else {"axis": stretched(bristles)}
    speed_loop = 2 * np.pi * rng.uniform(14.0, 28.0)
    facts = Facts(
        r["inertia"], viscous, h0, 2.5 * effort, r["inertia"] * speed_loop, speed_loop / 4.5, r["count"],
        forward=r["inertia"] * rng.uniform(0.6, 1.0), reset=speed_loop / 6,
    )  # fmt: skip
    declared = [
        Declared(
            "inertia", "axis", (Stated("inertia", "F*s^2/x", r["inertia"], bool(rng.random() < 0.5), "inertia"),), "J*a"
        ),
        Declared("viscous_friction", "axis", (Stated("viscous", "F*s/x", viscous, column="viscous"),), "b*v"),
        friction("axis", h0, curves.get("axis")),
    ]
    chance = rng.random(3)
    if chance[0] < 0.25:
        facts = facts._replace(offset=effort * rng.uniform(-0.06, 0.06))
        declared.append(Declared("constant_offset", "axis", (Stated("offset", "F", facts.offset, column="one"),), "T0"))
    if chance[1] < 0.25 and not linear:
        facts = facts._replace(weight=effort * rng.uniform(0.1, 0.4), weight_phase=rng.uniform(-3, 3))
        mgl, phase = (
            Stated("mgl", "F", facts.weight, column="sine"),
            Stated("phase", "angle", facts.weight_phase, column="cosine"),
        )
        declared.append(Declared("gravity", "axis", (mgl, phase), "W*sin(q+p)"))
    if chance[2] < 0.1:
        facts = facts._replace(spring=effort * rng.uniform(0.1, 0.4) / r["stroke"])
        declared.append(
            Declared("linear_stiffness", "axis", (Stated("stiffness", "F/x", facts.spring, column="place"),), "k*q")
        )
    reach = Reach(r["stroke"], r["speed"], r["acceleration"], effort)
    ratio = float(rng.choice([30, 50, 100])) if kind == "strain-wave axis" else 1.0
    lists = EMPTY._replace(bristles=bristles)
    return Stand(
        kind,
        linear,
        Machine(facts, lists),
        tuple(declared),
        reach,
        effort,
        0.0,
        ratio,
        int(rng.choice([4, 5, 7, 11])),
        curves,
    )


def two_mass(rng, kind: str, r: dict) -> Stand:
    """Motor and load, both read at the output."""
    j1, j2 = r["inertia"], r["inertia"] * rng.uniform(0.8, 3.0)
    effort = (j1 + j2) * r["acceleration"]
    k2 = j2 * (2 * np.pi * rng.uniform(18.0, 40.0)) ** 2
    coulomb, rubs, hysteretic, own = (bool(x) for x in rng.random(4) < (0.4, 0.5, 0.4, 0.85))
    bristles = dry(rng, r["count"], r["stroke"], coulomb)
    fine = r["count"] * rng.uniform(0.3, 0.8)
    h0 = effort * rng.uniform(*(LIGHT if coulomb else HEAVY))
    damping = 2 * rng.uniform(0.02, 0.08) * np.sqrt(k2 * j2)
    speed_loop = 2 * np.pi * rng.uniform(5.0, 9.0)
    facts = Facts(
        j1, effort * rng.uniform(0.04, 0.15) / r["speed"], h0, 2.5 * effort, (j1 + j2) * speed_loop, speed_loop / 4.5, r["count"],
        forward=(j1 + j2) * rng.uniform(0.6, 0.9), reset=speed_loop / 6, load_inertia=j2,
        load_viscous=effort * rng.uniform(0.01, 0.06) / r["speed"], load_h=effort * rng.uniform(0.005, 0.03) * rubs,
        k2=k2, c2=damping, h2=effort * rng.uniform(0.02, 0.08) * hysteretic,
    )  # fmt: skip
    curves = {} if coulomb else {"motor": stretched(bristles)}
    lists = EMPTY._replace(bristles=bristles)
    declared = [
        Declared("inertia", "motor", (Stated("inertia", "F*s^2/x", j1, own, "inertia"),), "J1*a1"),
        Declared("inertia", "load", (Stated("inertia", "F*s^2/x", j2, own, "load_inertia"),), "J2*a2"),
        Declared("viscous_friction", "motor", (Stated("viscous", "F*s/x", facts.viscous, column="viscous"),), "b1*v1"),
        Declared(
            "viscous_friction",
            "load",
            (Stated("viscous", "F*s/x", facts.load_viscous, column="load_viscous"),),
            "b2*v2",
        ),
        friction("motor", h0, curves.get("motor")),
        Declared("linear_stiffness", "joint", (Stated("stiffness", "F/x", k2, column="stretch"),), "k*(x1-x2)"),
        Declared("linear_damping", "joint", (Stated("damping", "F*s/x", damping, column="rate"),), "g*(v1-v2)"),
    ]
    if rubs:
        lists = lists._replace(load_bristles=lognormal(fine * rng.uniform(0.2, 0.6), 0.5, 6))
        declared.append(friction("load", facts.load_h, None))
    if hysteretic:
        lists = lists._replace(joint_bristles=lognormal(rng.uniform(0.1, 0.4) * effort / k2, rng.uniform(0.5, 0.9)))
        curves["joint"] = stretched(lists.joint_bristles)
        declared.append(friction("joint", facts.h2, curves["joint"]))
    reach = Reach(r["stroke"], r["speed"], r["acceleration"], effort)
    return Stand(
        kind,
        False,
        Machine(facts, lists),
        tuple(declared),
        reach,
        effort,
        fine,
        float(rng.choice([24, 50, 80])),
        4,
        curves,
    )
