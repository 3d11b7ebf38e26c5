"""Faults put into measured campaigns are found by name; sound campaigns, measured and simulated, have no findings.

The faults are made by faults.py beside this and the simulated campaigns by tests/rig, which share nothing with the workbench.
"""

import math
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import rig
from conftest import measured
from faults import Folder, clip, drop, faster, freeze, late, times

from workbench.checking.channels import _leaps, runs
from workbench.checking.checking import check
from workbench.cli import main
from workbench.intake.new import new

ROOT = Path(__file__).resolve().parents[2]
CARRIED = {
    "axis": ROOT / "studies" / "harmonic_drive_axis" / "campaign",
    "models": ROOT / "studies" / "harmonic_drive_models" / "campaign",
}
DEGREES = 180 / math.pi

# (campaign, what is done to it, in which records (all where none), the finding's name)
FAULTS = [
    ("axis", times("drive", -1), (), "drive sign"),
    ("axis", times("drive", -1), ("id_multisine",), "drive sign"),
    ("axis", times("position", -1), (), "encoder sign"),
    ("axis", times("drive", 10), (), "drive scale"),
    ("axis", times("drive", 2), ("id_staircase",), "drive scale"),
    ("axis", times("position", DEGREES), (), "encoder scale"),
    ("axis", times("time", 1e3), (), "sampling rate"),
    ("axis", clip("drive", 0.9), ("id_staircase",), "clipped"),
    ("axis", clip("position", 0.7), (), "clipped"),
    ("axis", drop(5, 1, clock=False), ("id_staircase",), "dropped samples"),
    ("axis", freeze("position", 0.05), ("val_moves",), "frozen"),
    ("axis", late("drive", 4e-3), (), "misaligned"),
    ("models", times("load_position", -1), (), "encoder sign"),
    ("models", times("load_position", DEGREES), (), "encoder scale"),
    ("models", times("drive", 30), (), "drive scale"),
    ("models", late("load_position", 5e-3), (), "misaligned"),
    ("models", late("load_position", 1e-3), (), "clock skew"),
    ("models", freeze("load_position", 0.1), ("id_multisine",), "frozen"),
    ("c01", faster(0.5), (), "time scale"),
    ("c01", clip("drive", 0.5), (), "clipped"),
    ("c02", times("position", -1), (), "encoder sign"),
    ("c02", clip("load_position", 0.6), (), "clipped"),
    ("c03", freeze("position", 0.02), ("id_slow_sine",), "frozen"),
    ("c04", drop(5, 3, clock=True), ("id_multisine",), "dropped samples"),
    ("c04", drop(3, 30, clock=True), ("id_staircase",), "dropped samples"),
    ("c05", clip("position", 0.6), ("id_multisine",), "clipped"),
    ("c06", freeze("drive", 0.1), ("id_multisine",), "frozen"),
    ("c07", faster(2.0), (), "time scale"),
    ("c08", times("drive", -1), (), "drive sign"),
    ("c09", times("drive", -1), (), "drive sign"),
    ("c09", times("position", 1e3), (), "encoder scale"),
    ("c09", times("time", 1e-3), (), "sampling rate"),
    ("c09", late("position", 3e-3), (), "misaligned"),
    ("c10", times("drive", 1e-3), (), "drive scale"),
    ("c11", late("drive", 3e-3), (), "misaligned"),
    ("c11", late("position", 1e-3), (), "clock skew"),
    ("c14", times("drive", 1e-3), (), "drive scale"),
    ("c14", faster(2.5), (), "time scale"),
]
# A wrong clock is a wrong rate as well, and starts at another time than is declared.
TOGETHER = {"time scale": {"sampling rate"}, "sampling rate": {"start time"}}


@pytest.mark.parametrize(("campaign", "fault", "records", "name"), FAULTS)
def test_a_fault_is_found_by_its_name(request, tmp_path, campaign, fault, records, name):
    original = CARRIED[campaign] if campaign in CARRIED else request.getfixturevalue("campaigns") / campaign
    Folder(original, tmp_path / "c").change(fault, *records)
    found = check(tmp_path / "c")
    kinds = {f.kind for f in found}
    assert name in kinds and kinds <= {name} | TOGETHER.get(name, set()), found
    if records:
        assert {f.subject.split(".")[0] for f in found} == set(records)
    for f in found:
        assert any(c.isdigit() for c in f.sentence) and f.sentence[-1] == "." and f.remedy[-1] == "."


@pytest.mark.parametrize(
    ("fixed", "kinds"), [("false", set()), ("true", {"drive scale", "time scale", "encoder scale"})]
)
def test_where_a_fit_of_an_inertia_starts_says_nothing_of_a_scale(tmp_path, fixed, kinds):
    """Five times what it is: a data sheet's would be a fault of the records."""
    Folder(CARRIED["axis"], tmp_path / "c")
    file = tmp_path / "c" / "campaign.toml"
    value = re.compile(r"(parameters\.inertia = \{ value = )([\d.e-]+)(.*fixed = )\w+")
    said, count = value.subn(lambda m: f"{m[1]}{5.0 * float(m[2])}{m[3]}{fixed}", file.read_text(encoding="utf-8"))
    assert count == 1
    file.write_text(said, encoding="utf-8")
    found = {f.kind for f in check(tmp_path / "c")}
    assert found & kinds if kinds else not found, found


