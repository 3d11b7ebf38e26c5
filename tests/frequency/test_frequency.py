"""Frequency responses, modes and notches, on two masses whose modes are known in closed form."""

import json
from pathlib import Path

import numba
import numpy as np
import pytest
import rig
from scipy import signal

from workbench.campaign import Campaign
from workbench.checking.modes import undeclared
from workbench.checking.seen import Seen
from workbench.checking.wording import said
from workbench.cli import main
from workbench.definition import Effect, find
from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.frequency import fit_modes, gain_limit, notch_for, response_of
from workbench.frequency.response import period_of
from workbench.frequency.spectra import densities
from workbench.frequency.wording import findings
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, Record, Source

RATE, FINE = 2000.0, 10  # Hz of the log; steps a sample
COUNT, NOISE = 4.848e-6, 2e-3
MOTOR, LOAD, VISCOUS = 0.0016, 0.0030, 0.005  # kg*m^2, N*m*s/rad


def axis_of(frequency: float, damping: float) -> tuple[float, float]:
    """Stiffness and damping of a joint for which two free masses have a mode of this frequency and damping ratio."""
    reduced, w = MOTOR * LOAD / (MOTOR + LOAD), 2 * np.pi * frequency
    return reduced * w**2, 2 * damping * w * reduced


def truth(frequency: float, damping: float, viscous: float) -> tuple[float, float]:
    """Frequency and damping ratio of the mode with the motor's viscous friction too: eigenvalues of the two masses."""
    k, c = axis_of(frequency, damping)
    a = np.array([
        [0, 1, 0, 0], [-k / MOTOR, -(c + viscous) / MOTOR, k / MOTOR, c / MOTOR],
        [0, 0, 0, 1], [k / LOAD, c / LOAD, -k / LOAD, -c / LOAD],
    ])  # fmt: skip
    pole = max(np.linalg.eigvals(a), key=lambda p: p.imag)
    return abs(pole) / (2 * np.pi), -pole.real / abs(pole)


def drive_of(kind: str, seconds: float, seed: int = 1, top: float = 250.0) -> np.ndarray:
    """Torque at the log rate, N*m: a multisine that repeats every 2 s, or noise, 0.1 rms each."""
    rng = np.random.default_rng(seed)
    n = round(seconds * RATE)
    if kind == "noise":
        u = signal.sosfiltfilt(signal.butter(4, top, fs=RATE, output="sos"), rng.standard_normal(n))
    else:
        t = np.arange(n) / RATE
        lines = np.arange(1.0, top, 0.5)
        u = np.sin(
            2 * np.pi * np.outer(lines, t[: round(2 * RATE)]) + rng.uniform(0, 2 * np.pi, lines.size)[:, None]
        ).sum(0)
        u = np.tile(u, int(np.ceil(n / u.size)))[:n]
    return 0.1 * u / np.std(u)


@numba.njit(cache=True)
def moved(u, stiffness, loss, viscous, coulomb, slow, h, fine, q_log):
    """Two masses, friction at the motor, pulled along slow ramps by a soft position loop; torque held over each sample."""
    x = np.zeros(4)  # motor q, v; load q, v
    for n in range(u.size):
        aim = slow * (4.0 * abs((0.13 * n * h * fine) % 1.0 - 0.5) - 1.0)
        held = u[n] + 2.0 * (aim - x[0]) - 0.08 * x[1]
        u[n] = held
        q_log[n] = x[0]
        for _ in range(fine):
            joint = stiffness * (x[0] - x[2]) + loss * (x[1] - x[3])
            a = (held - joint - viscous * x[1] - coulomb * np.tanh(x[1] / 0.02)) / MOTOR
            b = joint / LOAD
            x[1] += h * a
            x[3] += h * b
            x[0] += h * x[1]
            x[2] += h * x[3]


def recorded(
    kind: str, frequency: float, damping: float, *, seconds: float = 24.0, coulomb: float = 0.05, seed: int = 1
):
    """A record of the motor's encoder: counts, torque noise, friction, slow ramps of 2 rad/s."""
    u = drive_of(kind, seconds, seed)
    q = np.zeros(u.size)
    moved(u, *axis_of(frequency, damping), VISCOUS, coulomb, 4.0, 1 / (RATE * FINE), FINE, q)
    rng = np.random.default_rng(seed + 100)
    channels = {"torque": u + NOISE * rng.standard_normal(u.size), "position": COUNT * np.floor(q / COUNT + 0.5)}
    t = np.arange(u.size) / RATE
    return Record("swept", IDENTIFICATION, t, channels, {}, Source(Path("r"), "", "", {}), {"position": COUNT})


