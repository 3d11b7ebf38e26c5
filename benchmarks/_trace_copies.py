"""Copies of a family of campaigns, as another logger or another engineer would have made them.

Of the records, with the same answers. half: every second sample alone, as a log of half the rate has it. noise: white noise of NOISE of the
drive's rms in what the drive reports. swapped: what validated is fitted, and as many of the records that were fitted, the last ones, validate.

Of the declaration, of campaigns that lack nothing, so that they lack one effect. less: an effect that shows is not declared. wrong: an inertia
or a stiffness is held at a value that is WRONG of what it is, and shows.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from zlib import crc32

import numpy as np

from workbench.campaign import Campaign
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record

NOISE = 0.02  # of the rms of a record's drive
SHOWS = 0.02  # of the drive's rms, that an effect must take away in either role: half of what the authors of campaigns ask for, or less
WRONG = (0.8, 0.87, 1.15, 1.22)


def copied(campaign: Campaign, how: str, truth: dict, name: str = "") -> tuple[Campaign, dict]:
    """Return a campaign, and its truth, as one of COPIES or of DECLARED makes it; as they are where `how` is empty. name: draws what changes."""
    if how in DECLARED:
        return _otherwise_declared(campaign, how, truth, np.random.default_rng(crc32(f"{how} {name}".encode())))
    return (replace(campaign, records=tuple(COPIES[how](campaign.records))) if how else campaign), truth


def lack_nothing(file: Path) -> set[str]:
    """Return the names of the campaigns that lack nothing, by their truth.json."""
    known = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    return {name for name, truth in known.items() if truth["missing"] == []}


def _otherwise_declared(campaign: Campaign, how: str, truth: dict, rng: np.random.Generator) -> tuple[Campaign, dict]:
    """Return a complete campaign with the first change, of those that are drawn, that shows; as it is where none does."""
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    right = identify(campaign.plant, inverses)
    for effect, plant in DECLARED[how](campaign.plant, right.plant, rng):
        try:
            left = identify(plant, inverses)
        except WorkbenchError:  # without it nothing else has a value
            continue
        errors = ((getattr(left, role), getattr(right, role)) for role in (IDENTIFICATION, VALIDATION))
        if all(after**2 - before**2 >= SHOWS**2 for after, before in errors):
            lacks = {"missing": [effect], "nrmse_declared": left.validation, "nrmse_true": right.validation}
            return replace(campaign, plant=plant), truth | lacks
    return campaign, truth


def _less(plant: Plant, solved: Plant, rng: np.random.Generator) -> Iterator[tuple[str, Plant]]:
    """Yield (name, plant without it) of the effects in the order that is drawn; a body keeps its inertia, and a joint its stiffness."""
    needed = {"inertia@axis", "inertia@motor", "inertia@load", "linear_stiffness@joint"}
    for e in rng.permutation(sorted(e.key for e in plant.effects if e.key not in needed)):
        yield str(e).partition("@")[0], plant.without(str(e))


def _wrong(plant: Plant, solved: Plant, rng: np.random.Generator) -> Iterator[tuple[str, Plant]]:
    """Yield (name, plant with a wrong value of it that is held) of inertias and stiffnesses in the order that is drawn."""
    of = {"inertia": "inertia", "linear_stiffness": "stiffness"}
    for key in rng.permutation(sorted(e.key for e in plant.effects if e.name in of)):
        e, name = plant[str(key)], of[str(key).partition("@")[0]]
        value = (e if e.parameters[name].fixed else solved[e.key]).parameters[name].value
        yield e.name, plant.swap(e(**{name: value * float(rng.choice(WRONG))}, fixed=True))


def _halved(records: Sequence[Record]) -> list[Record]:
    return [
        replace(r, time=r.time[::2].copy(), channels={n: x[::2].copy() for n, x in r.channels.items()}) for r in records
    ]


def _noisy(records: Sequence[Record]) -> list[Record]:
    found = []
    for seed, r in enumerate(records):
        drive = "force" if "force" in r.channels else "torque"
        x = r.channels[drive]
        noise = NOISE * np.sqrt(np.mean(x**2)) * np.random.default_rng(seed).standard_normal(x.size)
        found.append(replace(r, channels={**r.channels, drive: x + noise}))
    return found


def _swapped(records: Sequence[Record]) -> list[Record]:
    """At least one record that was fitted still is, if there are two."""
    fitted = [r.name for r in records if r.role == IDENTIFICATION]
    much = min(len(records) - len(fitted), max(1, len(fitted) - 1))
    validate = set(fitted[-much:])
    return [replace(r, role=VALIDATION if r.name in validate else IDENTIFICATION) for r in records]


COPIES: Mapping[str, Callable[[Sequence[Record]], list[Record]]] = {
    "half": _halved,
    "noise": _noisy,
    "swapped": _swapped,
}
DECLARED: Mapping[str, Callable[[Plant, Plant, np.random.Generator], Iterator[tuple[str, Plant]]]] = {
    "less": _less,
    "wrong": _wrong,
}
