"""A campaign: the folder that an engineer brings, with the records and the plant that they believe in.

`load` turns it into frozen values, SI inside, or refuses with one sentence that names file, row or key, and the mend.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType

from workbench.errors import UnsoundRecord
from workbench.finding import SAMPLING_RATE, Finding
from workbench.plant import KINDS, TWO_MASS, Plant
from workbench.readers import declaration
from workbench.readers.channels import assumptions, channels
from workbench.readers.of_stroke import in_length
from workbench.readers.own_unit import in_effort, in_own_words
from workbench.readers.plant import declared_plant
from workbench.readers.records import records
from workbench.readers.starts import promised
from workbench.record import Record

FILE = "campaign.toml"
BAND = 0.45  # of the sampling rate: what is left below Nyquist for the filters to fall
SLOWEST = 1e-6  # Hz of a band: no record lasts so long, and the filter of a slower one has no number


@dataclass(frozen=True)
class Campaign:
    """folder: as given. bandwidth: Hz, below which errors are compared. records: in the order declared.

    findings: what was done to the data on the way in (resampled). notes: key path -> text that its writer left. tolerance: share by
    which a fixed value may be off, where the campaign says so.
    """

    folder: Path
    title: str
    plant: Plant
    records: tuple[Record, ...]
    bandwidth: float
    findings: tuple[Finding, ...] = ()
    notes: Mapping[str, str] = field(default_factory=dict)
    tolerance: float | None = None

    def __post_init__(self):
        object.__setattr__(self, "notes", MappingProxyType(dict(self.notes)))

    def with_role(self, role: str) -> tuple[Record, ...]:
        """Return the records of one role, "identification" or "validation"."""
        return tuple(r for r in self.records if r.role == role)


def load(folder: Path | str, *, resample: bool = False) -> Campaign:
    """Return the campaign of a folder that holds campaign.toml and its records.

    resample: records whose time steps differ by more than 1 % are interpolated at their median step, and a finding says
    so, and one with a gap of more than ten steps is cut there; else, and unless the campaign itself says `resample = true`, they are refused. Raises WorkbenchError for whatever the engineer can mend.
    """
    folder = Path(folder)
    top = declaration.read(
        folder / FILE,
        ("title", "plant", "evaluation_bandwidth", "channels", "records"),
        ("actuator_limit", "speed_limit", "geometry", "initial_condition", "effects", "resample", "tolerance"),
    )
    top, placed = in_length(top)
    top, told = in_effort(top)
    notes = {"initial_condition": top.text("initial_condition")}
    kind = top.choice("plant", KINDS, "plant")
    title, bandwidth = top.text("title"), top.quantity("evaluation_bandwidth", "Hz", above=SLOWEST)
    measured = channels(top, kind == TWO_MASS, notes)
    assumed, resample = assumptions(measured), resample or top.flag("resample")
    with in_own_words(top, told):
        plant = declared_plant(top, kind, "torque" in measured, notes)
    frozen, findings = records(top, folder, measured, resample)
    if not promised(notes["initial_condition"]):
        frozen = tuple(replace(r, history=None) for r in frozen)
    rate, slowest = min((1 / r.dt, r.name) for r in frozen)
    if bandwidth >= BAND * rate:
        raise UnsoundRecord(
            f"{top.path('evaluation_bandwidth')} is {bandwidth:g} Hz, but record '{slowest}' is sampled at {rate:g} Hz; "
            f"give less than {BAND * rate:g} Hz, or log faster.",
            SAMPLING_RATE,
            slowest,
        )
    tolerance = top.number("tolerance", above=0.0) if "tolerance" in top.values else None
    return Campaign(
        folder,
        title,
        plant,
        frozen,
        bandwidth,
        (*placed, *told, *assumed, *findings),
        {k: n for k, n in notes.items() if n},
        tolerance,
    )
