"""Scales: of the drive against acceleration, of the encoder against the reference, of time."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.checking.balance import Balance
from workbench.checking.seen import ENCODERS, Seen
from workbench.checking.sign import slopes
from workbench.finding import Finding
from workbench.intake.signals import quantum
from workbench.units import effect_unit

# A data sheet's inertia is off by tens of per cent where a coupling or a payload was left out; units and gear ratios
# are off by more.
FACTOR = 1.5
FRICTION = 3.0  # by which friction itself may differ between two records: cold grease, a drift over hours
CLEAR = 3.0  # times the residual that the own part of inertia must be: what a model lacks is then less than FACTOR
LIKE = 0.7  # correlation with what the other records predict, from which a record's own scale is read
# Logarithmic spread of what is declared about what is true, by which the cause of a wrong scale is told.
SPREAD = {"inertia": 0.1, "viscous": 0.7, "dry": 0.4}
LOAD = {"viscous_friction": "viscous", "linear_damping": "", "coulomb_friction": "dry", "presliding_hysteresis": "dry"}
EFFECT = {  # of a reading that is x times the truth on (inertia, viscous, dry) as fitted: exponents of x
    "drive scale": (1.0, 1.0, 1.0),
    "encoder scale": (-1.0, -1.0, 0.0),
    "time scale": (2.0, 1.0, 0.0),
}
REMEDY = {
    "drive scale": "Check the torque constant, the gear ratio and the unit of the drive's channel.",
    "encoder scale": "Check the unit of the encoder's channel, its counts a revolution and the gear ratio.",
    "time scale": "Check the unit of the time channel and the rate at which was logged.",
}


@dataclass(frozen=True)
class Ratio:
    """A parameter as these records have it over what is declared."""

    kind: str
    fitted: float
    declared: float

    @property
    def log(self) -> float:
        return float(np.log(self.fitted / self.declared))


@dataclass(frozen=True, eq=False)
class Pooled:
    """Least squares over several records. own: parameter -> rms of its part that no other parameter can take over.

    whole: parameter -> rms of its part. left: rms of the residual. All three on one scale.
    """

    values: dict[str, float]
    own: dict[str, float]
    whole: dict[str, float]
    left: float

    def clear(self, name: str) -> bool:
        """Whether a parameter's own part is most of it and stands out of the residual: nothing else can stand for it."""
        own = self.own.get(name, 0.0)
        return own > max(CLEAR * self.left, 0.5 * self.whole.get(name, 0.0))


def pooled(balances: Sequence[Balance]) -> Pooled:
    """Return the fit of all these records; each has a constant and a position term of its own."""
    names = list(dict.fromkeys(n for b in balances for n in b.names if n not in ("constant", "position")))
    count = len(names) + 2 * len(balances)
    gram, moment, power = np.zeros((count, count)), np.zeros(count), 0.0
    for k, b in enumerate(balances):
        first = len(names) + 2 * k
        at = [names.index(n) if n in names else first + (n == "position") for n in b.names]
        gram[np.ix_(at, at)] += b.gram
        moment[at] += b.columns.T @ b.drive
        power += float(b.drive @ b.drive)
    norms = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    inverse = np.linalg.pinv(gram / np.outer(norms, norms), rcond=1e-12, hermitian=True)
    scaled = inverse @ (moment / norms)
    own = np.abs(scaled) / np.sqrt(np.maximum(np.diag(inverse), 1e-300))
    left = float(np.sqrt(max(power - scaled @ (moment / norms), 0.0)))
    values, own, whole = (dict(zip(names, x.tolist(), strict=False)) for x in (scaled / norms, own, np.abs(scaled)))
    return Pooled(values, own, whole, left)


def _predicted(b: Balance, fit: Pooled) -> np.ndarray:
    """Return what these parameters ask of the drive on a record, about its mean; the record's own constant apart."""
    c = np.array([fit.values.get(n, 0.0) for n in b.names])
    made = b.columns @ c
    return made - np.mean(made)