def test_stamps_that_jitter_lack_no_sample(tmp_path):
    """A microcontroller rounds its stamps: by a thirtieth of a step here."""

    def jitters(table):
        step = np.median(np.diff(table["time"]))
        table["time"] += step / 30 * np.random.default_rng(1).uniform(-1.0, 1.0, table["time"].size)

    Folder(CARRIED["axis"], tmp_path / "c").change(jitters)
    (found,) = check(tmp_path / "c")
    assert found.kind == "jitter of the clock" and "more than 1 % off the median" in found.sentence


def test_a_soft_joint_whose_load_lags_is_no_shift_of_an_encoder():
    """A steering column's torsion bar, a gap before it and friction behind it: the load's reading lags by 3.8 ms, and no clock is late."""
    assert "misaligned" not in {f.kind for f in check(ROOT / "benchmarks" / "carried" / "vb08")}


@pytest.mark.parametrize(("records", "kinds"), [((), {"misaligned"}), (("id_multisine",), set())])
def test_a_position_that_leads_its_reference_is_the_logs_where_most_records_have_it(
    campaigns, tmp_path, records, kinds
):
    """A feedforward leads on some motions; a log that is shifted shifts all of them."""
    Folder(campaigns / "c01", tmp_path / "c").change(late("reference", 12e-3), *records)
    assert {f.kind for f in check(tmp_path / "c")} == kinds


@pytest.mark.parametrize("name", [*CARRIED, *(f"c{k:02d}" for k in range(1, 15))])
def test_a_campaign_as_it_was_measured_has_no_findings(request, name):
    folder = CARRIED[name] if name in CARRIED else request.getfixturevalue("campaigns") / name
    assert check(folder) == ()


@pytest.mark.parametrize(
    ("seed", "missing", "size"),
    [(1, (), 1.0), (2, ("transport_delay",), 3.0), (3, ("gravity", "constant_offset"), 3.0), (4, ("inertia",), 3.0),
     (5, ("actuator_lag",), 3.0), (6, ("slip_moments", "friction_drift"), 3.0)],
)  # fmt: skip
def test_what_a_model_lacks_is_no_fault_of_the_records(tmp_path, seed, missing, size):
    rig.campaign(tmp_path / "c", seed, missing, size, short=True)
    assert check(tmp_path / "c") == ()


@pytest.mark.parametrize(
    ("fault", "name"),
    [(times("position", 1 / 30), "encoder scale"), (times("position", 2), "encoder scale"), (faster(0.8), "time scale"),
     (times("drive", 0.5), "drive scale"), (times("drive", -1), "drive sign")],
)  # fmt: skip
def test_a_wrong_scale_is_found_and_told_without_a_reference(tmp_path, fault, name):
    rig.campaign(tmp_path / "c", 32, ("cogging",), 2.0, short=True)
    Folder(tmp_path / "c", tmp_path / "d").change(fault)
    assert {f.kind for f in check(tmp_path / "d")} == {name}


def test_measured_data_of_other_rigs_has_only_the_findings_that_are_true(data, tmp_path):
    new(tmp_path / "emps", [data / "emps" / "DATA_EMPS.mat", data / "emps" / "DATA_EMPS_PULSES.mat"])
    assert {f.kind for f in check(tmp_path / "emps" / "campaign")} == {
        "assumed scale"
    }  # of the drive, and units that it states nowhere
    new(tmp_path / "rig", [data / "friction_rig" / "reciprocating_friction.csv.gz"])
    (found,) = check(tmp_path / "rig" / "campaign")
    assert found.kind == "dropped samples" and "179 of 26623" in found.sentence


@pytest.mark.parametrize("axis", ["kr300_axis1", "kr300_axis1_JmJl", "kr300_axis3", "kr300_axis3_JmJl"])
def test_a_link_encoder_that_is_stamped_late_is_said_with_its_interval(axis):
    found = {f.kind: f for f in check(measured("measured", axis))}["clock skew"]
    assert found.subject == "load_position" and 2.6e-3 < found.evidence["late"] < 3.3e-3
    assert found.evidence["low"] < found.evidence["late"] < found.evidence["high"]
    assert "ms late against position" in found.sentence and "clock_skew at sensor.load_position" in found.remedy


def test_a_line_beside_slow_moves_is_no_shift_of_the_drive():
    """Of one record 3 ms take a third of what is left, and of neither half of it anything: a true shift is in both."""
    assert check(measured("campaigns_d", "d05")) == ()


def test_encoders_whose_clocks_run_alike_are_not_called_late(data):
    """Campaigns of two masses that lack other things: a gear's error, packets that a reading misses."""
    two = ["d17", "d30"]
    assert not [n for n in two if "clock skew" in {f.kind for f in check(measured("campaigns_d", n))}]


