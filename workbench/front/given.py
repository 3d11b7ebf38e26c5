"""What an engineer hands in, in the form that the packages take: a campaign, a plant, sound records."""

from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

import numpy as np

from workbench.campaign import BAND, Campaign, load
from workbench.errors import WorkbenchError
from workbench.identification.result import Fit
from workbench.plant import DRIVES, TWO_MASS, Plant
from workbench.record import Record
from workbench.tracing.result import Trace

Model: TypeAlias = Plant | Fit | Trace | Campaign
Measured: TypeAlias = Model | str | Path
UNEVEN = 0.01  # of the time step, by which steps may differ: what a campaign's records are held to as well


def plant_of(model: Measured) -> Plant:
    """Return the plant of a model: its own, as fitted, or as declared by a campaign or its folder."""
    if isinstance(model, Plant):
        return model
    if isinstance(model, Fit | Trace | Campaign):
        return model.plant
    if isinstance(model, str | Path):
        return load(model).plant
    raise WorkbenchError(
        f"a plant is needed, or what has one (Fit, Trace, Campaign, a folder); this is {_kind(model)}."
    )


def campaign_of(
    model: Measured, records: Record | Sequence[Record] | None = None, bandwidth: float | None = None
) -> Campaign:
    """Return the campaign of a folder; or what a campaign, fit or trace was made of, with these records and this bandwidth.

    bandwidth: Hz. WorkbenchError where a plant comes without records or bandwidth, or records are not sound.
    """
    if isinstance(model, str | Path):
        model = load(model)
    fit = model.before if isinstance(model, Trace) else model
    if records is None:
        records = () if isinstance(fit, Plant) else getattr(fit, "records", ())
    records = (records,) if isinstance(records, Record) else tuple(records)
    bandwidth = getattr(fit, "bandwidth", None) if bandwidth is None else bandwidth
    plant = plant_of(model)
    if not records:
        raise WorkbenchError("a plant alone has no records: hand them in too, records=[...], or a campaign.")
    if bandwidth is None or not 0.0 < bandwidth < BAND / max(r.dt for r in records):
        raise WorkbenchError(
            f"the bandwidth is {bandwidth}; state bandwidth=, in Hz, below which errors are compared: above 0 and below "
            f"{BAND / max(r.dt for r in records):.4g} Hz, {BAND:g} of the slowest record's rate."
        )
    if isinstance(model, Campaign) and records == model.records and bandwidth == model.bandwidth:
        return model
    for record in records:
        _insist_sound(record, plant)
    return Campaign(Path("."), "made", plant, records, float(bandwidth))


def _insist_sound(record: Record, plant: Plant) -> None:
    """Raise WorkbenchError unless a record has the plant's channels, finite, of one length, at one rate."""
    needed = (DRIVES[plant.rotary], "position", *(("load_position",) if plant.kind == TWO_MASS else ()))
    for name in needed:
        if name not in record.channels:
            raise WorkbenchError(
                f"record '{record.name}' has no channel '{name}', which a {plant.kind} plant needs; it has "
                f"{', '.join(record.channels)}."
            )
    for name, values in (("time", record.time), *record.channels.items()):
        if np.shape(values) != (record.time.size,) or not np.isfinite(values).all():
            raise WorkbenchError(
                f"record '{record.name}', {name}: {record.time.size} finite numbers are needed, one a sample; the shape is "
                f"{np.shape(values)}."
            )
    steps = np.diff(record.time)
    if steps.size < 2 or not np.abs(steps - np.median(steps)).max() <= UNEVEN * np.median(steps):
        raise WorkbenchError(f"record '{record.name}': time must rise in even steps; interpolate it at one rate first.")


def _kind(value: object) -> str:
    return f"of type '{type(value).__name__}'"