def _jackknife(balances: Sequence[Balance]) -> Iterator[Pooled]:
    """Yield what all records say, and what they say without each half of one: what depends on one half is not known."""
    halves = [h for b in balances for h in b.halves()]
    yield pooled(balances)
    for out in halves:
        yield pooled([h for h in halves if h is not out])


def _beyond(logs: Sequence[float], factor: float) -> bool:
    """Whether all logarithms of factors lie beyond `factor`, on one side."""
    return bool(np.all(np.array(logs) > np.log(factor)) or np.all(np.array(logs) < -np.log(factor)))


def _own_scales(balances: Sequence[Balance], inertia: str) -> dict[str, float]:
    """Return record -> factor of its drive over what all others ask for, where it is too large and the rest agree."""
    left, odd = list(balances), {}
    while len(left) > 2:
        # inertia does not change between records; friction does, with temperature and wear
        limits = {b.record.name: FACTOR if pooled([b]).clear(inertia) else FRICTION for b in left}
        logs = {b.record.name: _own(b, pooled([x for x in left if x is not b]), inertia) for b in left}
        worst = max(left, key=lambda b: abs(logs[b.record.name]) / np.log(limits[b.record.name]))
        name = worst.record.name
        left.remove(worst)
        if not _beyond([logs[name], *(_own(worst, fit, inertia) for fit in _jackknife(left))], limits[name]):
            return odd
        odd[name] = float(np.exp(logs[name]))
    return {}


def _own(b: Balance, fit: Pooled, inertia: str) -> float:
    """Return the logarithm of a record's drive over what `fit` asks for: by inertia alone where that is clear.

    0 where the two are not alike.
    """
    alone = pooled([b])
    if alone.clear(inertia):
        mine, theirs = alone.values[inertia], fit.values.get(inertia, 0.0)
        return float(np.log(mine / theirs)) if mine > 0 and theirs > 0 and fit.clear(inertia) else 0.0
    made, drive = _predicted(b, fit), b.drive - np.mean(b.drive)
    size = float(np.sqrt((made @ made) * (drive @ drive)))
    return float(np.log((drive @ made) / (made @ made))) if made @ drive > LIKE * size > 0 else 0.0


def encoders(seen: Seen) -> Iterator[Finding]:
    """Say which encoder moves another distance than the reference, or than the other encoder."""
    steep = [s for s in slopes(seen.campaign.records) if abs(np.log(abs(s.slope))) > np.log(FACTOR)]
    for s in [s for s in steep if s.other == "reference"] or steep:
        yield Finding(
            "encoder scale", f"{s.record}.{s.channel}",
            f"In record '{s.record}' {s.channel} moves {abs(s.slope):.4g} times as far as {s.other}.",
            {"factor": abs(s.slope)},
            REMEDY["encoder scale"],
        )  # fmt: skip


def _steps(seen: Seen) -> Iterator[Finding]:
    """Say which encoder moves in other steps than its declared resolution: one of the two has another scale."""
    for r in seen.measured:
        for name, declared in r.resolution.items():
            shown = quantum(r.channels[name]) if name in ENCODERS else 0.0
            if shown > 0 and _beyond([float(np.log(shown / declared))], FACTOR):
                yield Finding(
                    "encoder scale", f"{r.name}.{name}",
                    f"In record '{r.name}' {name} moves in steps of {shown:.3g} {r.units[name]}, {shown / declared:.3g} times "
                    f"the declared resolution of {declared:.3g} {r.units[name]}.",
                    {"step": shown, "declared": declared},
                    f"{REMEDY['encoder scale']} Or else mend its resolution.",
                )  # fmt: skip


