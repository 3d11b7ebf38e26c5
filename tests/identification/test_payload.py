"""A record that states its payload: one campaign holds several loads, and the model stays that of the bare axis."""

import numpy as np
import pytest

from workbench.campaign import load
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.output_error.rerun import payload_inertia

INERTIA, VISCOUS, MGL, PHASE = 0.02, 0.05, 0.3, 0.4
ADDED = {"inertia": 0.015, "mgl": 0.25, "phase": 0.4}
TOML = """
title = "An arm with and without a weight at its end"
plant = "one mass"
evaluation_bandwidth = { value = 30, unit = "Hz" }
[channels]
time = { column = "t", unit = "s" }
torque = { column = "T", unit = "N*m" }
position = { column = "q", unit = "rad" }
[[effects]]
effect = "inertia"
at = "axis"
parameters.inertia = { value = 0.01, unit = "kg*m^2", fixed = false }
[[effects]]
effect = "viscous_friction"
at = "axis"
parameters.viscous = { value = 0.0, unit = "N*m*s/rad", fixed = false }
[[effects]]
effect = "gravity"
at = "axis"
parameters.mgl = { value = 0.1, unit = "N*m", fixed = false }
parameters.phase = { value = 0.1, unit = "rad", fixed = false }
[[records]]
file = "bare.csv"
role = "identification"
[[records]]
file = "loaded.csv"
role = "identification"
payload = { inertia = { value = 150, unit = "kg*cm^2" }, mgl = { value = 250, unit = "mN*m" }, phase = { value = 0.4, unit = "rad" } }
[[records]]
file = "moves.csv"
role = "validation"
"""


def arm(folder, name, seed, inertia, mgl):
    """Write a record in closed form: T = J a + b v + mgl sin(q + phase), exactly."""
    t = np.arange(6000) * 1e-3
    rng = np.random.default_rng(seed)
    w, p = 2 * np.pi * np.array([0.7, 1.9, 4.3]), rng.uniform(0, 6, 3)[:, None]
    a, x = np.array([[1.0], [0.3], [0.08]]), w[:, None] * t
    q, v = np.sum(a * np.sin(x + p), 0), np.sum(a * w[:, None] * np.cos(x + p), 0)
    acceleration = -np.sum(a * w[:, None] ** 2 * np.sin(x + p), 0)
    torque = inertia * acceleration + VISCOUS * v + mgl * np.sin(q + PHASE)
    np.savetxt(folder / name, np.column_stack([t, torque, q]), "%.12g", ",", header="t,T,q", comments="")


@pytest.fixture
def folder(tmp_path):
    arm(tmp_path, "bare.csv", 1, INERTIA, MGL)
    arm(tmp_path, "loaded.csv", 2, INERTIA + ADDED["inertia"], MGL + ADDED["mgl"])
    arm(tmp_path, "moves.csv", 3, INERTIA, MGL)
    (tmp_path / "campaign.toml").write_text(TOML, encoding="utf-8")
    return tmp_path


def values(folder):
    campaign = load(folder)
    fit = identify(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth))
    inner = {f"{e.key}.{n}": p.value for e in fit.plant.effects for n, p in e.parameters.items()}
    return inner["inertia@axis.inertia"], inner["gravity@axis.sine"], inner["gravity@axis.cosine"]


def test_records_of_two_loads_give_the_bare_axis(folder):
    truth = (INERTIA, MGL * np.cos(PHASE), MGL * np.sin(PHASE))
    assert values(folder) == pytest.approx(truth, rel=2e-3)


def test_without_the_payload_stated_the_two_loads_are_mixed_up(folder):
    text = "\n".join(line for line in TOML.splitlines() if not line.startswith("payload"))
    (folder / "campaign.toml").write_text(text, encoding="utf-8")
    assert values(folder)[0] > 1.2 * INERTIA


def test_a_payload_is_read_in_si_and_refused_by_its_unit(folder):
    (payload,) = [r.payload for r in load(folder).records if r.payload is not None]
    assert (payload.inertia, payload.mgl, payload.phase) == pytest.approx((0.015, 0.25, 0.4))
    (folder / "campaign.toml").write_text(TOML.replace("kg*cm^2", "kg"), encoding="utf-8")
    with pytest.raises(WorkbenchError, match="record 2 'loaded.csv', payload.inertia"):
        load(folder)


def test_a_loop_is_simulated_with_a_payload_s_inertia_and_not_with_its_weight(folder):
    loaded = next(r for r in load(folder).records if r.payload is not None)
    with pytest.raises(WorkbenchError, match="payload with weight"):
        payload_inertia(loaded)


def test_a_gap_is_cut_out_by_from_and_until(folder):
    table = np.loadtxt(folder / "bare.csv", delimiter=",", skiprows=1)
    np.savetxt(folder / "bare.csv", np.delete(table, slice(2000, 2500), 0), "%.12g", ",", header="t,T,q", comments="")
    with pytest.raises(WorkbenchError, match="a gap of"):
        load(folder)
    halves = [
        f'file = "bare.csv"\nrole = "identification"\nname = "{name}"\n{key} = {{ value = 2.2, unit = "s" }}'
        for name, key in (("before", "until"), ("after", "from"))
    ]
    text = TOML.replace('file = "bare.csv"\nrole = "identification"', "\n[[records]]\n".join(halves))
    (folder / "campaign.toml").write_text(text, encoding="utf-8")
    before, after, *_ = load(folder).records
    assert (before.time.size, after.time.size) == (2000, 3500) and after.time[0] == pytest.approx(2.5)


def test_a_sample_that_its_scale_makes_infinite_is_refused(folder):
    lines = (folder / "moves.csv").read_text().splitlines()
    lines[100] = "0.099,1e308,0.1"
    (folder / "moves.csv").write_text("\n".join(lines) + "\n")
    scaled = 'torque = { column = "T", unit = "A", scale = { value = 2.79, unit = "N*m/A" } }'
    text = TOML.replace('torque = { column = "T", unit = "N*m" }', scaled)
    (folder / "campaign.toml").write_text(text, encoding="utf-8")
    with pytest.raises(WorkbenchError, match="sample 100 of torque in record .* no axis has that"):
        load(folder)


def test_samples_without_a_time_column_are_counted_at_a_rate(folder):
    text = TOML.replace('time = { column = "t", unit = "s" }', 'time.rate = { value = 1, unit = "kHz" }')
    (folder / "campaign.toml").write_text(text, encoding="utf-8")
    record = load(folder).records[0]
    assert record.dt == pytest.approx(1e-3) and record.time[0] == 0.0 and "time" not in record.source.columns
