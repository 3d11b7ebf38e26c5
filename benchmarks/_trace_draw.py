"""The campaigns of the trace's benchmark: what is missing, how large, of which machine, and how that is measured."""

import sys
from dataclasses import asdict, dataclass, replace
from hashlib import sha256
from json import dumps
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parent.parent / "tests"))

from rig import COUNT, EFFECTS, LEVEL, TWO_MASS, campaign  # noqa: E402, F401

DRY = {"coulomb_friction", "lugre_friction", "presliding_hysteresis", "fading_memory"}
SINGLE, PAIR, NONE, OUTSIDE = "single", "pair", "none", "outside"
PARTS = {SINGLE: 0.55, PAIR: 0.15, NONE: 0.15, OUTSIDE: 0.15}
SIZES = (2.0, 12.0)  # over the noise, even in the logarithm
WEAKEST = 0.9  # of the smallest size that is asked for, which an effect must come to
OUTSIDE_SIZES = (4.0, 12.0)  # what lives in one place needs more of it there for the same rms


@dataclass(frozen=True)
class Spec:
    """One campaign: its class, seed, and the arguments of rig.campaign. over: size over the noise."""

    of: str
    seed: int
    missing: tuple[str, ...]
    over: float
    base: str
    noise: float
    memory: float
    count: float
    rate: int
    band: float
    ratio: float
    short: bool

    @property
    def key(self) -> str:
        return sha256(dumps(asdict(self)).encode()).hexdigest()[:12]

    @property
    def two(self) -> bool:
        return self.base in TWO_MASS


def measured(rng) -> dict:
    """How a campaign is measured. Fast logs are short, so that no record is much longer than 20 000 samples."""
    rate = int(rng.choice([1000, 2000, 5000], p=[0.6, 0.2, 0.2]))
    return {
        "noise": float(rng.uniform(1e-3, 4e-3)),
        "memory": float(rng.choice([0.0, rng.uniform(3e-3, 15e-3)])),
        "count": COUNT * float(rng.choice([1.0, 5.0, 15.0], p=[0.7, 0.2, 0.1])),
        "rate": rate,
        "band": float(rng.choice([100.0, 150.0, 200.0])),
        "ratio": float(rng.choice([30.0, 50.0, 100.0])),
        "short": rate > 1000,
    }


def clash(a: str, b: str) -> bool:
    """Whether two kinds cannot be missing at once: one name, one law or one field for both, both dry friction that may have
    memory; or no base in common."""
    x, y = EFFECTS[a], EFFECTS[b]
    same = x.effect == y.effect or (x.law and x.law == y.law) or set(x.fields) & set(y.fields)
    same = same or {x.effect, y.effect} <= DRY
    return bool(same) or not set(x.bases) & set(y.bases)


def spec(of: str, seed: int, kinds: tuple[str, ...], bases: tuple[str, ...]) -> Spec:
    rng = np.random.default_rng([seed, 7])
    low, high = OUTSIDE_SIZES if of == OUTSIDE else SIZES
    over = float(np.exp(rng.uniform(np.log(low), np.log(high))))
    return Spec(of, seed, kinds, over, str(rng.choice(bases)), **measured(rng))


def in_turn(rng, names: list[str], count: int) -> list[str]:
    """count names, each as often as the others, in an order of chance."""
    found = []
    while len(found) < count:
        found += [str(n) for n in rng.permutation(names)]
    return found[:count]


def specs(campaigns: int, seed: int, two_mass: bool | None = None, short: bool = False) -> list[Spec]:
    """Draw campaigns. two_mass: on two masses only, or on one only; both where it is None. short: all records are short."""
    rng = np.random.default_rng([seed, 3])

    def allowed(name: str) -> tuple[str, ...]:
        return tuple(b for b in EFFECTS[name].bases if two_mass is None or (b in TWO_MASS) == two_mass)

    every = [n for n in EFFECTS if allowed(n)]
    known, own = [n for n in every if EFFECTS[n].effect], [n for n in every if not EFFECTS[n].effect]
    partners = {n: [m for m in known if not clash(n, m) and set(allowed(n)) & set(allowed(m))] for n in known}
    partners = {n: others for n, others in partners.items() if others}
    counts = {of: round(part * campaigns) for of, part in PARTS.items()}
    counts[OUTSIDE] *= bool(own)
    counts[SINGLE] = max(campaigns - sum(counts[of] for of in (PAIR, NONE, OUTSIDE)), 0)
    numbers = iter(range(1000 * seed, 1000 * seed + 10 * campaigns + 10))
    found = [spec(SINGLE, next(numbers), (n,), allowed(n)) for n in in_turn(rng, known, counts[SINGLE])]
    for first in in_turn(rng, list(partners), counts[PAIR]):
        second = str(rng.choice(partners[first]))
        shared = tuple(sorted(set(allowed(first)) & set(allowed(second))))
        found.append(spec(PAIR, next(numbers), (first, second), shared))
    sound = sorted({b for n in known for b in allowed(n)} - {"coulomb", "viscous", "dry"})
    found += [spec(NONE, next(numbers), (), (b,)) for b in in_turn(rng, sound, counts[NONE])]
    if own:
        found += [spec(OUTSIDE, next(numbers), (n,), allowed(n)) for n in in_turn(rng, own, counts[OUTSIDE])]
    order = np.random.default_rng([seed, 5]).permutation(len(found))
    return [replace(found[k], short=short or found[k].short) for k in order]