def drives(seen: Seen) -> Iterator[Finding]:
    """Say which record's drive has a scale of its own, and whether all have another than the declared inertia asks for.

    Where an encoder shows by its steps that the scale is its own, that is said in their place.
    """
    if coarse := list(_steps(seen)):  # inertia would only say the same once more
        yield from coarse
        return
    balances = [b for b in seen.aligned if b.names]
    free = [b for b in balances if not b.record.locked]  # of the joint alone the others say little
    odd = _own_scales(free, seen.inertia)
    for record, factor in odd.items():
        yield Finding(
            "drive scale", f"{record}.{seen.drive}",
            f"In record '{record}' the drive is {factor:.3g} times what the other records ask for the same motion.",
            {"factor": factor},
            REMEDY["drive scale"],
        )  # fmt: skip
    rest = [b for b in balances if b.record.name not in odd]
    if rest and seen.inertia:
        yield from _against_declared(seen, rest)


def _against_declared(seen: Seen, balances: Sequence[Balance]) -> Iterator[Finding]:
    """Compare the inertia that the records have with the declared one, and say what the other parameters say of it."""
    fit = pooled(balances)
    declared = _declared(seen, seen.inertia)
    fitted = fit.values.get(seen.inertia, 0.0)
    if declared <= 0 or fitted <= 0 or not fit.clear(seen.inertia):
        return
    others = (max(other.values.get(seen.inertia, 0.0), 1e-300) for other in _jackknife(balances))
    if not _beyond([float(np.log(other / declared)) for other in others], FACTOR):
        return
    ratios = [Ratio("inertia", fitted, declared), *_friction(seen, fit.values)]
    kind, factor = _cause(ratios, _encoder_step(seen))
    unit = effect_unit("F*s^2/x", seen.campaign.plant.rotary)
    yield Finding(
        kind, {"drive scale": seen.drive, "encoder scale": "position"}.get(kind, "time"),
        f"The drive accelerates an inertia of {fitted:.3g} {unit}, and {declared:.3g} {unit} is declared; this is as if "
        f"the {kind.split()[0]} were read {max(factor, 1 / factor):.3g} times too {'large' if factor > 1 else 'small'}.",
        {"fitted": fitted, "declared": declared, "factor": factor},
        f"{REMEDY[kind]} Or else the declared inertia is wrong.",
    )  # fmt: skip


def _declared(seen: Seen, name: str) -> float:
    key, parameter = name.rsplit(".", 1)
    return seen.campaign.plant[key].parameters[parameter].value


def _friction(seen: Seen, values: dict[str, float]) -> Iterator[Ratio]:
    for name, value in values.items():
        kind = LOAD.get(name.split("@")[0], "")
        declared = _declared(seen, name)
        if kind and declared > 0 and value > 0 and name.split("@")[1].startswith(("axis", "motor")):
            yield Ratio(kind, value, declared)


def _encoder_step(seen: Seen) -> float:
    """Return the step that the position shows over the declared resolution, 1 where one of them is not there."""
    declared = [r.resolution.get("position", 0.0) for r in seen.campaign.records]
    shown = [q for r in seen.measured if (q := quantum(r.channels["position"])) > 0]
    return float(np.median(shown)) / max(declared) if shown and max(declared) > 0 else 1.0


def _cause(ratios: Sequence[Ratio], step: float) -> tuple[str, float]:
    """Return (kind, factor) of the one reading that explains the ratios best: least squares on logarithms."""
    found = {}
    for kind, exponents in EFFECT.items():
        power = dict(zip(SPREAD, exponents, strict=True))
        spread = np.array([*(SPREAD[r.kind] for r in ratios), SPREAD["dry"]])
        # an encoder's step is scaled with what it reads, and by nothing else
        a = np.array([*(power[r.kind] for r in ratios), float(kind == "encoder scale")]) / spread
        y = np.array([*(r.log for r in ratios), np.log(step)]) / spread
        x = float(a @ y) / float(a @ a)
        found[kind] = (float(np.sum((y - a * x) ** 2)), x)
    kind = min(found, key=lambda k: found[k][0])
    return kind, float(np.exp(found[kind][1]))
