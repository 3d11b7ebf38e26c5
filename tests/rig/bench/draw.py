"""Which campaigns of a bench are drawn: one thing missing, two, nothing, or what no catalogue has."""

from dataclasses import dataclass

import numpy as np

from rig.bench.causes import CAUSES, ONE, OUTSIDE, TWO
from rig.bench.machines import KINDS

PARTS = {"single": 0.5, "pair": 0.125, "none": 0.225, "outside": 0.15}
GEARED = "geared two-mass axis"
DRY = {"presliding_hysteresis", "fading_memory", "backlash", "stribeck_friction"}
DRIVE = {"transport_delay", "actuator_lag"}


@dataclass(frozen=True)
class Spec:
    """One campaign: its class, seed, what is missing, and the kind of machine ("" for any that can have it)."""

    of: str
    seed: int
    missing: tuple[str, ...]
    kind: str


def kinds(names: tuple[str, ...]) -> list[str]:
    """Kinds of machine on which all of these may be missing."""
    masses = [set((CAUSES.get(n) or OUTSIDE[n])[1]) for n in names]
    both = set.intersection(*masses) if masses else {ONE, TWO}
    found = [k for k in KINDS if (TWO if k == GEARED else ONE) in both]
    turning = {"gravity", "encoder_eccentricity"} & set(names)
    return [k for k in found if not (turning and k == "screw stage")]


def clash(a: str, b: str) -> bool:
    """Whether two causes cannot be told to be two."""
    return (
        a == b
        or {a, b} <= DRY
        or {a, b} <= DRIVE
        or {a, b} <= {"kinematic_error", "encoder_eccentricity"}
        or not kinds((a, b))
    )


def in_turn(rng, names, count: int) -> list[str]:
    found: list[str] = []
    while len(found) < count:
        found += [str(n) for n in rng.permutation(list(names))]
    return found[:count]


def drawn(count: int, seed: int) -> list[Spec]:
    """count campaigns of a seed, in an order of chance."""
    rng = np.random.default_rng([seed, 30])
    counts = {of: round(share * count) for of, share in PARTS.items()}
    counts["single"] = count - sum(counts[of] for of in ("pair", "none", "outside"))
    lacking = [("single", (n,)) for n in in_turn(rng, CAUSES, counts["single"])]
    for first in in_turn(rng, CAUSES, counts["pair"]):
        others = [n for n in CAUSES if not clash(first, n)]
        lacking.append(("pair", (first, str(rng.choice(others)))))
    lacking += [("none", ())] * counts["none"]
    lacking += [("outside", (n,)) for n in in_turn(rng, OUTSIDE, counts["outside"])]
    order = rng.permutation(len(lacking))
    return [
        Spec(lacking[k][0], 1000 * seed + i, lacking[k][1], str(rng.choice(kinds(lacking[k][1]))))
        for i, k in enumerate(order)
    ]
