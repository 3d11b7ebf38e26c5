"""Copies of a family of campaigns, as another logger or another engineer would have made them: the answers are the same.

half: every second sample alone, as a log of half the rate has it. noise: white noise of NOISE of the drive's rms in what the drive reports.
swapped: what validated is fitted, and as many of the records that were fitted, the last ones, validate.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from workbench.campaign import Campaign
from workbench.record import IDENTIFICATION, VALIDATION, Record

NOISE = 0.02  # of the rms of a record's drive


def copied(campaign: Campaign, how: str) -> Campaign:
    """Return a campaign as one of COPIES makes it; as it is where `how` is empty."""
    return replace(campaign, records=tuple(COPIES[how](campaign.records))) if how else campaign


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
