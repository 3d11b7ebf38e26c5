"""One campaign whose answer is known: drawn, run, measured with noise, and written as an engineer would bring it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil
from pathlib import Path

import numpy as np

from rig.bases import Base, based, declaration
from rig.effects import EFFECTS, Kind
from rig.kernel import RATE
from rig.machine import ENDS, Machine, Run, Target, beyond, columns, run, stacked, unexplained
from rig.motions import LOCKED, RECORDS, Planned
from rig.signals import low_pass, noise

COUNT = 4.848e-6  # rad, encoder
COARSER = 5.4  # how much coarser the motor's encoder is than the load's, seen at the output
BAND = 150.0  # Hz, evaluation bandwidth
LEVEL = 4.0  # size 1: what the declared model cannot absorb of an effect is this many times the noise in the band
ROLES = ("identification", "validation")
CLOSE, ROUNDS, REACH = 0.03, 8, 30.0  # how an effect is brought to its size
YIELDS = (
    0.5  # of the joint's deflection (rms) that an effect must leave: one that locks the joint makes another machine
)


@dataclass(frozen=True)
class Measuring:
    """How a rig is measured: Hz of the log and of the band, rms and memory (s) of the torque noise, the encoder's count in
    rad, and whether the records are short."""

    rate: int = 1000
    band: float = BAND
    noise: float = 2e-3
    memory: float = 0.0
    count: float = COUNT
    short: bool = False

    def counts(self, two: bool) -> tuple[float, float]:
        """Width of a count of the encoder and, on two masses, of the load's, which is the finer."""
        return (COARSER * self.count, self.count) if two else (self.count, 0.0)


@dataclass(frozen=True)
class Missing:
    """One thing that is missing of a machine, as it was drawn and sized."""

    name: str
    at: str
    p: tuple[float, ...]

    @property
    def kind(self) -> Kind:
        return EFFECTS[self.name]


def runs(
    machine: Machine, seed: int, how: Measuring, records: Sequence[Planned], roles: Sequence[str] = ROLES
) -> list[Run]:
    """The records of these roles, with motions and starts that depend on the seed alone."""
    rng = np.random.default_rng([seed, 1])
    found, start = [], 0.0
    for planned in records:
        motion = planned.make(rng, how.short)
        if planned.role in roles:
            found.append(run(machine, start, motion, how.rate))
        start = float(ceil(start + motion.reference.size / 4000.0 + 2.0))
    return found


def with_missing(base: Base, missing: Sequence[Missing]) -> tuple[Machine, Machine]:
    """Return the machine as it is, and as it is believed to be (where a declared value is wrong, the two differ)."""
    machine, believed = base.machine, base.machine
    for m in missing:
        machine = m.kind.on(machine, m.at, m.p)
        if m.kind.wrong is not None:
            believed = believed.put(m.kind.wrong, believed.get(m.kind.wrong) * (1.0 - m.p[0]))
    return machine, believed


class Scale:
    """The size of an effect: the rms, over that of the noise, of what the declared model cannot absorb of the torque that it
    changes. Both are taken below the band on the identification records; noise is of the torque and of encoder counts. wrong:
    targets that a data sheet states, and nobody fits."""

    def __init__(
        self, base: Base, seed: int, how: Measuring, records: Sequence[Planned], wrong: set[Target] = frozenset()
    ):
        self.base, self.seed, self.how = base, seed, how
        self.records, self.roles = records, ("identification",)
        counts = how.counts(base.machine.two)
        nominal = runs(base.machine, seed, how, records, self.roles)
        free = [t for e in base.declared if not wrong & {s.target for s in e.parameters} for t in e.free]
        self.columns = columns(base.machine, free, nominal, how.band)
        self.own = self.left(base.machine, nominal)
        self.deflection = deflection(nominal)
        counted = stacked(base.machine, [r.counted(*counts) for r in nominal], how.band, *counts)
        exact = stacked(base.machine, nominal, how.band)
        self.floor = float(np.hypot(how.noise, np.sqrt(np.mean((counted - exact) ** 2))))

    def left(self, believed: Machine, made: Sequence[Run]) -> float:
        y = stacked(believed, made, self.how.band)
        return float(np.sqrt(np.mean(beyond(self.columns, y) ** 2)))

    def size(self, m: Missing) -> float:
        """Return the size of an effect; NaN where it leaves the joint less than YIELDS of its deflection, or no load."""
        machine, believed = with_missing(self.base, [m])
        if not machine.two == believed.two == self.base.machine.two:
            return float("nan")
        made = runs(machine, self.seed, self.how, self.records, self.roles)
        if machine.two and deflection(made) < YIELDS * self.deflection:
            return float("nan")
        left = self.left(believed, made)
        return float(np.sqrt(max(left**2 - self.own**2, 0.0)) / self.floor)

    def sized(self, m: Missing, over: float) -> tuple[Missing, float]:
        """Return the effect as large as asked, or as near as it comes, and its size."""
        best, closest, most = m, self.size(m), np.inf
        now, size = best, closest
        for _ in range(ROUNDS):
            if abs(np.log(max(size, 1e-9) / over)) < CLOSE or not np.isfinite(size):
                break
            if size < over and abs(now.p[0]) >= m.kind.largest(self.base):
                break
            factor = float(np.clip(over / max(size, 1e-9), 1 / REACH, REACH))
            asked = float(np.copysign(min(abs(now.p[0] * factor), m.kind.largest(self.base)), now.p[0]))
            if abs(asked) >= most:  # half of the way to what locks the joint
                asked = float(np.copysign(np.sqrt(abs(best.p[0]) * most), asked))
            tried = replace(now, p=(asked, *now.p[1:]))
            found = self.size(tried)
            if not np.isfinite(found):
                now, size, most = best, closest, min(most, abs(tried.p[0]))
                continue
            now, size = tried, found
            if abs(np.log(max(size, 1e-9) / over)) < abs(np.log(max(closest, 1e-9) / over)):
                best, closest = now, size
        return best, closest


