"""Modes that a plant declared as one mass does not have, from the frequency response of the record that is shaken most."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from workbench.checking.seen import Seen
from workbench.errors import WorkbenchError
from workbench.frequency import Response, fit_modes, response_of, shaken
from workbench.frequency.modes import Mode
from workbench.plant import ONE_MASS, Plant
from workbench.record import Record

RISES = 2.0  # factor by which a resonance must rise: below, it is a slope of friction in presliding
DAMPEST = 0.15  # damping ratio above which it may be the axis on its own presliding stiffness


@dataclass(frozen=True)
class Undeclared:
    """A mode that a record shows below the evaluation bandwidth, and that the declared single mass does not have."""

    record: str
    mode: Mode


def _resonances(records: Sequence[Record], plant: Plant, bandwidth: float) -> tuple[Response | None, list]:
    """Return (response of the record that is shaken most, modes below the bandwidth that one mass cannot have).

    The response is None where nothing shakes the axis, or where the plant declares more than one mass.
    """
    if plant.kind != ONE_MASS or any(e.name == "flexible_mode" for e in plant.effects):
        return None, []
    try:
        response = response_of(shaken(records, bandwidth))
        found = fit_modes(response).modes
    except WorkbenchError:
        return None, []
    return response, [m for m in found if m.frequency < bandwidth and m.rise > RISES and m.damping < DAMPEST]


def all_resonances(records: Sequence[Record], plant: Plant, bandwidth: float) -> tuple[Response | None, list]:
    """Return the resonances, those that the plant declares among them; (None, []) where none shows, or there are no records."""
    for e in plant.effects:
        plant = plant.without(e.key) if e.name == "flexible_mode" else plant
    response, modes = _resonances(records, plant, bandwidth) if records else (None, [])
    return (response, modes) if modes else (None, [])


def undeclared(seen: Seen) -> Iterator[Undeclared]:
    """Yield which resonances below the evaluation bandwidth one mass cannot have."""
    response, found = _resonances(seen.campaign.records, seen.campaign.plant, seen.campaign.bandwidth)
    yield from (Undeclared(response.record, m) for m in found)
