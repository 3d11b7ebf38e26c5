"""Whether the declared model, fitted to the records, bears out that a channel is shifted in time.

A shift is suspected from one record alone, and what a model lacks, a soft joint or friction behind a gap looks like one there. Put
right, a true one leaves the model plainly less of the drive in every record that has it.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from workbench.checking.balance import freed
from workbench.checking.seen import Seen
from workbench.checking.shift import BETTER
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.balances import predicted
from workbench.inverse.dynamics import inverse_dynamics
from workbench.record import IDENTIFICATION, Record


def borne_out(seen: Seen, channel: str, late: Mapping[str, float]) -> set[str]:
    """Return the names of the records of which the fitted model leaves less than BETTER of the drive's residual power once a channel is put back.

    late: record -> s by which the channel comes late there. All linear parameters are free. Of a model that has no value on
    these records nothing is borne out or refuted: all names.
    """
    if not late:
        return set()
    try:
        as_logged, put_back = (_left(seen, channel, shifts) for shifts in ({}, late))
    except WorkbenchError:
        return {*late}
    return {name for name in late if put_back[name] < BETTER * as_logged[name]}


def _left(seen: Seen, channel: str, late: Mapping[str, float]) -> dict[str, float]:
    """Return record -> mean square of what a fit to all of them leaves of the drive."""
    records = [_earlier(replace(r, role=IDENTIFICATION), channel, late.get(r.name, 0.0)) for r in seen.campaign.records]
    inverses = inverse_dynamics(records, seen.campaign.bandwidth)
    plant = identify(freed(seen.campaign.plant), inverses).plant
    left = {}
    for p in inverses:
        m, far = p.motion, max((round(abs(s) / p.motion.dt) for s in late.values()), default=0)
        off = m.filter(predicted(p, plant) - m.u)[m.keep]
        left[m.record.name] = float(np.mean(off[far : off.size - far] ** 2))
    return left


def _earlier(record: Record, channel: str, late: float) -> Record:
    """Return a record with a channel that much earlier, s; its ends hold the value that they had."""
    if not late:
        return record
    t, x = record.time, record.channels[channel]
    return replace(record, channels={**record.channels, channel: np.interp(t + late, t, x)})
