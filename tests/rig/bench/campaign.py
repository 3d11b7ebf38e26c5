"""One campaign of a bench whose answer is known: drawn, sized, run, reported, and written as an engineer brings it."""

import gzip
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from rig.bench import balance, measuring
from rig.bench.cause import Cause
from rig.bench.causes import CAUSES, OUTSIDE, possible
from rig.bench.machines import KINDS, Declared, Machine, Stand, drawn, log_uniform
from rig.bench.measuring import Log, Nuisances, Rates
from rig.bench.motions import BROAD, SLOW, Motion, blocked, prbs, small, trapezoids, triangles
from rig.bench.writing import declaration, line, units

SIZES = (0.02, 0.12)  # of the drive's rms: what the declared model cannot absorb of a cause, even in the logarithm
SOUND = 0.025  # of the drive: what the declared laws may leave of a machine that lacks nothing, before nuisances
LEAST, CLOSE, ROUNDS, DRAWS = 0.015, 0.25, 6, 30
IDENTIFICATION, VALIDATION = "identification", "validation"


@dataclass(frozen=True, eq=False)
class Planned:
    name: str
    role: str
    motion: Motion
    start: float


@dataclass(frozen=True, eq=False)
class Bench:
    """A stand with its rates, motions, nuisances and declaration: all but what is missing. drive: rms of the drive."""

    stand: Stand
    rates: Rates
    plan: tuple[Planned, ...]
    nuisances: Nuisances
    seed: int
    drive: float = 0.0

    def logs(self, machine: Machine, role: str, bare: bool = False) -> list[Log]:
        """The records of a role; bare: without nuisances."""
        x, found = self.nuisances, []
        if x.waves and not bare:
            machine = machine.waved("reading", measuring.subdivided(self.stand, x, self.rates, self.drive))
        for k, p in enumerate(self.plan):
            if p.role != role:
                continue
            t = p.start + np.arange(p.motion.reference.size) / self.rates.control
            pushed = None if bare else measuring.disturbance(x, self.drive, [self.seed, 50, k], t, self.rates.control)
            log = measuring.run(machine, p.motion, p.start, self.rates, pushed)
            quiet = replace(Nuisances(noise=0.0)) if bare else x
            found.append(
                measuring.reported(log, self.stand, machine, quiet, self.rates, self.drive or 1.0, [self.seed, 60, k])
            )
        return found


def planned(rng, s: Stand, rates: Rates) -> tuple[Planned, ...]:
    """Three or four records and one for validation; now and then all in one, or many short ones."""
    reach, makes = s.reach, []
    chance = rng.random()
    broad = [BROAD[k] for k in rng.permutation(len(BROAD))]
    # a contact that gives way within a count is not asked for strokes of a few counts
    slow = [m for m in (SLOW[k] for k in rng.permutation(len(SLOW))) if not (s.coulomb and m is small)]
    if chance < 0.08:
        makes = [(prbs, 2.2)]
    elif chance < 0.18:
        makes = [(trapezoids, 0.3)] * 6 + [(broad[0], 1.0), (triangles, 1.0)]
    else:
        makes = [(broad[0], 1.0), (slow[0], 1.0), (broad[1] if rng.random() < 0.5 else slow[1], 0.8)]
    if s.machine.two and rng.random() < 0.4:
        makes.insert(0, (blocked, 0.7))
    found, start, pause = [], 0.0, rng.choice([1.0, 1.0, 8.0])
    for k, (make, share) in enumerate([*makes, (trapezoids, 0.9)]):
        motion = make(rng, reach, round(share * rates.seconds, 1), rates.control)
        last = k == len(makes)
        found.append(
            Planned(
                "check" if last else f"{make.__name__}{k + 1}", VALIDATION if last else IDENTIFICATION, motion, start
            )
        )
        start = round(start + motion.reference.size / rates.control + pause * rng.uniform(2.0, 5.0), 2)
    return tuple(found)


