"""The loop of a campaign, closed with what a trace found: on which record, or why it is not."""

from dataclasses import replace
from math import isfinite

from workbench.campaign import Campaign
from workbench.description.friction import friction_of
from workbench.errors import WorkbenchError
from workbench.plant import Plant
from workbench.record import VALIDATION, Record
from workbench.tracing.result import Trace
from workbench.verification.closed_loop import ClosedLoop, close
from workbench.verification.closed_loop import as_dict as closed_loop_as_dict
from workbench.verification.wording import NO_INERTIA, NO_LIMIT, NO_RECORD, not_closed


def lacking(plant: Plant, record: Record | None) -> str:
    """Return what a campaign lacks for its loop to be closed, as a sentence; "" where it lacks nothing."""
    if record is None:
        return NO_RECORD
    if not friction_of(plant)[1] > 0.0:
        return NO_INERTIA
    if not isfinite(plant.limits.drive):
        return NO_LIMIT
    return ""


def record_of(campaign: Campaign) -> Record | None:
    """Return the record along which a campaign's loop is closed, None where there is none."""
    return min((r for r in campaign.records if r.role == VALIDATION), key=lambda r: r.name, default=None)


def closed_loop(campaign: Campaign, found: Trace) -> ClosedLoop | str:
    """Return the loop closed with what a trace found, on the validation record whose name comes first, or the sentence why it is not."""
    record = record_of(campaign)
    if missing := lacking(campaign.plant, record):
        return missing
    try:
        return close(_in_order(found.before.plant), _in_order(found.after.plant), record)
    except WorkbenchError as error:
        return not_closed(str(error))


def as_dict(closed: ClosedLoop | str | None) -> dict | None:
    """Return what trace.json holds of a closed loop, of the sentence why there is none, or of none that was asked for."""
    if isinstance(closed, str):
        return {"missing": closed}
    return None if closed is None else closed_loop_as_dict(closed)


def _in_order(plant: Plant) -> Plant:
    """Return the plant with its effects by name: in which order they were declared must not show in the last bits of a sum."""
    return replace(plant, effects=tuple(sorted(plant.effects, key=lambda e: e.key)))
