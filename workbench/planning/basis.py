"""What a plan starts from: a campaign with every value free and fitted, its limits, and how well its log sees."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from workbench.campaign import Campaign
from workbench.identification.fit import fitted_on, identify
from workbench.identification.result import Fit
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.planning.envelope import Envelope, Sensing, envelope_of, load_rest, sensing_of
from workbench.plant import freed
from workbench.record import IDENTIFICATION
from workbench.residual.noise_floor import noise_rms

ACCURACY = 0.02  # of every parameter's value, where none is asked for


@dataclass(frozen=True, eq=False)
class Basis:
    """fit: of the plant with every value free. load: rms that it leaves of the load's balance, 0 of one mass. excess: what it leaves of the
    drive over what noise and encoder counts alone would. sample_time: s, at which the drive reads a reference. accuracy: a share."""

    campaign: Campaign
    inverses: tuple[InverseDynamics, ...]
    fit: Fit
    envelope: Envelope
    sensing: Sensing
    sample_time: float
    accuracy: float
    load: float
    excess: float


def basis(
    campaign: Campaign, say: Callable[[str], None] = lambda _: None, *, limits: Mapping[str, float] | None = None,
    sample_time: float = 0.0, accuracy: float = ACCURACY,
) -> Basis:  # fmt: skip
    """Return what a plan for a campaign starts from, within the limits that its records have shown.

    limits: field of an Envelope -> what stands in its place, SI. sample_time: at which the drive reads a reference, s; that of the
    records where 0. accuracy: half width of the intervals asked for, a share of each value.
    """
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    say("fitting the declared model, every value free")
    fit = identify(freed(campaign.plant), inverses)
    load = load_rest(fit.plant, fitted_on(inverses))
    sensing = sensing_of(inverses, fit.rms[IDENTIFICATION], load)
    envelope = replace(envelope_of(fit.plant, inverses), **(limits or {}))
    every = sample_time or sensing.dt
    return Basis(campaign, inverses, fit, envelope, sensing, every, accuracy, load, _excess_of(fit, inverses))


def _excess_of(fit: Fit, inverses: tuple[InverseDynamics, ...]) -> float:
    """Return the rms that a fit leaves of the drive over what noise and encoder counts alone would leave."""
    alone = noise_rms(fitted_on(inverses), fit.plant)
    least = float(np.sqrt(np.mean(np.array(list(alone.values())) ** 2)))
    return fit.rms[IDENTIFICATION] / least if least > 0.0 else 1.0
