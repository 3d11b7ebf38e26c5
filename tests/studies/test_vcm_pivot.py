"""The voice-coil study: its errata, one test each, and those of its rows that take no second."""

from pathlib import Path

import numpy as np
import pytest

from workbench.definition import find
from workbench.hysteresis import Bank
from workbench.hysteresis.fit import Periodic, nonnegative
from workbench.study.running import steps_of

FOLDER = Path(__file__).resolve().parents[2] / "studies" / "vcm_pivot"


@pytest.fixture(scope="module")
def study():
    """The study's own modules, by name."""
    import importlib

    steps = steps_of(FOLDER)
    names = "actuator compensated identified ladder limits loop machine paper records responses".split()
    return {n: importlib.import_module(f"{steps.__name__}.{n}") for n in names}


def test_the_filter_is_a_notch_on_the_first_mode_at_12_khz_and_not_at_12_hz(study):
    """E1, A1."""
    found = study["loop"].notch()
    assert found["zero_frequency"] == pytest.approx(4200.0, abs=0.5)
    assert found["pole_frequency"] == pytest.approx(4200.0, abs=0.5)
    assert found["zero_damping"] == pytest.approx(0.05, abs=1e-4)
    assert found["pole_damping"] == pytest.approx(0.10, abs=1e-4)
    assert 0.5 / 83.3e-3 < 10.0 < 0.5 / study["loop"].TS


def test_the_printed_loop_lacks_a_gain_of_four(study):
    """E2, A2."""
    loop = study["loop"]
    printed, calibrated = loop.margins(loop.PRINTED), loop.margins(loop.CALIBRATED)
    got = [(m.crossover, m.phase, m.gain) for m in (printed, calibrated)]
    assert got[0] == pytest.approx((274.0, 23.7, 21.2), abs=0.1)
    assert got[1] == pytest.approx((945.0, 41.4, 8.5), abs=0.1)
    assert printed.lower == pytest.approx(-7.1, abs=0.05)


def test_weights_in_mv_per_v_put_the_resonance_where_the_figures_have_it(study):
    """E3."""
    k0, a = study["loop"].K0, study["ladder"].PRINTED["a"]
    assert np.sqrt(1e-3 * a * k0) / (2 * np.pi) == pytest.approx(106.8, abs=0.1)
    assert np.sqrt(a * k0) / (2 * np.pi) > 3000.0


def test_read_peak_to_peak_the_largest_play_is_dead_and_all_are_in_the_smallest_record(study):
    """E4."""
    radii = np.array(study["ladder"].RADII)
    for conditions, live in ((study["records"].PEAK_TO_PEAK, [0, 1, 2]), (study["records"].AMPLITUDE, [1, 2, 3])):
        assert [int(np.sum(radii < a)) for _, a in conditions] == live


def test_one_frequency_determines_four_or_five_of_ten_parameters(study):
    """E5."""
    rank = {c: study["ladder"].identifiable(getattr(study["records"], c), study["ladder"].printed())[0]
            for c in ("PEAK_TO_PEAK", "AMPLITUDE", "MANY")}  # fmt: skip
    assert (rank["PEAK_TO_PEAK"], rank["AMPLITUDE"]) == (4, 5) and rank["MANY"] > 6


def test_the_energy_gain_of_one_record_is_no_norm():
    """E6: the same spring against the same model has another gain on another record."""
    t = np.linspace(0.0, 1.0, 400, endpoint=False)
    bank, half = Bank(0.0, (0.5,), (1.0,), (), ()), Bank(0.5, (), (), (), ())
    each = []
    for amplitude in (0.4, 2.0):
        x = amplitude * np.sin(2 * np.pi * t)
        f = bank.run(np.tile(x, 3), t[1])[-400:]
        each.append(np.sqrt(np.mean((f - half.run(x, t[1])) ** 2) / np.mean(x**2)))
    assert each[0] == pytest.approx(0.5) and abs(each[1] - each[0]) > 0.1


def test_a_simplex_search_ends_where_its_start_lets_it(study):
    """E7."""
    records = [e.record for e in study["records"].measured(study["records"].AMPLITUDE, study["records"].Noise())]
    found = [study["ladder"].simplex(records, s, 400) for s in study["ladder"].starts(3)]
    assert max(f.gain for f in found) > 1.2 * min(f.gain for f in found) and not all(f.converged for f in found)


def test_the_two_slope_law_needs_the_sign_of_x():
    """E8: as printed it jumps at the knee."""
    e = find("two_slope_stiffness")(inner=3.0, outer=1.0, knee=0.2)
    p = {n: v.value for n, v in e.parameters.items()}

    def printed(x):
        return p["inner"] * x if abs(x) < p["knee"] else p["outer"] * x + (p["inner"] - p["outer"]) * p["knee"]

    assert printed(-0.2 - 1e-9) - printed(-0.2 + 1e-9) == pytest.approx(2 * (3.0 - 1.0) * 0.2)
    assert printed(0.2 + 1e-9) == pytest.approx(printed(0.2 - 1e-9))