# --- modes --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["multisine", "noise"])
@pytest.mark.parametrize(("frequency", "damping"), [(25.0, 0.05), (60.0, 0.02), (90.0, 0.005), (150.0, 0.1)])
def test_the_mode_of_a_simulated_axis_is_found_within_1_per_cent_and_its_damping_within_15(kind, frequency, damping):
    """Of two masses with dry friction, an encoder's counts and noise in the torque."""
    f, z = truth(frequency, damping, VISCOUS)
    response = response_of(recorded(kind, frequency, damping))
    assert response.method == {"multisine": "periods", "noise": "Welch"}[kind]
    (mode,) = fit_modes(response).modes
    assert mode.frequency == pytest.approx(f, rel=0.01) and mode.damping == pytest.approx(z, rel=0.15)
    assert mode.rise > 3.0


def test_the_intervals_of_a_mode_hold_the_truth_of_a_linear_axis():
    f, z = truth(60.0, 0.02, VISCOUS)
    held = 0
    for seed in range(10):
        (mode,) = fit_modes(response_of(recorded("noise", 60.0, 0.02, seconds=12.0, coulomb=0.0, seed=seed))).modes
        held += abs(mode.frequency - f) < 1.5 * mode.frequency_half and abs(mode.damping - z) < 1.5 * mode.damping_half
    assert held >= 8


def of_the_rig(axis: rig.Axis, kind: str = "multisine") -> Record:
    """A record of the rig, torque injected on top of slow ramps."""
    t = np.arange(round(24.0 * RATE)) / RATE
    ramps = 3.0 * np.abs((0.13 * t) % 1.0 * 4.0 - 2.0) - 3.0
    planned = rig.following("shaken", IDENTIFICATION, ramps - ramps[0], RATE, drive_of(kind, 24.0, top=90.0))
    made = rig.run(rig.Machine(axis, {}), 0.0, planned.make(None, False))
    noise = NOISE * np.random.default_rng(8).standard_normal(made.u.size)
    channels = {"torque": made.u + noise, "position": rig.COUNT * np.floor(made.q / rig.COUNT + 0.5)}
    return Record("shaken", IDENTIFICATION, made.t, channels, {}, Source(Path("rig"), "", "rig", {}))


def test_an_axis_without_a_mode_shows_none_and_its_inertia():
    """One mass of the rig: at high frequency, acceleration over drive is one over the inertia."""
    axis = rig.servo(np.random.default_rng(4))
    response = response_of(of_the_rig(axis))
    modes = fit_modes(response)
    assert modes.modes == ()
    high = (response.frequency > 50.0) & (response.coherence > 0.9)
    assert np.median(np.abs(response.value[high])) == pytest.approx(1 / axis.inertia, rel=0.05)
    assert "no mode" in findings(response, modes)[0].sentence


@pytest.mark.parametrize("kind", ["multisine", "noise"])
def test_the_mode_of_two_masses_of_the_rig_is_found(kind):
    """With presliding friction, its cascade closed, and its log's decimation."""
    k, c = axis_of(55.0, 0.03)
    f, z = truth(55.0, 0.03, 0.01)
    axis = rig.Axis(MOTOR, 0.01, 0.05, 650.0, load_inertia=LOAD, k2=k, c2=c)
    (mode,) = fit_modes(response_of(of_the_rig(axis, kind))).modes
    assert mode.frequency == pytest.approx(f, rel=0.01) and mode.damping == pytest.approx(z, rel=0.15)


def test_coherence_is_one_where_the_drive_shakes_and_no_line_is_given_where_it_does_not():
    response = response_of(recorded("noise", 60.0, 0.02))
    shaken = (response.frequency > 10.0) & (response.frequency < 200.0)
    assert np.median(response.coherence[shaken]) > 0.95
    assert 250.0 < response.frequency[-1] < 400.0  # the noise ends at 250 Hz


