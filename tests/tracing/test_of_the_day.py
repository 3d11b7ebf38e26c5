"""What is of a day or of the noise is not explainable: a record's own level of friction, a coloured force inside the loop, its low end."""

import numpy as np
import pytest

from workbench.definition import find
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, Record
from workbench.tracing.criteria import Criteria
from workbench.tracing.evidence import Explainable
from workbench.tracing.explainable import explainable
from workbench.tracing.lines import _lines
from workbench.tracing.of_the_day import LEVEL
from workbench.tracing.state import State

DT, N, BAND = 1e-3, 30000, 40.0
T = DT * np.arange(N)
INERTIA, VISCOUS, COULOMB = 0.02, 0.05, 0.4
LARGEST = Criteria().explainable


def coloured(seed: int, falls: float, least: float) -> np.ndarray:
    """Return noise (N,) of unit rms whose power goes with f^-falls, level below `least` Hz."""
    f = np.fft.rfftfreq(N, DT)
    spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(N)) * np.maximum(f, least) ** (-falls / 2.0)
    x = np.fft.irfft(spectrum, N)
    return (x - x.mean()) / x.std()


def recorded(name: str, w: float, level: np.ndarray | float, force: np.ndarray | float = 0.0) -> Record:
    """Return a record of two sines about w, rad/s, whose friction is `level` times COULOMB; force: N*m, besides."""
    q = 0.6 * np.sin(w * T) + 0.2 * np.sin(2.7 * w * T + 0.3)
    v = 0.6 * w * np.cos(w * T) + 0.54 * w * np.cos(2.7 * w * T + 0.3)
    a = -0.6 * w**2 * np.sin(w * T) - 1.458 * w**2 * np.sin(2.7 * w * T + 0.3)
    drive = INERTIA * a + VISCOUS * v + COULOMB * level * np.sign(v) + force
    drive = drive + 1e-3 * np.random.default_rng(len(name)).standard_normal(N)
    return Record(name, IDENTIFICATION, T, {"torque": drive, "position": q, "reference": q})


def told(*records: Record) -> Explainable:
    """Return what is explainable of the residual of inertia, viscous and Coulomb friction on these records."""
    plant = Plant(ONE_MASS) + find("inertia") + find("viscous_friction") + find("coulomb_friction")
    return explainable(State(plant, inverse_dynamics(records, BAND)), Criteria())


@pytest.mark.parametrize(("differs", "missing"), [(0.03, False), (3 * LEVEL, True)])
def test_friction_that_differs_by_some_per_cent_from_record_to_record_is_of_the_day(differs, missing):
    found = told(recorded("a", 2.0, 1.0 + differs), recorded("bb", 3.1, 1.0 - differs), recorded("ccc", 1.3, 1.0))
    assert (found.size >= LARGEST) == missing


def test_a_force_of_low_colour_is_noise_and_neither_one_that_steps_nor_a_friction_that_wanders_is():
    noise = [0.06 * coloured(seed, 1.5, 0.2) for seed in (1, 2)]
    found = told(recorded("a", 2.0, 1.0, noise[0]), recorded("bb", 3.1, 1.0, noise[1]))
    assert found.time < LARGEST and found.level > 4 * LARGEST
    slips = [np.where(T > 11.0, 0.1, -0.1) + np.where(T > 21.0, 0.15, 0.0)] * 2
    found = told(recorded("a", 2.0, 1.0, slips[0]), recorded("bb", 3.1, 1.0, slips[1]))
    assert found.time == found.level > 2 * LARGEST
    wanders = [1.0 + 0.25 * np.sin(2 * np.pi * T / period) for period in (9.0, 13.0)]
    found = told(recorded("a", 2.0, wanders[0]), recorded("bb", 3.1, wanders[1]))
    assert found.time > 2 * LARGEST and found.kind == "time"


@pytest.mark.parametrize("seconds", [6, 10])
@pytest.mark.parametrize("seed", range(6))
def test_noise_that_falls_with_frequency_has_no_line_at_its_low_end(seed, seconds):
    brown = coloured(seed, 4.0, 0.5)[: 1000 * seconds]
    assert np.max(_lines(brown, DT, BAND)[2]) < Criteria().line
    tone = 2.0 * np.sin(2 * np.pi * 1.7 * T[: 1000 * seconds])
    f, _, ratio = _lines(brown + tone, DT, BAND)
    assert f[np.argmax(ratio)] == pytest.approx(1.7, abs=0.2) and ratio.max() > Criteria().line
