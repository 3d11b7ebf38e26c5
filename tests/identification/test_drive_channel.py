"""The drive's channel is a sensor: an offset that moves is taken off what was measured, and put on what is predicted."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import measured

from workbench.campaign import load
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.balances import predicted
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, TWO_MASS, Plant, places
from workbench.record import Record, Source
from workbench.tracing.candidates import WHOLE
from workbench.tracing.tracing import trace

DT, BAND, RATE, INERTIA = 1e-3, 30.0, 0.02, 0.01


def records(rate: float, channel: str = "torque") -> list[Record]:
    """Two records of a mass with viscous friction whose reported drive drifts over the bench clock."""
    found = []
    for k in range(2):
        t = DT * np.arange(6000) + 20.0 * k
        q = 0.3 * np.sin(2 * np.pi * 1.3 * t) + 0.1 * np.sin(2 * np.pi * (3.1 + k) * t)
        v, a = np.gradient(q, DT), np.gradient(np.gradient(q, DT), DT)
        drive = INERTIA * a + 0.05 * v + 0.1 + rate * t
        channels = {channel: drive, "position": q}
        found.append(Record(f"r{k}", "identification", t, channels, {}, Source(Path("made"), "", "", {})))
    return found


def plant(rotary: bool = True) -> Plant:
    made = Plant(ONE_MASS, rotary=rotary) + find("inertia")(inertia=0.02) + find("viscous_friction")(viscous=0.02)
    return made + find("constant_offset")


@pytest.mark.parametrize(("rotary", "channel"), [(True, "torque"), (False, "force")])
def test_the_drift_of_a_reported_drive_is_found_in_its_unit(rotary, channel):
    at = f"sensor.{channel}"
    inverses = inverse_dynamics(records(RATE, channel), BAND)
    fit = identify(plant(rotary) + find("sensor_trend")(at=at), inverses)
    (rate,) = [e for e in fit.estimates if e.effect == "sensor_trend" and not e.fixed]
    assert (rate.value, rate.unit) == (pytest.approx(RATE, rel=1e-3), "N*m/s" if rotary else "N/s")
    assert fit.identification < 1e-3
    # what is predicted is the reading, with its drift
    m = inverses[0].motion
    assert np.sqrt(np.mean((m.u - predicted(inverses[0], fit.plant))[m.keep] ** 2)) < 1e-2 * np.std(m.u)


def test_a_drift_that_settles_is_a_trend_by_its_name_and_by_its_law_what_it_is():
    """Where it has settled, in the validation record, a straight trend goes astray."""
    found = []
    for k, role in enumerate(("identification", "identification", "validation")):
        r = records(0.0)[1]
        t = r.time + 6.0 * k - 20.0
        drive = (
            r.channels["torque"] + 0.08 * (1.0 - np.exp(-t / 4.0)) + 1e-3 * np.random.default_rng(k).normal(size=t.size)
        )
        found.append(
            replace(
                r,
                name=f"r{k}",
                role=role,
                time=t,
                channels={**r.channels, "torque": drive, "reference": r.channels["position"]},
            )
        )
    said = trace(plant(), inverse_dynamics(found, BAND), only=("sensor_trend",))
    assert said.added == ("sensor_trend",) and said.causes[0].form == "sensor_settling"
    values = {e.parameter: e.value for e in said.causes[0].parameters}
    assert values["settling"] == pytest.approx(0.25, rel=0.05) and values["rate"] == pytest.approx(0.02, rel=0.05)


def test_behind_a_command_map_the_drift_is_of_the_reading_and_not_of_what_acts():
    """A lag changes what acts; a drift of the reading is taken off before it, and comes back after it is undone."""
    lagging = plant() + find("actuator_lag")(time_constant=2e-3) + find("sensor_trend")(at="sensor.torque", rate=RATE)
    inverses = inverse_dynamics(records(0.0), BAND)[0]
    bare = lagging.without("sensor_trend")
    t = inverses.motion.t
    np.testing.assert_allclose(predicted(inverses, lagging) - predicted(inverses, bare), RATE * t, atol=1e-9)
    drifting = inverse_dynamics(records(RATE), BAND)[0]
    np.testing.assert_allclose(drifting.filtered_drive(lagging), inverses.filtered_drive(bare), atol=1e-9)


def test_a_delay_of_the_channel_and_one_of_the_command_are_two_whichever_was_asked_for_first():
    """They have the same law and may have the same value; what is kept of one is not given for the other, nor behind a lag."""
    late = find("transport_delay")(delay=2e-3)
    plants = [plant() + find("actuator_lag")(time_constant=3e-3) + late(at=at) for at in ("command", "sensor.torque")]
    plants += [p.without("actuator_lag") for p in plants]
    alone = [inverse_dynamics(records(RATE)[:1], BAND)[0].filtered_drive(p) for p in plants]
    together = inverse_dynamics(records(RATE)[:1], BAND)[0]
    for p, drive in zip(plants, alone, strict=True):
        np.testing.assert_array_equal(together.filtered_drive(p), drive)
    assert not np.allclose(alone[2], alone[3])


def test_a_trend_is_offered_at_the_drive_and_at_each_encoder():
    e = find("sensor_trend")
    assert places(ONE_MASS, e) == ("sensor.position", "sensor.torque")
    assert places(TWO_MASS, e, False) == ("sensor.position", "sensor.load_position", "sensor.force")
    assert {s.at for s in WHOLE.candidates(plant()) if s.effect == "sensor_trend"} == {
        "sensor.position",
        "sensor.torque",
    }
    with pytest.raises(WorkbenchError, match="cannot act at 'sensor.torque'"):
        Plant(ONE_MASS) + find("encoder_eccentricity")(at="sensor.torque")
    with pytest.raises(WorkbenchError, match="cannot act at 'sensor.force' on a plant of one mass"):
        Plant(ONE_MASS) + e(at="sensor.force")


def test_a_drift_may_be_declared_in_the_unit_of_its_channel(tmp_path):
    folder = measured("campaigns_d/d10")
    text = (folder / "campaign.toml").read_text(encoding="utf-8")
    one = '[[effects]]\neffect = "sensor_trend"\nat = "sensor.force"\nparameters.rate = { value = 12.0, unit = "N/min" }\n\n'
    (tmp_path / "campaign.toml").write_text(text.replace("[[records]]", one + "[[records]]", 1), encoding="utf-8")
    for file in folder.iterdir():
        if file.name != "campaign.toml":
            shutil.copy(file, tmp_path)
    assert load(tmp_path).plant["sensor_trend"].parameters["rate"].value == pytest.approx(0.2)


def test_the_drifting_force_of_a_table_is_named_first_with_its_rate():
    """Truth: 0.2 N/s beside an asymmetry of friction."""
    campaign = load(measured("campaigns_d/d10"))
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    only = ("sensor_trend", "stribeck_friction", "friction_drift", "cable_spring")
    found = trace(campaign.plant, inverses, most=1, only=only)
    first = found.causes[0]
    assert (first.effect, first.at) == ("sensor_trend", "sensor.force")
    (rate,) = [e for e in first.parameters if not e.fixed]
    assert rate.value == pytest.approx(0.2, rel=0.1) and rate.unit == "N/s"