def test_the_objects_of_python_control_are_the_same_response():
    response = response_of(recorded("multisine", 60.0, 0.02, coulomb=0.0))
    modes = fit_modes(response)
    at = np.array([20.0, 60.0, 120.0])
    omega = 2 * np.pi * at
    seen = modes.system(1j * omega) * -(omega**2) * np.exp(-1j * omega * modes.delay)
    np.testing.assert_allclose(seen, modes.at(at), rtol=1e-6)
    np.testing.assert_allclose(np.ravel(response.frd.frdata), response.receptance)


@pytest.mark.parametrize(("periodic", "period"), [(True, 400), (False, 0)])
def test_a_record_that_repeats_is_told_from_one_that_does_not(periodic, period):
    rng = np.random.default_rng(3)
    u = rng.standard_normal(400 if periodic else 4000)
    u = np.tile(u, 10) if periodic else u
    assert period_of(u + 0.05 * rng.standard_normal(4000) + np.linspace(0, 3, 4000)) == period


@pytest.mark.parametrize("straightened", [True, False])
@pytest.mark.parametrize(("size", "count"), [(256, 3000), (255, 3000), (64, 64), (8, 21)])
def test_spectral_densities_are_those_of_scipy(size, count, straightened):
    from scipy import signal

    rng = np.random.default_rng(3)
    x, y = rng.normal(size=(2, count)) + np.linspace(0.0, 5.0, count)
    f, auto, other, cross = densities(x, y, 500.0, size, straightened=straightened)
    known = {"fs": 500.0, "window": "hann", "nperseg": size, "detrend": "linear" if straightened else False}
    np.testing.assert_allclose(f, signal.welch(x, **known)[0])
    for found, pair in ((auto, (x, x)), (other, (y, y)), (cross, (x, y))):
        theirs = signal.csd(*pair, **known)[1]
        np.testing.assert_allclose(found, theirs, rtol=1e-9, atol=1e-12 * np.abs(theirs).max())


def test_a_record_that_shakes_nothing_is_refused_with_a_sentence():
    t = np.arange(8000) / RATE
    still = {"torque": np.zeros(t.size), "position": np.sin(t)}
    with pytest.raises(WorkbenchError, match="coherence"):
        fit_modes(response_of(Record("still", IDENTIFICATION, t, still, {}, Source(Path("r"), "", "", {}))))


def test_a_record_too_short_is_refused_with_a_sentence():
    t = np.arange(90) / RATE
    short = {"torque": np.sin(t), "position": np.sin(t)}
    with pytest.raises(WorkbenchError, match="90|88"):
        response_of(Record("short", IDENTIFICATION, t, short, {}, Source(Path("r"), "", "", {})))


# --- notch and gains ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("damping", [0.02, 0.1])
def test_the_notch_brings_the_mode_near_the_rest(damping):
    response = response_of(recorded("multisine", 60.0, damping, coulomb=0.0))
    modes = fit_modes(response)
    (mode,) = modes.modes
    notch = notch_for(mode)
    assert notch.centre == mode.frequency and 1 / mode.rise < 1.01 * notch.depth < 1.4 / mode.rise
    f = np.linspace(30.0, 150.0, 500)
    assert (
        np.abs(modes.at(f)).max() > 2.0 / MOTOR
    )  # above the mode the motor is on its own: no resonance rises over that
    assert np.abs(modes.at(f) * notch.at(f)).max() < 1.0 / MOTOR
    omega = 2 * np.pi * f
    np.testing.assert_allclose(notch.system(1j * omega), notch.at(f), rtol=1e-9)


def law_of(response, delay: float) -> np.ndarray:
    """A velocity loop's response, position to drive."""
    return 0.4j * response.omega * np.exp(-1j * response.omega * delay)


def test_the_largest_gain_is_that_of_a_search_over_gains():
    response = response_of(recorded("multisine", 60.0, 0.02, coulomb=0.0))
    law = law_of(response, 2e-3)
    limit = gain_limit(response, law, 2.0)
    loop = (law * response.receptance)[response.coherence >= 0.8]
    worst = lambda g: np.max(1 / np.abs(1 + g * loop))  # noqa: E731
    gains = np.geomspace(1e-4, 1e2, 6000)
    first = gains[np.argmax([worst(g) > 2.0 for g in gains])]
    assert limit.gain == pytest.approx(first, rel=4e-3)
    assert worst(limit.gain) == pytest.approx(2.0, rel=1e-6)


