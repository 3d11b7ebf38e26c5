"""Several resonances of one axis: labelled effects, in the frequency response, in identification and in a campaign."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.frequency import Mode, Modes, fit_modes, flexible_modes, response_of
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import Plant
from workbench.record import Record, Source
from workbench.simulation import open_loop

J, B = 0.012, 0.05
MODES = {"first": (0.004, 60.0, 0.03), "second": (0.0015, 140.0, 0.02)}  # mass, frequency, damping


def axis(scale: float = 1.0) -> Plant:
    plant = Plant("one mass", (find("inertia")(inertia=J), find("viscous_friction")(viscous=B)))
    for label, (mass, frequency, damping) in MODES.items():
        plant += find("flexible_mode")(mass=mass, frequency=scale * frequency, damping=damping / scale, label=label)
    return plant


def response(f: np.ndarray) -> np.ndarray:
    """Velocity over drive: 1/(b + s (J + sum m (2 zeta w s + w^2)/(s^2 + 2 zeta w s + w^2)))."""
    s, mass = 2j * pi * f, J
    for m, frequency, zeta in MODES.values():
        w = 2 * pi * frequency
        mass = mass + m * (2 * zeta * w * s + w * w) / (s * s + 2 * zeta * w * s + w * w)
    return 1.0 / (B + s * mass)


def multisine(n: int, dt: float, lines: np.ndarray, seed: int = 0) -> np.ndarray:
    t, rng = np.arange(n) * dt, np.random.default_rng(seed)
    return sum(np.sin(2 * pi * f * t + rng.uniform(0, 2 * pi)) for f in lines) * 0.05


def test_two_resonances_have_the_frequency_response_of_the_closed_form():
    dt, period = 1e-4, 10_000  # 1 s: lines at whole Hz
    lines = np.arange(5, 250, 3)
    drive = np.tile(multisine(period, dt, lines), 8)
    v = open_loop(axis(), drive, dt, 4, record=("v",))["v"][-period:, 0]
    # the velocity is that at the sample; the drive is held over it, which is half a sample's delay and a sinc
    ratio = np.fft.rfft(v)[lines] / np.fft.rfft(drive[:period])[lines]
    held = np.sinc(lines * dt) * np.exp(-1j * pi * lines * dt)
    error = np.abs(ratio / held / response(lines) - 1.0)
    assert error.max() < 0.05
    assert np.abs(response(lines)).max() > 3 * np.abs(response(np.array([100.0])))[0]  # they do resonate
    one = axis().without("flexible_mode second@axis")
    v = open_loop(one, drive, dt, 4, record=("v",))["v"][-period:, 0]
    assert np.abs(np.fft.rfft(v)[lines] / np.fft.rfft(drive[:period])[lines] / held / response(lines) - 1.0).max() > 0.5


def recorded(seconds: float, lines: np.ndarray, periods: int = 1, slow: float = 0.0) -> Record:
    """Return a record at 2 kHz of an axis that is shaken at `lines` in Hz, integrated at twenty times the rate."""
    dt, finer = 5e-4, 20
    t = np.arange(round(seconds / dt) * finer) * dt / finer
    drive = multisine(t.size, dt / finer, lines, 3) + slow * np.sin(2 * pi * 0.7 * t)
    drive = np.tile(drive, periods) if periods > 1 else drive * np.minimum(t / 0.5, 1.0)
    q = open_loop(axis(), drive, dt / finer, 4)["q"][::finer, 0]
    time, channels = np.arange(q.size) * dt, {"position": q, "torque": drive[::finer].copy()}
    return Record("shaken", "identification", time, channels, {}, Source(Path("x"), "", "none", {}))


@pytest.fixture(scope="module")
def shaken() -> Record:
    return recorded(8.0, np.arange(2, 250, 1.7), slow=0.2)


def poles() -> list[tuple[float, float]]:
    """Return (frequency in Hz, damping ratio) of the axis free to move, by the roots of b + s (J + ...)."""
    below, above = np.poly1d([1.0]), []
    for m, frequency, zeta in MODES.values():
        w = 2 * pi * frequency
        own = np.poly1d([1.0, 2 * zeta * w, w * w])
        above = [(n * own) for n in above] + [below * np.poly1d([2 * zeta * w * m, w * w * m])]
        below = below * own
    roots = (B * below + np.poly1d([1.0, 0.0]) * sum(above, J * below)).roots
    return sorted((abs(r) / (2 * pi), -r.real / abs(r)) for r in roots if r.imag > 0)


def test_both_resonances_are_found_in_the_frequency_response_of_a_record():
    modes = fit_modes(response_of(recorded(2.0, np.arange(4, 500, 3) * 0.5, periods=6))).modes
    assert len(modes) == 2
    for mode, (frequency, damping) in zip(modes, poles(), strict=True):
        assert mode.frequency == pytest.approx(frequency, rel=1e-4)
        assert mode.damping == pytest.approx(damping, rel=1e-3)


@pytest.mark.parametrize("start", [0.92, 1.06])
def test_two_resonances_are_identified(shaken, start):
    fit = identify(axis(start), inverse_dynamics([shaken], 220.0))
    found = {(e.effect, e.parameter): e.value for e in fit.estimates}
    for label, truth in MODES.items():
        for name, value, within in zip(("mass", "frequency", "damping"), truth, (0.02, 0.001, 0.01), strict=True):
            assert found[f"flexible_mode {label}", name] == pytest.approx(value, rel=within), (label, name)
    assert found["inertia", "inertia"] == pytest.approx(J, rel=0.005)
    assert fit.identification < 0.01


def test_a_resonance_too_far_from_its_start_is_said_not_to_be_found(shaken):
    fit = identify(axis(1.15), inverse_dynamics([shaken], 220.0))
    assert fit.identification > 0.1
    assert any(f.kind == "at bound" and f.subject.startswith("flexible_mode second@axis") for f in fit.findings)


def test_the_frequency_response_gives_the_parts_that_identification_starts_from(shaken):
    """No frequency is guessed: one record is looked at for its modes, another is identified from there."""
    parts = flexible_modes(fit_modes(response_of(recorded(2.0, np.arange(4, 500, 3) * 0.5, periods=6))))
    for part, (_, frequency, damping) in zip(parts, MODES.values(), strict=True):
        assert part.parameters["frequency"].value == pytest.approx(frequency, rel=1e-3)
        assert part.parameters["damping"].value == pytest.approx(damping, rel=1e-2)
    start = Plant("one mass", (find("inertia"), find("viscous_friction"), *parts))
    fit = identify(start, inverse_dynamics([shaken], 220.0))
    masses = [fit.plant[e.key].parameters["mass"].value for e in parts]
    assert masses == pytest.approx([m for m, _, _ in MODES.values()], rel=0.02)


def test_one_resonance_needs_no_label_and_none_gives_no_part():
    w, z = 2 * pi * 60.0, 0.02
    free = w * (1.3**0.5)
    # 1/(J + m w^2/(s^2 + w^2)) of m = 0.3 J: zero at w, pole at w sqrt(1.3)
    r, p = (w**2 / free**2 - 1.0, 0.0)
    poles, mode = np.array([[free, z]]), Mode(free / (2 * pi), 0.1, z, 0.001, 5.0)
    (part,) = flexible_modes(Modes((mode,), poles, np.array([-r, p, 1.0 + r]), 0.0, 1.0))
    assert part.key == "flexible_mode@axis"
    assert part.parameters["frequency"].value == pytest.approx(60.0, rel=1e-2)
    assert flexible_modes(Modes((), poles, np.array([0.0, 0.0, 1.0]), 0.0, 1.0)) == ()


def test_effects_of_one_name_at_one_place_are_told_apart_by_their_labels():
    plant = axis()
    assert [e.key for e in plant.effects[2:]] == ["flexible_mode first@axis", "flexible_mode second@axis"]
    assert plant["flexible_mode second@axis"].parameters["frequency"].value == 140.0
    with pytest.raises(WorkbenchError, match="2 effects 'flexible_mode'"):
        plant["flexible_mode"]
    with pytest.raises(WorkbenchError, match="acts twice at 'axis'; declare it once, or give each of them a label"):
        plant + find("flexible_mode")(label="second")
    with pytest.raises(WorkbenchError, match="label 'a@b' must be letters"):
        find("flexible_mode")(label="a@b")
