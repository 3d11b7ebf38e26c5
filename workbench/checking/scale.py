"""Scales: of the drive against acceleration, of the encoder against the reference, of time."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.checking.balance import Balance
from workbench.checking.by_model import borne_out, divided
from workbench.checking.misreading import DRIVE, ENCODER, TIME, Misread, Ratio, cause
from workbench.checking.seen import ENCODERS, Seen
from workbench.checking.sign import slopes
from workbench.intake.signals import quantum
from workbench.parameter import Parameter
from workbench.units import effect_unit

# A data sheet's inertia is off by tens of per cent where a coupling or a payload was left out; units and gear ratios
# are off by more.
FACTOR = 1.5
# The same of an inertia that a fit finds: where it started was off by 7 on a bench, and units are off by more
GUESSED = 8.0
FRICTION = 3.0  # by which friction itself may differ between two records: cold grease, a drift over hours
CLEAR = 3.0  # times the residual that the own part of inertia must be: what a model lacks is then less than FACTOR
LIKE = 0.7  # correlation with what the other records predict, from which a record's own scale is read
LOAD = {"viscous_friction": "viscous", "linear_damping": "", "coulomb_friction": "dry", "presliding_hysteresis": "dry"}


@dataclass(frozen=True)
class Farther:
    """An encoder moves `factor` times as far as another channel of its record."""

    record: str
    channel: str
    other: str
    factor: float


@dataclass(frozen=True)
class OtherStep:
    """An encoder moves in steps of `step`, and `declared` is its resolution; both in `unit`, rad or m."""

    record: str
    channel: str
    unit: str
    step: float
    declared: float


@dataclass(frozen=True)
class OwnScale:
    """A record's drive is `factor` times what the other records ask for the same motion."""

    record: str
    channel: str
    factor: float


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


def encoders(seen: Seen) -> Iterator[Farther]:
    """Yield which encoder moves another distance than the reference, or than the other encoder."""
    steep = [s for s in slopes(seen.campaign.records) if abs(np.log(abs(s.slope))) > np.log(FACTOR)]
    for s in [s for s in steep if s.other == "reference"] or steep:
        yield Farther(s.record, s.channel, s.other, abs(s.slope))


def _steps(seen: Seen) -> Iterator[OtherStep]:
    """Yield which encoder moves in other steps than its declared resolution: one of the two has another scale."""
    for r in seen.measured:
        for name, declared in r.resolution.items():
            shown = quantum(r.channels[name]) if name in ENCODERS else 0.0
            if shown > 0 and _beyond([float(np.log(shown / declared))], FACTOR):
                yield OtherStep(r.name, name, r.units[name], shown, declared)


def drives(seen: Seen) -> Iterator[OtherStep | OwnScale | Misread]:
    """Yield which record's drive has a scale of its own, and whether all have another than the declared inertia asks for.

    Where an encoder shows by its steps that the scale is its own, that is given in their place.
    """
    if coarse := list(_steps(seen)):  # inertia would only tell the same once more
        yield from coarse
        return
    balances = [b for b in seen.aligned if b.names]
    free = [b for b in balances if not b.record.locked]  # of the joint alone the others say little
    odd = _own_scales(free, seen.inertia)
    records = {b.record.name: b.record for b in free}
    told = borne_out(seen, {name: divided(records[name], seen.drive, factor) for name, factor in odd.items()})
    odd = {name: factor for name, factor in odd.items() if name in told}
    yield from (OwnScale(record, seen.drive, factor) for record, factor in odd.items())
    rest = [b for b in balances if b.record.name not in odd]
    if rest and seen.inertia:
        yield from _against_declared(seen, rest)


def _against_declared(seen: Seen, balances: Sequence[Balance]) -> Iterator[Misread]:
    """Compare the inertia that the records have with the declared one, and yield what the other parameters tell of it."""
    fit = pooled(balances)
    inertia = _declared(seen, seen.inertia)
    declared = inertia.value
    fitted = fit.values.get(seen.inertia, 0.0)
    if declared <= 0 or fitted <= 0 or not fit.clear(seen.inertia):
        return
    others = (max(other.values.get(seen.inertia, 0.0), 1e-300) for other in _jackknife(balances))
    if not _beyond([float(np.log(other / declared)) for other in others], FACTOR if inertia.fixed else GUESSED):
        return
    ratios = [Ratio("inertia", fitted, declared), *_friction(seen, fit.values)]
    kind, factor = cause(ratios, _encoder_step(seen))
    unit = effect_unit("F*s^2/x", seen.campaign.plant.rotary)
    channel = {DRIVE: seen.drive, ENCODER: "position", TIME: "time"}[kind]
    yield Misread(kind, channel, factor, fitted, declared, unit)


def _declared(seen: Seen, name: str) -> Parameter:
    """Return a parameter as it is declared: fixed, a data sheet's, or where a fit is to start."""
    key, parameter = name.rsplit(".", 1)
    return seen.campaign.plant[key].parameters[parameter]


def _friction(seen: Seen, values: dict[str, float]) -> Iterator[Ratio]:
    for name, value in values.items():
        kind = LOAD.get(name.split("@")[0], "")
        declared = _declared(seen, name).value
        if kind and declared > 0 and value > 0 and name.split("@")[1].startswith(("axis", "motor")):
            yield Ratio(kind, value, declared)


def _encoder_step(seen: Seen) -> float:
    """Return the step that the position shows over the declared resolution, 1 where one of them is not there."""
    declared = [r.resolution.get("position", 0.0) for r in seen.campaign.records]
    shown = [q for r in seen.measured if (q := quantum(r.channels["position"])) > 0]
    return float(np.median(shown)) / max(declared) if shown and max(declared) > 0 else 1.0