def test_a_notch_lets_the_loop_have_more_gain():
    response = response_of(recorded("multisine", 120.0, 0.02, coulomb=0.0))
    (mode,) = fit_modes(response).modes
    law = law_of(response, 3e-3)
    bare, notched = (gain_limit(response, x) for x in (law, law * notch_for(mode).at(response.frequency)))
    assert 0.9 * mode.frequency < bare.frequency < 1.1 * mode.frequency
    assert notched.gain > 2.0 * bare.gain


def test_a_loop_that_no_line_limits_has_no_largest_gain():
    response = response_of(recorded("multisine", 60.0, 0.02, coulomb=0.0))
    assert gain_limit(response, 1.0 / response.receptance).gain == np.inf


@pytest.mark.parametrize(("law", "bound", "said"), [(np.ones(3), 2.0, "3 values"), (None, 1.0, "above 1")])
def test_what_is_no_loop_is_refused(law, bound, said):
    response = response_of(recorded("multisine", 60.0, 0.02, coulomb=0.0))
    with pytest.raises(WorkbenchError, match=said):
        gain_limit(response, law_of(response, 1e-3) if law is None else law, bound)


# --- the check ----------------------------------------------------------------------------------------------------------


def seen_as_one_mass(record: Record, *further: Effect) -> list[Finding]:
    plant = Plant(ONE_MASS, (find("inertia")(inertia=MOTOR + LOAD), *further))
    return [said(mode) for mode in undeclared(Seen(Campaign(Path("c"), "c", plant, (record,), 150.0)))]


def test_a_mode_of_an_axis_that_is_declared_as_one_mass_is_said():
    (said,) = seen_as_one_mass(recorded("multisine", 60.0, 0.02))
    assert said.kind == "mode" and "60" in said.sentence and "two masses" in said.remedy


def test_no_mode_is_said_where_it_is_declared_or_where_there_is_none():
    assert not seen_as_one_mass(recorded("multisine", 60.0, 0.02), find("flexible_mode")())
    assert not seen_as_one_mass(of_the_rig(rig.servo(np.random.default_rng(4))))


# --- the command --------------------------------------------------------------------------------------------------------

CAMPAIGN = str(Path(__file__).resolve().parents[2] / "studies" / "harmonic_drive_axis" / "campaign")


def test_the_command_writes_table_modes_and_figure_of_the_record_that_is_shaken(tmp_path, capsys):
    assert main(["response", str(Path(CAMPAIGN).parent), "--out", str(tmp_path / "out")]) == 0  # a study of it will do
    assert "id_multisine" in capsys.readouterr().out
    told = json.loads((tmp_path / "out" / "response.json").read_text())
    assert told["record"] == "id_multisine" and told["modes"] == []
    rows = np.loadtxt(tmp_path / "out" / "response.csv", delimiter=",", skiprows=1)
    assert rows.shape[1] == 6 and (np.diff(rows[:, 0]) > 0).all()
    assert (tmp_path / "out" / "response.svg").read_text().startswith("<svg")


@pytest.mark.parametrize(
    ("words", "said"), [(("--record", "id_multisin"), "id_multisine"), (("--channel", "load"), "position")]
)
def test_an_unknown_record_or_channel_is_answered_with_the_nearest(tmp_path, capsys, words, said):
    assert main(["response", CAMPAIGN, "--out", str(tmp_path / "out"), *words]) == 2
    assert said in capsys.readouterr().err and not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("low", "high", "least"), [(20.0, 900.0, 3), (12.0, 95.0, 2), (150.0, 400.0, 3), (0.1, 1000.0, 5), (1.85, 2.92, 3)]
)
def test_a_logarithmic_axis_has_labels_however_little_it_spans(low, high, least):
    from matplotlib.figure import Figure

    from workbench.report.drawing import decades

    figure = Figure()
    axes = figure.subplots()
    axes.loglog([1.0, 2.0], [low, high])
    axes.set_ylim(low, high)
    decades(axes.yaxis)
    figure.draw_without_rendering()
    ticks = [*axes.yaxis.get_major_ticks(), *axes.yaxis.get_minor_ticks()]
    inside = [t for t in ticks if low <= t.get_loc() <= high and t.label1.get_text()]
    assert least <= len(inside) <= 12 and len({t.label1.get_text() for t in inside}) == len(inside)