def test_records_that_do_not_excite_a_parameter_are_said(tmp_path):
    """Only the staircase is fitted, and of it only rest and the first step, which goes one way."""
    rig.campaign(tmp_path / "c", 1, (), short=True)
    folder = Folder(tmp_path / "c", tmp_path / "d")
    head, *records = (folder.place / "campaign.toml").read_text(encoding="utf-8").split("[[records]]")
    start = next(r["start_time_s"] for r in folder.declared["records"] if "staircase" in r["file"])
    first = f'until = {{ value = {start + 1.5}, unit = "s" }}\nrole'
    records = [
        r.replace("role", first) if "staircase" in r else r.replace('"identification"', '"validation"') for r in records
    ]
    (folder.place / "campaign.toml").write_text("[[records]]".join([head, *records]), encoding="utf-8")
    found = {f.subject: f for f in check(tmp_path / "d")}
    assert {f.kind for f in found.values()} == {"excitation missing"}
    assert {"presliding_hysteresis@axis.h0", "presliding_hysteresis@axis.x0"} <= set(found)
    assert "one way only" in found["presliding_hysteresis@axis.h0"].sentence
    assert "reverses" in found["presliding_hysteresis@axis.x0"].remedy


def test_an_encoder_that_never_moves_is_said_without_a_claim_on_the_axis(tmp_path):
    def still(table):
        table["position"][:] = table["position"][0]

    Folder(CARRIED["axis"], tmp_path / "c").change(still, "id_staircase")
    (found,) = check(tmp_path / "c")
    assert (found.kind, found.subject) == ("frozen", "id_staircase.position") and "axis moves" not in found.sentence


def test_an_encoder_too_coarse_for_the_stroke_of_friction_is_said(tmp_path):
    rig.campaign(tmp_path / "c", 1, (), short=True)
    Folder(tmp_path / "c", tmp_path / "d").declare("resolution = 4.848e-06", "resolution = 1e-3")
    found = {f.kind: f for f in check(tmp_path / "d")}
    assert "counts of position" in found["encoder resolution"].sentence
    assert "steps of 4.85e-06 rad" in found["encoder scale"].sentence  # the data show a finer one than is declared


def test_a_log_too_slow_for_the_bandwidth_is_said(tmp_path):
    rig.campaign(tmp_path / "c", 1, (), short=True)
    Folder(tmp_path / "c", tmp_path / "d").declare("value = 150", "value = 300")
    (found,) = [f for f in check(tmp_path / "d") if f.kind == "sampling rate"]
    assert "1000 Hz" in found.sentence and "1200 Hz" in found.sentence and "250 Hz" in found.remedy


def test_the_command_says_each_finding_with_its_remedy_and_exits_with_1(tmp_path, capsys):
    shutil.copytree(CARRIED["axis"].parent, tmp_path / "axis")
    assert main(["check", str(tmp_path / "axis")]) == 0
    assert "Nothing was found" in capsys.readouterr().out
    Folder(CARRIED["axis"], tmp_path / "c").change(times("drive", -1))
    assert main(["check", str(tmp_path / "c")]) == 1
    said = capsys.readouterr().out
    assert said.startswith("drive sign: In record") and "Turn the sign of the drive" in said and "1 finding" in said


def test_a_study_without_a_campaign_cannot_be_checked_and_says_so(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    assert main(["check", "emps"]) == 2
    assert "it has no campaign" in capsys.readouterr().err


def test_a_second_check_compiles_nothing_and_starts_only_the_libraries_that_it_stands_on():
    """What a user waits for is that start; benchmarks/reading.py tells how long it is."""
    spared = ("matplotlib", "cvxpy", "osqp", "control", "scipy.signal", "scipy.optimize", "pandas")
    lines = (
        "import sys",
        "from numba.core.event import install_recorder",
        "from workbench.cli import main",
        "with install_recorder('numba:compile') as compiled:",
        f"    code = main(['check', {str(CARRIED['models'])!r}])",
        f"print(code, len(compiled.buffer), *sorted(set({spared!r}) & set(sys.modules)))",
    )
    for _ in range(2):
        done = subprocess.run([sys.executable, "-c", "\n".join(lines)], cwd=ROOT, capture_output=True, text=True)
    # a machine that is busy takes more than two seconds, and then progress is said
    said = [line for line in done.stderr.splitlines() if not re.match(r"\s*[\d.]+ s  ", line)]
    assert (done.stdout.splitlines()[-1:], said) == (["0 0"], [])


def test_runs_are_maximal():
    assert [(r.first, r.last) for r in runs(np.array([1, 1, 2, 3, 3, 3, 0, 0.0]), 2)] == [(0, 1), (3, 5), (6, 7)]


def test_a_missing_sample_is_found_where_it_is_and_quantised_motion_has_none():
    position = np.round(1e4 * np.sin(np.linspace(0, 3, 3000)))
    assert _leaps(position, 1.0).size == 0
    assert _leaps(np.delete(position, [700, 701, 702]), 1.0).tolist() == [700]