def deflection(made: Sequence[Run]) -> float:
    """Return the rms of the joint's deflection about its mean, where the load is free."""
    return float(
        np.sqrt(np.mean(np.concatenate([(r.q - r.ql) - np.mean(r.q - r.ql) for r in made if not r.locked]) ** 2))
    )


def drawn(rng, base: Base, name: str) -> Missing:
    kind = EFFECTS[name]
    known = [
        at for at in kind.places if at not in ("axis", "motor", "load", "joint") or (at == "axis") != base.machine.two
    ]
    at = known[0] if len(known) == 1 else str(rng.choice(known))
    return Missing(name, at, tuple(float(x) for x in kind.draw(rng, base)))


def written(
    folder: Path, base: Base, made: Sequence[Run], records: Sequence[Planned], how: Measuring, rng
) -> dict[str, float]:
    """Write a CSV a record, torque with noise and positions in counts; return role -> power of the torque below the band."""
    counts, two, x = how.counts(base.machine.two), base.machine.two, base.metres or 1.0
    power = dict.fromkeys(ROLES, 0.0)
    for r, planned in zip(made, records, strict=True):
        torque = r.u + noise(rng, r.u.size, how.noise, r.rate, how.band, how.memory)
        keep = slice(round(ENDS * r.rate), -round(ENDS * r.rate))
        power[planned.role] += float(np.sum(low_pass(torque, r.rate, how.band)[keep] ** 2))
        counted = r.counted(*counts)
        columns = [r.t, torque * base.newtons, counted.q * x, *([counted.ql] if two else [])]
        head = ["time_s", "torque" if base.rotary else "force", "position", *(["load_position"] if two else [])]
        line = "%.5f,%.7g" + ",%.11g" * (1 + two)
        text = "\n".join(map(line.__mod__, map(tuple, np.column_stack(columns).tolist())))
        (folder / f"{planned.name}.csv").write_text(f"{','.join(head)}\n{text}\n", encoding="utf-8")
    return power


def bring(
    folder: Path, title: str, base: Base, made: Sequence[Run], records: Sequence[Planned], how: Measuring, rng,
    guess: dict[Target, float] | None = None,
) -> dict[str, float]:  # fmt: skip
    """Write campaign.toml and its records; guess: what is declared (the truth where it is None). Returns what `written` does."""
    folder.mkdir(parents=True, exist_ok=True)
    guess = guess or {s.target: base.machine.get(s.target) for e in base.declared for s in e.parameters}
    starts, locked = [r.start for r in made], [r.locked for r in made]
    text = declaration(base, guess, title, records, starts, locked, how.counts(base.machine.two), how.band)
    (folder / "campaign.toml").write_text(text, encoding="utf-8")
    return written(folder, base, made, records, how, rng)


