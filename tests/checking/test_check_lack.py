"""What a declared model lacks is not called noise, and no record is asked for that the campaign has already.

The axis is a pan-tilt: inertia, gravity, a cable's spring and dry friction, its log an encoder of 175 urad and 4 mN*m of noise;
gravity and cable are not declared.
"""

import numpy as np
import pytest
from declared import declared

from workbench.checking.checking import check
from workbench.checking.excitation import rough

DRY = """[[effects]]
effect = "coulomb_friction"
at = "axis"
parameters.coulomb = {{ value = {coulomb}, unit = "N*m" }}
"""
INERTIA, VISCOUS, COULOMB, WEIGHT, SPRING = 0.02, 0.05, 0.12, 1.4, 0.25


def gimbal(place, coulomb: float = 0.14):
    """Write its campaign: two records of smooth motion that reverses all the time, the drive by inverse dynamics."""
    place.mkdir()
    (place / "campaign.toml").write_text(declared("gimbal", 40, 1.75e-4, DRY.format(coulomb=coulomb)))
    t = np.arange(8000) * 1e-3
    for name, seed in (("a", 1), ("b", 2)):
        rng = np.random.default_rng(seed)
        phase, w = rng.uniform(0, 6, 5), 2 * np.pi * np.array([0.2, 0.7, 1.6, 3.1, 5.3])
        size = np.array([0.6, 0.2, 0.05, 0.02, 0.01])
        q, v, a = (
            sum(s * w0**d * np.sin(w0 * t + p + d * np.pi / 2) for s, w0, p in zip(size, w, phase, strict=True))
            for d in range(3)
        )
        u = INERTIA * a + VISCOUS * v + COULOMB * np.tanh(v / 1e-3) + WEIGHT * np.sin(q + 0.35) + SPRING * q
        u += rng.normal(0, 0.004, t.size)
        np.savetxt(
            place / f"{name}.csv",
            np.column_stack([t, u, 1.75e-4 * np.floor(q / 1.75e-4)]),
            "%.8g",
            ",",
            header="t,u,q",
            comments="",
        )
    return place


def test_gravity_that_is_not_declared_is_no_noise(tmp_path):
    assert check(gimbal(tmp_path / "c")) == ()


def test_noise_is_what_is_left_of_the_smooth():
    t = np.linspace(0, 1, 500)
    noise = np.random.default_rng(1).normal(0, 0.1, 500)
    assert rough(3.0 - 40.0 * t + 25.0 * t**2 + noise) == pytest.approx(0.1, rel=0.1)


def test_a_friction_too_small_to_be_seen_asks_for_no_motion_that_is_there(tmp_path):
    found = [f for f in check(gimbal(tmp_path / "c", 1e-5)) if f.kind == "excitation missing"]
    assert all("reverses" not in f.remedy for f in found)
