"""What to record next, and what a shaken record says: plan, separate, response."""

from collections.abc import Callable, Sequence

from workbench import frequency, planning
from workbench.campaign import Campaign
from workbench.errors import WorkbenchError, nearest
from workbench.frequency import Response
from workbench.front.given import Measured, campaign_of
from workbench.planning import Plan, Separation
from workbench.planning.basis import ACCURACY, basis
from workbench.record import Record
from workbench.tracing.separation import separation_of

Say = Callable[[str], None]


def plan(
    model: Measured,
    records: Record | Sequence[Record] | None = None,
    *,
    bandwidth: float | None = None,
    accuracy: float = ACCURACY,
    low: float | None = None,
    high: float | None = None,
    speed: float | None = None,
    acceleration: float | None = None,
    drive: float | None = None,
    progress: Say | None = None,
) -> Plan:
    """Return motions to record next that determine every parameter of a model: the D-optimal ones of a pool, joined.

    model, records, bandwidth: as of `identify`; every value is freed. accuracy: half width of the 95 % interval asked for, a
    share of each value. low, high (rad or m), speed, acceleration, drive (SI): limits of the motion; those that the plant
    states and the records have shown where absent. Of the Plan: `trajectory` (time, position), `promised` intervals.
    Raises WorkbenchError where no motion is within the limits.
    """
    limits = {"low": low, "high": high, "speed": speed, "acceleration": acceleration, "drive": drive}
    start = basis(campaign_of(model, records, bandwidth), limits=_stated(limits))
    say = progress or (lambda _: None)
    return planning.design(start.fit.plant, start.envelope, start.sensing, accuracy, progress=say)


def separate(
    model: Measured,
    first: str,
    second: str,
    records: Record | Sequence[Record] | None = None,
    *,
    bandwidth: float | None = None,
    low: float | None = None,
    high: float | None = None,
    speed: float | None = None,
    acceleration: float | None = None,
    drive: float | None = None,
) -> Separation:
    """Return the motion along which two effects that explain the same records differ most.

        sin(angle) = |r|/|r_0|,   deviations = r'r/sqrt(r' S r)

    r is what the model with the one effect cannot absorb of the other, r_0 what the model without both cannot, S the noise.
    first, second: "effect" or "effect@place". model, records, bandwidth and limits: as of `plan`. Of the Separation: `apart`,
    `sentence`, `reference` (the motion). Raises WorkbenchError for an effect that is no candidate, with the nearest names.
    """
    limits = {"low": low, "high": high, "speed": speed, "acceleration": acceleration, "drive": drive}
    return separation_of(basis(campaign_of(model, records, bandwidth), limits=_stated(limits)), first, second)[0]


def _stated(limits: dict[str, float | None]) -> dict[str, float]:
    return {name: value for name, value in limits.items() if value is not None}


def response(
    model: Record | Measured, record: str | None = None, *, channel: str = "position", seconds: float | None = None
) -> Response:
    """Return the frequency response of a record, acceleration over drive, (rad/s^2)/(N*m) or (m/s^2)/N, with its modes.

    Over whole periods where the drive repeats, else by Welch's averages. model: a Record, or a campaign, folder or fit:
    then `record` names one of its records, that whose drive shakes most evenly where absent. channel: "position" or
    "load_position". seconds: length of a segment. Of the Response: frequency (n,) Hz, value (n,) complex, coherence (n,),
    `modes`. Raises WorkbenchError for a record that is too short, or a name that is not there.
    """
    chosen = model if isinstance(model, Record) else _chosen(campaign_of(model), record)
    positions = [name for name in chosen.channels if name.endswith("position")]
    if channel not in positions:
        raise WorkbenchError(f"'{channel}' is no position of record '{chosen.name}'; {nearest(channel, positions)}")
    return frequency.response_of(chosen, channel=channel, seconds=seconds)


def _chosen(campaign: Campaign, name: str | None) -> Record:
    known = {r.name: r for r in campaign.records}
    if name is None:
        return frequency.shaken(campaign.records, campaign.bandwidth)
    if name not in known:
        raise WorkbenchError(f"there is no record '{name}'; {nearest(name, known)}")
    return known[name]
