"""[plan] of study.toml: the limits of a motion to record next, and how well it is to determine."""

from collections.abc import Callable

from workbench.campaign import load as load_campaign
from workbench.errors import WorkbenchError
from workbench.planning.basis import ACCURACY, Basis, basis
from workbench.readers.declaration import Table
from workbench.study import configuration
from workbench.units import effect_unit

KEYS = {"lowest": ("low", "x"), "highest": ("high", "x"), "speed": ("speed", "x/s"),
        "acceleration": ("acceleration", "x/s^2"), "drive": ("drive", "F")}  # fmt: skip


def basis_of(name: str, say: Callable[[str], None] = lambda _: None) -> Basis:
    """Return what a plan for a study starts from. name: the study's folder, or its name under studies/.

    WorkbenchError where the study has no campaign or [plan] states what cannot be.
    """
    folder = configuration.find(name)
    study = configuration.load(folder)
    if study.campaign is None:
        raise WorkbenchError(
            f"{study.table.path('campaign')}: a plan is made for a study of a campaign; name its folder."
        )
    say("reading the campaign")
    campaign, given = load_campaign(study.campaign), study.table.table("plan", optional=("accuracy", *KEYS))
    return basis(
        campaign, say, limits=_limits(given, campaign.plant.rotary), sample_time=_sample_time(study.table),
        accuracy=given.number("accuracy", ACCURACY, above=0.0),
    )  # fmt: skip


def _limits(given: Table, rotary: bool) -> dict[str, float]:
    """Return the limits that [plan] states in place of those that the records have shown, SI."""
    return {name: given.quantity(key, effect_unit(unit, rotary)) for key, (name, unit) in KEYS.items() if key in given}


def _sample_time(top: Table) -> float:
    """Return the sample time of the study's loop in s, at which its drive reads references; 0 without one."""
    if "loop" not in top or not isinstance(top.values["loop"], dict) or "sample_time" not in top.values["loop"]:
        return 0.0
    loop = top.table("loop", optional=tuple(top.values["loop"]))
    return loop.quantity("sample_time", "s", above=0.0)
