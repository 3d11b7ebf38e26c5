"""A ripple whose phase belongs to one power-up: its phase is found on each record, and offered as a calibration."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
import rig

from workbench.campaign import load
from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.criteria import Criteria
from workbench.tracing.power_up import calibrate, calibrations, periodic
from workbench.tracing.result import Cause
from workbench.tracing.tracing import trace
from workbench.tracing.wording import belongs_to_one_power_up

OFFSET = 0.7  # rad, by which the axis stood elsewhere at power-up


def powered_up(record, offset: float):
    """The record as an incremental encoder counts it that was switched on `offset` farther on."""
    channels = {n: x - offset if n in ("position", "reference") else x for n, x in record.channels.items()}
    return replace(record, channels=channels)


@pytest.fixture(scope="module")
def ripple(tmp_path_factory):
    """A campaign that lacks a ripple, and the ripple."""
    folder = tmp_path_factory.mktemp("ripple")
    truth = rig.campaign(folder, 102, ("cogging",), 4.0, short=True)
    return load(folder), truth["parameters"]["cogging"]


def calibrated(ripple, offset: float):
    """The true structure fitted, its validation record counted from elsewhere, and the calibration of it."""
    campaign, wave = ripple
    records = [powered_up(r, offset) if r.role == VALIDATION else r for r in campaign.records]
    inverses = inverse_dynamics(records, campaign.bandwidth)
    fit = identify(campaign.plant + find("cogging")(order=wave["order"]), inverses)
    return fit, inverses, calibrate(fit.plant, "cogging@axis", inverses, fit.validation)


def around(angle: float) -> float:
    return (angle + pi) % (2 * pi) - pi


def test_the_phase_of_another_power_up_is_found_and_its_error_goes(ripple):
    fit, _, found = calibrated(ripple, OFFSET)
    phases = {p.role: p for p in found.phases}
    first, then = phases[IDENTIFICATION], phases[VALIDATION]
    moved = around(then.phase.value - first.phase.value - ripple[1]["order"] * OFFSET)
    assert abs(moved) < 3 * np.hypot(first.half, then.half)
    assert found.differs and found.identified == fit.validation
    assert found.calibrated < 0.5 * found.identified
    assert "Calibrate it at each power-up" in belongs_to_one_power_up(found).sentence
    assert then.amplitude.value == pytest.approx(first.amplitude.value, rel=0.1)


def test_a_ripple_of_one_power_up_has_one_phase(ripple):
    fit, _, found = calibrated(ripple, 0.0)
    assert not found.differs and "not for its phase" in found.sentence
    assert found.calibrated == pytest.approx(fit.validation, rel=0.1)


def test_a_cause_that_does_not_carry_over_is_calibrated_and_another_is_not(ripple):
    fit, inverses, _ = calibrated(ripple, OFFSET)

    def causes(validation: float):
        one = Cause("cogging", "axis", "", (), 0.9, validation)
        return calibrations(fit.plant, [one], inverses, Criteria())

    assert [c.effect for c in causes(-0.5)] == ["cogging"]
    assert causes(0.88) == ()


def test_only_waves_with_a_phase_are_calibrated():
    names = ("cogging", "kinematic_error", "encoder_eccentricity", "gravity", "inertia")
    assert [n for n in names if periodic(find(n))] == ["cogging", "kinematic_error", "encoder_eccentricity"]


def test_a_ripple_of_another_power_up_is_named_and_not_used_where_its_phase_is_wrong(ripple):
    campaign, wave = ripple
    records = [powered_up(r, pi / wave["order"]) if r.role == VALIDATION else r for r in campaign.records]
    inverses = inverse_dynamics(records, campaign.bandwidth)
    found = trace(campaign.plant, inverses, only=("cogging",))
    assert found.added == ("cogging",) and found.causes[0].share_validation < 0.0
    assert "not carried over" in [f.kind for f in found.findings]
    assert found.after.validation == pytest.approx(found.before.validation, rel=1e-6)
    assert found.after.identification < 0.5 * found.before.identification
    (offered,) = found.calibrations
    assert offered.differs and offered.calibrated < 0.5 * offered.identified


def test_a_wave_of_another_size_is_no_wave_of_another_power_up(ripple):
    """What dresses a record takes a wave of any phase on another one, and hardly ever as large a one."""
    _, _, found = calibrated(ripple, OFFSET)
    shrunk = tuple(
        replace(p, amplitude=replace(p.amplitude, value=0.26 * p.amplitude.value)) if p.role == VALIDATION else p
        for p in found.phases
    )
    assert found.same and not replace(found, phases=shrunk).same