def test_a_play_as_printed_would_be_pulled_back():
    """E9: at x = z + r the printed law moves z by x' whatever its sign; eq. (9) keeps it when x turns."""
    bank = Bank(0.0, (0.25,), (1.0,), (), ())
    x = np.array([0.0, 1.0, 0.9])
    play = x - bank.run(x, 1.0)
    assert play[1] == pytest.approx(0.75) and play[2] == play[1]


def test_the_positive_weights_are_those_that_give_energy(study):
    """E10."""
    printed = study["ladder"].printed()
    assert list(printed.springs < 0.0) == [False, True, False] and list(printed.creeps < 0.0) == [False, False, True]
    x = 0.7 * np.sin(np.linspace(0.0, 4 * np.pi, 2001))
    alone = Bank(0.0, (0.5,), (printed.springs[1],), (), ()).run(x, 1e-3)
    assert np.trapezoid(alone[1000:], x[1000:]) < 0.0


def test_dividing_by_the_plant_is_right_where_differencing_is_not(study):
    """E11, A5."""
    r = study["records"]
    seen = r.settled(study["machine"].Machine(study["loop"].CALIBRATED, sensor=1e-3), 10.0, 0.5, 4)
    x, f, true = r.extract(seen, 250.0)
    y = seen["y"][0]
    differenced = 1e3 * (seen["u"][0] - np.gradient(np.gradient(y, r.TS), r.TS) / study["loop"].K0)
    rms = np.sqrt(np.mean(true**2))
    assert np.sqrt(np.mean((f - true) ** 2)) < 0.2 * rms
    assert np.sqrt(np.mean((differenced - 1e3 * seen["f"][0]) ** 2)) > 1.5 * rms
    quiet = r.floor(r.measured(((10.0, 0.5),), r.Noise()))
    assert quiet < 0.006


@pytest.fixture(scope="module")
def bank(study):
    r = study["records"]
    seen = [e.record for e in r.measured(((10.0, 0.25), (10.0, 0.5), (10.0, 1.5), (50.0, 1.0)), r.Noise())]
    from workbench.hysteresis.fit import grid

    return nonnegative(seen, *grid(seen, 12, 8)).bank


def test_compensation_is_worth_20_db_at_the_reference_and_nothing_against_a_force(study, bank):
    """E12, A12, A19."""
    base, better = study["limits"].BASE, study["compensated"].machine(bank)
    change = study["limits"].change
    assert change(better, base, 0.5) < -20.0
    assert abs(change(better, base, 0.5, where="force")) < 0.5 and abs(change(better, base, 0.5, where="output")) < 0.5


def test_a_model_of_10_hz_is_wrong_at_50_hz(study):
    """E13."""
    r = study["records"]
    seen = [e.record for e in r.measured(r.AMPLITUDE, r.Noise())]
    from workbench.hysteresis.fit import gains, grid

    found = nonnegative(seen, *grid(seen, 12, 8))
    test = r.measured(((50.0, 1.0),), r.Noise())[0].record
    assert gains(found.bank, [test])[0] > 5 * found.gain


def test_below_the_smallest_radius_the_printed_plays_do_nothing(study):
    """E14."""
    plays = Bank.of_plays(0.0, study["ladder"].RADII, study["ladder"].PRINTED["wb"])
    quarter, half = (plays.response(a, 60.0)[0] for a in (0.2499, 0.5))
    assert abs(quarter) == pytest.approx(0.0, abs=1e-12) and abs(half) > 0.1


def test_there_is_a_sentence_for_every_erratum(study):
    assert list(study["paper"].ERRATA) == [f"E{i}" for i in range(1, 15)]


def test_the_bare_integrator_is_checked_before_compensation_closes(study):
    """A weak loop that the pivot's stiffness holds up."""
    limits, loop = study["limits"], study["loop"]
    assert limits.with_pivot(loop.WEAK) < 0.02 and limits.on_bare_integrator(loop.WEAK) > 1.0
    assert limits.on_bare_integrator(loop.CALIBRATED) < 1e-6


def test_the_pivot_softens_from_7_to_1_mv_per_v(study):
    r = study["records"]
    got = []
    for amplitude in (0.05, 0.5, 3.0):
        seen = r.settled(study["machine"].Machine(study["loop"].CALIBRATED), 10.0, amplitude, 1)
        x, f = (np.fft.rfft(seen[n][0])[1] for n in ("x", "f"))
        got.append(1e3 * abs(f / x))
    assert got == pytest.approx([7.2, 3.0, 1.13], rel=0.02)


def test_a_record_of_the_smallest_reading_can_be_periodic(study):
    assert isinstance(study["records"].measured(((100.0, 0.1),), study["records"].Noise())[0].record, Periodic)