def believed(b: Bench, missing: Sequence[Cause], sizes: Sequence[float], rng=None) -> tuple[Declared, ...]:
    """What is declared: true values, data sheets off by their tolerance (rng: given), and by what is wrong of them."""
    found = []
    for d in b.stand.declared:
        off = [
            1.0 + c.parameters(z)["share"]
            for c, z in zip(missing, sizes, strict=True)
            if c.wrong == d.at and d.effect == "inertia"
        ]
        parameters = []
        for p in d.parameters:
            fixed = p.fixed or bool(off)
            tolerance = (
                1.0 + b.nuisances.tolerance * rng.uniform(-1, 1) if rng is not None and fixed and not off else 1.0
            )
            parameters.append(replace(p, fixed=fixed, value=p.value * tolerance * (off[0] if off else 1.0)))
        found.append(replace(d, parameters=tuple(parameters)))
    return tuple(found)


def values(declared: Sequence[Declared]) -> dict[str, float]:
    """Column -> its factor; the weight and its phase are a sine and a cosine."""
    found = {p.column: p.value for d in declared for p in d.parameters if p.column and not p.column.endswith("_x0")}
    if "sine" in found:
        mgl, phase = found["sine"], found["cosine"]
        found |= {"sine": mgl * np.cos(phase), "cosine": mgl * np.sin(phase)}
    return found


def put_on(b: Bench, missing: Sequence[Cause], sizes: Sequence[float]) -> Machine:
    machine = b.stand.machine
    for c, size in zip(missing, sizes, strict=True):
        machine = c.on(machine, size)
    return machine


def size_of(b: Bench, cause: Cause, size: float, nothing: float) -> float:
    """rms over the drive's of what the declared model cannot absorb of a cause; NaN where the axis does not follow."""
    declared = believed(b, [cause], [size])
    logs = b.logs(put_on(b, [cause], [size]), IDENTIFICATION, bare=True)
    if not followed(b, logs):
        return float("nan")
    x = balance.left(b.stand, declared, values(declared), logs, b.rates.band)
    return float(np.sqrt(max(x.whole(x.fitted()) ** 2 - nothing**2, 0.0)))


def followed(b: Bench, logs: Sequence[Log]) -> bool:
    """Whether the axis does what it is asked to."""
    for log in logs:
        if not np.all(np.isfinite(log.q)) or np.mean(np.abs(log.u) > 0.98 * b.stand.machine.facts.limit) > 0.02:
            return False
        if not log.locked and np.std(log.q - log.reference) > 0.3 * np.std(log.reference) + 0.05 * b.stand.reach.stroke:
            return False
    return True


def sized(b: Bench, cause: Cause, asked: float, nothing: float) -> tuple[float, float]:
    """Return the size to put a cause on with, and what it comes to."""
    best, closest, now = 1.0, float("nan"), 1.0
    for _ in range(ROUNDS):
        found = size_of(b, cause, now, nothing)
        if not np.isfinite(found):
            now *= 0.4
            continue
        if not np.isfinite(closest) or abs(np.log(max(found, 1e-9) / asked)) < abs(np.log(max(closest, 1e-9) / asked)):
            best, closest = now, found
        if abs(np.log(max(found, 1e-9) / asked)) < CLOSE or (found < asked and now >= cause.largest):
            break
        now = float(min(now * np.clip(asked / max(found, 1e-9), 0.1, 10.0), cause.largest))
    return best, closest


def bench(rng, seed: int, kind: str, tolerance: float) -> Bench:
    """A stand that follows its motions."""
    for _ in range(DRAWS):
        rates = measuring.rated(rng)
        s = drawn(rng, kind, rates.log, rates.band)
        b = Bench(s, rates, planned(rng, s, rates), measuring.drawn(rng, s, rates, tolerance), seed)
        logs = {role: b.logs(s.machine, role, bare=True) for role in (IDENTIFICATION, VALIDATION)}
        if not all(followed(b, found) for found in logs.values()):
            continue
        plain = {
            role: balance.left(s, s.declared, values(s.declared), found, rates.band) for role, found in logs.items()
        }
        weights = plain[IDENTIFICATION].fitted()
        if all(part.whole(weights) < SOUND for part in plain.values()):
            return replace(b, drive=plain[IDENTIFICATION].drive)
    raise RuntimeError(f"no {kind} of seed {seed} follows its motions.")


