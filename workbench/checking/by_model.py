"""Whether the declared model, fitted to the records, bears out that a channel is shifted in time or has a scale of its own.

Either is suspected from one record by linear laws alone; what a model lacks, a soft joint, a gap or friction that gives way looks like one
there. Put right, a true one leaves the model plainly less of that record's drive.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from workbench.checking.balance import freed
from workbench.checking.seen import Seen
from workbench.checking.shift import BETTER, FARTHEST
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.balances import predicted
from workbench.inverse.dynamics import inverse_dynamics
from workbench.record import IDENTIFICATION, Record


def borne_out(seen: Seen, put_right: Mapping[str, Record]) -> set[str]:
    """Return the names of the records of which the fitted model leaves less than BETTER of the drive's power once they are put right.

    put_right: record -> what it would be. All linear parameters are free. Of a model that has no value on these records nothing is
    borne out or refuted: all names.
    """
    if not put_right:
        return set()
    records = {r.name: r for r in seen.campaign.records}
    try:
        as_logged, mended = (_left(seen, [*named.values()]) for named in (records, {**records, **put_right}))
    except WorkbenchError:
        return {*put_right}
    return {name for name in put_right if mended[name] < BETTER * as_logged[name]}


def earlier(record: Record, channel: str, late: float) -> Record:
    """Return a record with a channel that much earlier, s; its ends hold the value that they had."""
    t, x = record.time, record.channels[channel]
    return replace(record, channels={**record.channels, channel: np.interp(t + late, t, x)})


def divided(record: Record, channel: str, factor: float) -> Record:
    """Return a record with a channel that much smaller."""
    return replace(record, channels={**record.channels, channel: record.channels[channel] / factor})


def _left(seen: Seen, records: list[Record]) -> dict[str, float]:
    """Return record -> share of its drive's power that a fit to all of them leaves, but for its ends."""
    inverses = inverse_dynamics([replace(r, role=IDENTIFICATION) for r in records], seen.campaign.bandwidth)
    plant = identify(freed(seen.campaign.plant), inverses).plant
    left = {}
    for p in inverses:
        m = p.motion
        drive, off = m.filter(np.stack([m.u, predicted(p, plant) - m.u]))[:, m.keep]
        far = min(round(FARTHEST / m.dt), off.size // 4)
        inside = slice(far, off.size - far)
        left[m.record.name] = float(np.sum(off[inside] ** 2) / np.sum(drive[inside] ** 2))
    return left