def floors(
    base: Base, made: Sequence[Run], records: Sequence[Planned], how: Measuring, power: dict[str, float]
) -> dict[str, float]:
    """Return role -> nrmse that the true model leaves: noise of the torque, and what the encoder's counts do to the rest.

    Taken on the machine with nothing missing, whose residual (of the motor's balance, on two masses) is that alone.
    """
    counts, two = how.counts(base.machine.two), base.machine.two
    left = dict.fromkeys(ROLES, 0.0)
    for r, planned in zip(made, records, strict=True):
        y = unexplained(base.machine, r.counted(*counts), how.band, *counts)
        y = y[: y.size // 2] if two and not r.locked else y
        left[planned.role] += float(np.sum(y**2)) + y.size * how.noise**2
    return {role: float(np.sqrt(left[role] / power[role])) for role in ROLES if power[role] > 0.0}


def guessed(rng, base: Base, believed: Machine, wrong: set[Target]) -> tuple[Base, dict]:
    """Return the declaration and what it says of each target: data sheets as believed, the rest roughly."""
    guess, declared = {}, []
    for e in base.declared:
        stated = tuple(replace(s, fixed=s.fixed or s.target in wrong) for s in e.parameters)
        if any(s.target in wrong for s in stated):  # a data sheet states all that it states
            stated = tuple(replace(s, fixed=True) for s in stated)
        for s in stated:
            guess[s.target] = believed.get(s.target) * (1.0 if s.fixed else rng.uniform(0.9, 1.1))
        declared.append(replace(e, parameters=stated))
    return replace(base, declared=tuple(declared)), guess


def campaign(
    folder: Path, seed: int, missing: Sequence[str] = ("stribeck_friction",), size: float = 1.0, *,
    base: str = "presliding", noise: float = 2e-3, memory: float = 0.0, count: float = COUNT, rate: int = 1000,
    band: float = BAND, short: bool = False, ratio: float = 30.0, references: Sequence[Planned] = (),
) -> dict:  # fmt: skip
    """Write a campaign folder whose declared model lacks `missing`, and return the truth.

    size: what the declared model cannot absorb of each effect, in units of LEVEL times the noise in the band. base: a key of
    bases.ONE_MASS, or one of TWO_MASS. noise: rms of the torque noise below the band, N*m, white or with a correlation of
    `memory` s. count: of the encoder, rad (on two masses the load's; the motor's is coarser). rate: of the log, Hz, a divisor
    of 20 kHz. short: records of a third of the length. ratio: of the gear. references: further records, made by
    `following`, after the four (on two masses five) of every campaign.

    The truth: missing (as a trace should name it, ["unknown"] for what no catalogue has), effects (as asked for), also (see Base), at, sizes
    (over the noise, as they came out), parameters, axis, floor (role -> nrmse that the true model leaves), where (of a cause
    outside the catalogue: coordinate and spans, in rad), metres (travel that is one rad; 1 on a rotary axis), and rig: the
    machine as it is.
    """
    if RATE % rate:
        raise ValueError(f"a log at {rate} Hz does not divide the integration's {RATE} Hz.")
    rng = np.random.default_rng([seed, 0])
    how = Measuring(rate, band, noise, memory, count, short)
    sound = replace(based(rng, base, count), ratio=ratio)
    two = sound.machine.two
    sound = replace(sound, machine=sound.machine.put("count", how.counts(two)[0]))
    records = (*((LOCKED,) if two else ()), *RECORDS, *references)
    wrong = {EFFECTS[name].wrong for name in missing} - {None}
    scale = Scale(sound, seed, how, records, wrong) if missing else None
    found, sizes = [], []
    for name in missing:
        m = drawn(rng, sound, name)
        m, over = (m, scale.size(m)) if m.kind.natural else scale.sized(m, size * LEVEL)
        found.append(m)
        sizes.append(over)
    machine, believed = with_missing(sound, found)
    nominal = runs(sound.machine, seed, how, records)
    made = runs(machine, seed, how, records) if missing else nominal
    stated, guess = guessed(rng, sound, believed, wrong)
    power = bring(
        Path(folder), f"rig {seed}: {'two masses' if two else 'one mass'}", stated, made, records, how, rng, guess
    )
    known = [m.kind.effect for m in found if m.kind.effect]
    seconds = made[-1].t[-1]
    return {
        "missing": known if len(known) == len(found) else ["unknown"],
        "effects": list(missing),
        "also": [] if set(known) & set(sound.also) else list(sound.also),
        "at": [m.at for m in found],
        "sizes": sizes,
        "parameters": {m.name: dict(zip(m.kind.names, m.p, strict=True)) for m in found},
        "axis": {k: getattr(sound.machine.axis, k) for k in ("inertia", "viscous", "h0", "rate")},
        "floor": floors(sound, nominal, records, how, power),
        "where": next((m.kind.where(m.p, seconds) for m in found if m.kind.where), None),
        "metres": sound.metres or 1.0,
        "rig": machine,
    }