def with_missing(rng, seed: int, names: Sequence[str], kind: str | None, tolerance: float):
    """Draw benches until what is missing can be made large enough; return the bench, causes, their sizes and what they come to."""
    for _ in range(DRAWS):
        b = bench(rng, seed, kind or str(rng.choice(list(KINDS))), tolerance)
        if not all(possible(n, b.stand) for n in names):
            continue
        causes = [(CAUSES.get(n) or OUTSIDE[n])[0](rng, b.stand) for n in names]
        plain = balance.left(
            b.stand,
            b.stand.declared,
            values(b.stand.declared),
            b.logs(b.stand.machine, IDENTIFICATION, True),
            b.rates.band,
        )
        nothing = plain.whole(plain.fitted())
        found = [sized(b, c, log_uniform(rng, *SIZES), nothing) for c in causes]
        if all(size >= LEAST for _, size in found):
            return b, causes, [z for z, _ in found], [size for _, size in found]
    raise RuntimeError(f"{'+'.join(names)}: no bench of seed {seed} shows it.")


def errors(b: Bench, declared: Sequence[Declared], logs: dict[str, list[Log]]) -> dict[str, float]:
    """Role -> nrmse of the declared model, its free parameters fitted on the identification records."""
    parts = {
        role: balance.left(b.stand, declared, values(declared), found, b.rates.band) for role, found in logs.items()
    }
    weights = parts[IDENTIFICATION].fitted()
    return {role: part.error(weights) for role, part in parts.items()}


def campaign(
    folder: Path, seed: int, missing: Sequence[str] = (), *, kind: str | None = None, tolerance: float = 0.01
) -> dict:
    """Write a campaign and return its truth: missing (["unknown"] for what no catalogue has), at, laws, parameters, nrmse of
    the declared model and of the true one (nrmse_declared, nrmse_true, both also _identification), sizes (over the drive's
    rms), where (of an unknown cause), nuisances.

    kind: of machines.KINDS. tolerance: by which fixed values are off at most; written where it is not 1 %.
    """
    rng = np.random.default_rng([seed, 20])
    b, causes, sizes, came = with_missing(rng, seed, missing, kind, tolerance)
    machine = put_on(b, causes, sizes)
    off = np.random.default_rng([seed, 21])
    declared = believed(b, causes, sizes, off)
    logs = {role: b.logs(machine, role) for role in (IDENTIFICATION, VALIDATION)}
    sound = believed(b, (), (), np.random.default_rng([seed, 21]))
    twins = {role: b.logs(b.stand.machine, role) for role in logs} if missing else logs
    now, best = errors(b, declared, logs), errors(b, sound, twins)
    write(Path(folder), b, declared, [log for role in logs.values() for log in role], np.random.default_rng([seed, 22]))
    known = [c.effect for c in causes if c.effect]
    return {
        "missing": known if len(known) == len(causes) else ["unknown"], "parameters": {n: c.parameters(z) for n, c, z in zip(missing, causes, sizes, strict=True)},
        "nrmse_declared": now[VALIDATION], "nrmse_true": best[VALIDATION],
        "nrmse_declared_identification": now[IDENTIFICATION], "nrmse_true_identification": best[IDENTIFICATION],
        "at": [c.at for c in causes], "laws": [c.law for c in causes], "sizes": came, "where": next((c.where for c in causes if c.where), None),
        "kind": b.stand.name, "rate": b.rates.log, "nuisances": asdict(b.nuisances), "drive": b.drive,
    }  # fmt: skip


def write(folder: Path, b: Bench, declared: Sequence[Declared], logs: Sequence[Log], rng) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    unit = units(rng, b.stand)
    (folder / "campaign.toml").write_text(declaration(rng, b, declared, unit), encoding="utf-8")
    for p, log in zip(b.plan, logs, strict=True):
        text = line(b, unit, log)
        with gzip.open(folder / f"{p.name}.csv.gz", "wt", compresslevel=1, encoding="utf-8") as file:
            file.write(text)
