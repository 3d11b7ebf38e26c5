"""What a plan starts from: a study's campaign with every value free and fitted, its limits, and how well its log sees."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.campaign import Campaign
from workbench.campaign import load as load_campaign
from workbench.definition import Effect
from workbench.errors import WorkbenchError, nearest
from workbench.identification.fit import fitted_on, identify
from workbench.identification.problem import Problem
from workbench.identification.result import Fit
from workbench.identification.solve import solve
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.planning import Envelope, Sensing, Separation, envelope_of, sensing_of, separate
from workbench.planning.envelope import load_rest
from workbench.plant import Plant, freed
from workbench.readers.declaration import Table
from workbench.record import IDENTIFICATION
from workbench.study import configuration
from workbench.units import effect_unit

KEYS = {"lowest": ("low", "x"), "highest": ("high", "x"), "speed": ("speed", "x/s"),
        "acceleration": ("acceleration", "x/s^2"), "drive": ("drive", "F")}  # fmt: skip
ACCURACY = 0.02


@dataclass(frozen=True, eq=False)
class Basis:
    """fit: of the plant with every value free. load: rms that it leaves of the load's balance, 0 of one mass. excess: what it leaves of the
    drive over what noise and encoder counts alone would. sample_time: s, at which the drive reads a reference. accuracy: a share."""

    campaign: Campaign
    passes: tuple[InverseDynamics, ...]
    fit: Fit
    envelope: Envelope
    sensing: Sensing
    sample_time: float
    accuracy: float
    load: float
    excess: float


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
    found = basis(load_campaign(study.campaign), say)
    given = study.table.table("plan", optional=("accuracy", *KEYS))
    return replace(
        found,
        envelope=_limited(found.envelope, given, found.fit.plant.rotary),
        sample_time=_sample_time(study.table, found.sample_time),
        accuracy=given.number("accuracy", ACCURACY, above=0.0),
    )


def basis(campaign: Campaign, say: Callable[[str], None] = lambda _: None) -> Basis:
    """Return what a plan for a campaign starts from, within the limits that its records have shown."""
    passes = inverse_dynamics(campaign.records, campaign.bandwidth)
    say("fitting the declared model, every value free")
    fit = identify(freed(campaign.plant), passes)
    load = load_rest(fit.plant, fitted_on(passes))
    sensing = sensing_of(passes, fit.rms[IDENTIFICATION], load)
    envelope = envelope_of(fit.plant, passes)
    return Basis(campaign, passes, fit, envelope, sensing, sensing.dt, ACCURACY, load, _excess_of(fit, passes))


def _excess_of(fit: Fit, passes: tuple[InverseDynamics, ...]) -> float:
    """Return the rms that a fit leaves of the drive over what noise and encoder counts alone would leave."""
    from workbench.residual.noise_floor import noise_rms

    alone = noise_rms(fitted_on(passes), fit.plant)
    least = float(np.sqrt(np.mean(np.array(list(alone.values())) ** 2)))
    return fit.rms[IDENTIFICATION] / least if least > 0.0 else 1.0


def _limited(envelope: Envelope, given: Table, rotary: bool) -> Envelope:
    """Return the envelope with the limits that [plan] states in place of those that the records have shown."""
    stated = {
        name: given.quantity(key, effect_unit(unit, rotary)) for key, (name, unit) in KEYS.items() if key in given
    }
    return replace(envelope, **stated)


def _sample_time(top: Table, otherwise: float) -> float:
    """Return the sample time of the study's loop in s, at which its drive reads references; `otherwise` without one."""
    if "loop" not in top or not isinstance(top.values["loop"], dict) or "sample_time" not in top.values["loop"]:
        return otherwise
    loop = top.table("loop", optional=tuple(top.values["loop"]))
    return loop.quantity("sample_time", "s", above=0.0)


def _suspect(basis: Basis, text: str) -> tuple[Plant, Effect, float]:
    """Return (the plant without it, the effect with the values that explain the records, the rms of what is then left).

    text: "effect" or "effect@place". A declared effect keeps its fitted values; another one is fitted jointly with the
    declared model, as a trace does.
    """
    from workbench.tracing.candidates import suspects
    from workbench.tracing.search import fitted

    plant, (name, _, place) = basis.fit.plant, text.partition("@")
    for e in plant.effects:
        if name == e.name and place in ("", e.at):
            return plant.without(e.key), e, basis.fit.rms[IDENTIFICATION]
    known = suspects(plant)
    chosen = next((s for s in known if s.effect == name and place in ("", s.at)), None)
    if chosen is None:
        raise WorkbenchError(f"there is no candidate '{text}' for this plant; {nearest(text, _names_of(known, place))}")
    records = fitted_on(basis.passes)
    declared = Problem(plant, records)
    beside, found = fitted(chosen, declared, solve(declared), _residuals(basis.fit, records))
    problem = beside.free
    solution = solve(problem, beside.free_start(found))
    effect = problem.with_linear(problem.with_shape(solution.theta), solution.c)[chosen.key]
    return plant, effect, float(np.sqrt(solution.cost / solution.y.size))


def parted(basis: Basis, first: str, second: str) -> tuple[Separation, Plant, Effect, Sensing]:
    """Return the motion that tells two effects apart; the plant without either, the first effect, and how its log sees.

    first, second: "effect" or "effect@place", as of `_suspect`. WorkbenchError where they are one.
    """
    (plant, a, left), (_, b, also) = _suspect(basis, first), _suspect(basis, second)
    if a.key == b.key:
        raise WorkbenchError(f"'{a.key}' is named twice; name two effects.")
    # an effect that is declared is taken out of the model that both share
    plant = plant.without(b.key) if b.key in (e.key for e in plant.effects) else plant
    sensing = sensing_of(basis.passes, min(left, also), basis.load)
    return separate(plant, a, b, basis.envelope, sensing), plant, a, sensing


def _names_of(known: Sequence, place: str) -> list[str]:
    """Return what candidates are called: with their places where one was asked for, else by name alone."""
    return [s.key if place else s.effect for s in known]


def _residuals(fit: Fit, passes: list[InverseDynamics]) -> list[np.ndarray]:
    """Return what the fit leaves of each record (n,), zero where nothing counts."""
    found = []
    for p in passes:
        series = fit.series[p.motion.record.name]
        left = np.zeros(series.time.size)
        left[series.keep] = series.residual[series.keep]
        found.append(left)
    return found
