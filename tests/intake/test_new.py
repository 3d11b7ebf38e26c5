"""From somebody's log files to a running study: what is guessed, what is said, and that it is written whole or not at all.

The logs are made by the rig of tests/rig, which shares nothing with the workbench, in the dialects of other people.
"""

import json
from pathlib import Path

import numpy as np
import pytest
import rig

from workbench.campaign import load
from workbench.cli import main
from workbench.errors import WorkbenchError
from workbench.intake.names import meaning
from workbench.intake.new import new
from workbench.intake.signals import clock_unit, quantum
from workbench.readers import survey

TORQUE_CONSTANT, COUNTS = 0.093, 20_000  # N*m/A, counts a revolution


@pytest.fixture(scope="module")
def axis(tmp_path_factory):
    """What the rig measured, in SI: record stem -> (n, 3) of time, torque and position; and its truth."""
    folder = tmp_path_factory.mktemp("rig")
    truth = rig.campaign(folder, 3, ("coulomb_asymmetry",), short=True)
    return {f.stem: np.loadtxt(f, delimiter=",", skiprows=1) for f in folder.glob("*.csv")}, truth


def foreign(record, *, turned=1.0):
    """Time in ms from zero, current in A, position in counts."""
    t, torque, position = record.T
    return np.column_stack(
        [1e3 * (t - t[0]), turned * torque / TORQUE_CONSTANT, np.round(position / (2 * np.pi) * COUNTS)]
    )


def csv(path: Path, table, header="t,i,pos", form="%.0f,%.4f,%d", top="") -> Path:
    lines = [header] if header else []
    path.write_text(top + "\n".join([*lines, *(form % tuple(row) for row in table)]) + "\n", encoding="utf-8")
    return path


def edit(folder: Path, *pairs):
    file = folder / "campaign" / "campaign.toml"
    text = file.read_text(encoding="utf-8")
    for old, new_ in pairs:
        assert old in text
        text = text.replace(old, new_)
    file.write_text(text, encoding="utf-8")


CONSTANTS = (
    ('value = 1.0, unit = "N*m/A", assumed = true', f'value = {TORQUE_CONSTANT}, unit = "N*m/A"'),
    ('value = 4096.0, unit = "count/rev", assumed = true', f'value = {COUNTS}, unit = "count/rev"'),
)


def test_three_columns_of_unknown_origin_end_in_a_report_with_three_commands_and_one_edited_file(
    axis, tmp_path, monkeypatch, capsys
):
    records, truth = axis
    monkeypatch.chdir(tmp_path)
    csv(Path("a.csv"), foreign(records["id_multisine"]))
    csv(Path("b.csv"), foreign(records["val_moves"]))
    assert main(["new", "axis", "--records", "a.csv", "b.csv"]) == 0
    said = capsys.readouterr().out
    assert "channels.torque.scale, channels.position.scale" in said
    edit(Path("studies/axis"), *CONSTANTS)
    assert main(["run", "axis"]) == 0
    assert "No gains are tuned" in capsys.readouterr().out  # the file that was edited states no limit of the drive
    assert Path("reports/axis/report.html").stat().st_size > 0
    results = json.loads(Path("reports/axis/results.json").read_text(encoding="utf-8"))
    (inertia,) = [p for p in results["model_after"]["parameters"] if p["parameter"] == "inertia"]
    assert inertia["value"] == pytest.approx(truth["axis"]["inertia"], rel=0.03)


def test_a_study_runs_before_anything_is_edited_and_says_what_it_assumed(axis, tmp_path):
    records, _ = axis
    made = new(tmp_path / "axis", [csv(tmp_path / f"{n}.csv", foreign(r)) for n, r in records.items()])
    assert made.edit == ("channels.torque.scale", "channels.position.scale")
    campaign = load(tmp_path / "axis" / "campaign")
    assert [f.subject for f in campaign.findings if f.kind == "assumed scale"] == ["torque", "position"]
    assert {r.name for r in campaign.with_role("validation")} == {"val_moves"}
    assert campaign.records[0].dt == pytest.approx(1e-3)


@pytest.mark.parametrize(
    ("header", "form", "top"),
    [
        ("", "%.0f;%.4f;%d", ""),
        ("", "%.0f %.4f %d", ""),
        ("Zeit [ms];Strom [A];Lage [Ink]", "%.0f;%.4f;%d", ""),
        ("a;b;c", "%.0f;%.4f;%d", "Recorder 7;;\nexported at noon;;\n"),
        ("# t, iq_act, enc", "%.0f,%.4f,%d", ""),
        ("ms\tA\tcount", "%.0f\t%.4f\t%d", ""),
    ],
)
def test_the_channels_are_found_however_the_log_is_written(axis, tmp_path, header, form, top):
    records, _ = axis
    files = [csv(tmp_path / f"{n}.csv", foreign(records[n]), header, form, top) for n in ("id_multisine", "val_moves")]
    new(tmp_path / "axis", files)
    edit(tmp_path / "axis", *CONSTANTS)
    campaign = load(tmp_path / "axis" / "campaign")
    for record in campaign.records:
        t, torque, position = records[record.name].T
        np.testing.assert_allclose(record.time, t - t[0], atol=1e-9)
        np.testing.assert_allclose(record.channels["torque"], torque, atol=1e-5)
        np.testing.assert_allclose(record.channels["position"], position, atol=np.pi / COUNTS * 1.01)


def test_decimal_commas_are_read(axis, tmp_path):
    table = foreign(axis[0]["val_moves"])[:3000]
    file = csv(tmp_path / "a.csv", table, "t;i;pos", "%.0f;%.4f;%d")
    file.write_text(file.read_text().replace(".", ","), encoding="utf-8")
    np.testing.assert_allclose(survey(file).columns["i"], table[:, 1], atol=1e-4)


def test_a_drive_that_counts_against_the_position_gets_a_minus_sign(axis, tmp_path):
    records, _ = axis
    files = [csv(tmp_path / f"{n}.csv", foreign(r, turned=-1.0)) for n, r in records.items()]
    made = new(tmp_path / "axis", files)
    assert any("minus" in line for line in made.lines)
    torque = load(tmp_path / "axis" / "campaign").records[0].channels["torque"]
    assert np.corrcoef(torque, axis[0][files[0].stem][:, 1])[0, 1] > 0.999


def test_a_single_record_is_parted_and_none_of_it_serves_twice(axis, tmp_path):
    new(tmp_path / "axis", [csv(tmp_path / "log.csv", foreign(axis[0]["id_staircase"]))])
    first, second = load(tmp_path / "axis" / "campaign").records
    assert (first.role, second.role) == ("identification", "validation")
    assert first.time[-1] < second.counts_from <= first.time[-1] + 2e-3
    share = first.time.size / second.time.size
    assert 0.5 < share < 0.8


def test_the_reference_is_told_from_the_position_by_which_leads(axis, tmp_path):
    table = foreign(axis[0]["id_staircase"])
    lag = 12
    ahead = np.append(table[lag:, 2], np.full(lag, table[-1, 2]))
    both = np.column_stack([table[:, :2], ahead, table[:, 2]])
    new(tmp_path / "axis", [csv(tmp_path / "log.csv", both, "t,i,p1,p2", "%.0f,%.4f,%d,%d")])
    source = load(tmp_path / "axis" / "campaign").records[0].source
    assert (source.columns["position"], source.columns["reference"]) == ("p2", "p1")


def test_dropped_samples_are_resampled_and_said(axis, tmp_path):
    table = np.delete(foreign(axis[0]["val_moves"]), [700, 1500, 1501, 2600], axis=0)
    made = new(tmp_path / "axis", [csv(tmp_path / "log.csv", table)])
    assert any("3 time steps" in line for line in made.lines)
    assert "resampled" in {f.kind for f in load(tmp_path / "axis" / "campaign").findings}


def test_a_matlab_file_with_other_variables_is_read(axis, tmp_path):
    import scipy.io

    t, i, pos = foreign(axis[0]["val_moves"]).T
    scipy.io.savemat(tmp_path / "log.mat", {"t": t, "i": i, "pos": pos, "gain": 3.5, "note": "a text"})
    new(tmp_path / "axis", [tmp_path / "log.mat"])
    assert load(tmp_path / "axis" / "campaign").records[0].source.columns["torque"] == "i"


def test_a_study_that_is_there_is_not_overwritten(axis, tmp_path):
    file = csv(tmp_path / "log.csv", foreign(axis[0]["val_moves"]))
    new(tmp_path / "axis", [file])
    before = (tmp_path / "axis" / "study.toml").read_bytes()
    with pytest.raises(WorkbenchError, match="already"):
        new(tmp_path / "axis", [file])
    assert (tmp_path / "axis" / "study.toml").read_bytes() == before


@pytest.mark.parametrize(
    ("table", "header", "words"),
    [
        (lambda t: t[:, :2], "t,i", "2 columns of numbers"),
        (lambda t: t[1000:1040], "t,i,pos", "at least 50"),
        (lambda t: np.column_stack([t[::-1, 0], t[:, 1:]]), "t,i,pos", "no column increases"),
        (lambda t: np.column_stack([t[:, 0], np.random.default_rng(1).normal(size=(len(t), 2))]), "a,b,c", "be told"),
    ],
)
def test_files_that_make_no_campaign_are_refused_and_nothing_is_left(axis, tmp_path, table, header, words):
    made = table(foreign(axis[0]["val_moves"]))
    file = csv(tmp_path / "log.csv", made, header, ",".join(["%.6g"] * made.shape[1]))
    with pytest.raises(WorkbenchError, match=words):
        new(tmp_path / "axis", [file])
    assert [p.name for p in tmp_path.iterdir()] == ["log.csv"]


def control(folder: Path, said: str = ""):
    """What a study's controller is tuned for, with these lines put into its study.toml."""
    from workbench.inverse.dynamics import inverse_dynamics
    from workbench.study import configuration
    from workbench.study.control import control_of
    from workbench.verification.assumed import shown_by

    file = folder / "study.toml"
    text = file.read_text(encoding="utf-8")
    table, _, line = said.partition(" ")
    file.write_text(text.replace(f"[{table}]", f"[{table}]\n{line} #", 1) if said else text, encoding="utf-8")
    campaign = load(folder / "campaign")
    shown = shown_by(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth))
    return control_of(configuration.load(folder).table, campaign.plant, shown)


@pytest.fixture
def limited(axis, tmp_path):
    """A new study whose campaign states the limit of its drive; and its only record, in SI."""
    new(tmp_path / "axis", [csv(tmp_path / "log.csv", foreign(axis[0]["val_moves"]))])
    edit(tmp_path / "axis", *CONSTANTS, ("# actuator_limit", "actuator_limit"))
    return tmp_path / "axis", axis[0]["val_moves"]


def test_gains_are_asked_for_by_one_more_line_and_the_records_say_what_is_not_stated(limited):
    folder, record = limited
    found = control(folder)
    assert found.goal.drive == 1.0 and found.raised
    assert (found.loop.sample_time, found.loop.delay) == pytest.approx((1e-3, 1e-3))
    assert found.loop.resolution == pytest.approx(2 * np.pi / COUNTS)
    travel = np.ptp(record[:, 2])
    assert found.task.step == pytest.approx(travel / 2, rel=0.01)
    assert found.task.start == pytest.approx(record[:, 2].min() + travel / 4, abs=0.01 * travel)
    assert found.speed_limit == pytest.approx(np.abs(np.gradient(record[:, 2], 1e-3)).max(), rel=0.2)


def test_what_a_new_study_states_comes_before_what_its_records_show(limited):
    found = control(limited[0], 'loop sample_time = { value = 0.25, unit = "ms" }')
    assert found.loop.sample_time == 0.25e-3 and found.loop.delay == 0.0
    assert control(limited[0], 'task step = { value = 1, unit = "rad" }').task.step == 1.0


def test_a_misspelt_key_of_the_controller_is_said_before_anything_is_fitted(limited, monkeypatch, capsys):
    folder, _ = limited
    file = folder / "study.toml"
    file.write_text(file.read_text(encoding="utf-8").replace("# sample_time", "sample_tine"), encoding="utf-8")
    monkeypatch.setattr("workbench.study.standard.trace", lambda *_: pytest.fail("a trace was begun"))
    assert main(["run", str(folder), "--out", str(folder.parent / "out")]) == 2
    assert "sample_time" in capsys.readouterr().err and not (folder.parent / "out").exists()


def test_two_encoders_make_two_masses_and_a_load_that_stands_is_locked(tmp_path):
    carried = Path(__file__).resolve().parents[2] / "studies" / "harmonic_drive_models" / "campaign"
    new(tmp_path / "axis", sorted(carried.glob("*.csv.gz")))
    found, known = load(tmp_path / "axis" / "campaign"), load(carried)
    assert found.plant.kind == known.plant.kind == "two mass"
    mine, theirs = ({r.name: (r.role, r.locked) for r in c.records} for c in (found, known))
    assert mine == theirs
    resolution = found.records[0].resolution
    for name, step in known.records[0].resolution.items():
        assert resolution[name] == pytest.approx(step, rel=1e-3)


def test_of_two_forces_the_one_that_motion_explains_is_the_drive(axis, tmp_path):
    table = foreign(axis[0]["val_moves"])
    other = np.random.default_rng(2).normal(size=(len(table), 1))
    file = csv(tmp_path / "log.csv", np.hstack([table[:, :1], other, table[:, 1:]]), "t,i1,i2,pos", "%.0f,%.3f,%.4f,%d")
    file.write_text(file.read_text().replace("i1,i2", "i b,i a"), encoding="utf-8")
    new(tmp_path / "axis", [file])
    assert load(tmp_path / "axis" / "campaign").records[0].source.columns["torque"] == "i a"


def test_what_the_user_says_comes_before_every_guess(axis, tmp_path):
    table = foreign(axis[0]["val_moves"])
    file = csv(tmp_path / "log.csv", table[:, [0, 2, 1]], "t,i,pos", "%.0f,%d,%.4f")  # wrong names
    new(tmp_path / "axis", [file], {"drive": "pos", "position": "i"})
    assert load(tmp_path / "axis" / "campaign").records[0].source.columns["position"] == "i"
    with pytest.raises(WorkbenchError, match="there is no such column"):
        new(tmp_path / "other", [file], {"drive": "current"})


@pytest.mark.parametrize(
    ("text", "said"), [("drive", "--channel drive=COLUMN"), ("driev=i", "did you mean 'drive'"), ("drive=", "COLUMN")]
)
def test_a_channel_that_is_told_wrongly_is_answered_with_how_to_tell_it(
    text, said, axis, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    csv(tmp_path / "log.csv", foreign(axis[0]["val_moves"])[:2000])
    assert main(["new", "axis", "--records", "log.csv", "--channel", text]) == 2
    assert said in capsys.readouterr().err and not (tmp_path / "studies").exists()


@pytest.mark.parametrize(
    ("name", "kind", "unit", "quality"),
    [
        ("Time (s)", "time", "s", set()),
        ("torque_Nm", "torque", "N*m", set()),
        ("Iq_act [mA]", "current", "mA", {"measured"}),
        ("pos_um", "position", "um", set()),
        ("stage_nm", "position", "nm", set()),
        ("Actual Position / deg", "position", "deg", {"measured"}),
        ("PosRef_mm", "position", "mm", {"reference"}),
        ("speed_rpm", "velocity", "rpm", set()),
        ("Lage [Ink]", "position", "count", set()),
        ("Torque [%]", "torque", "percent", set()),
        ("load_position_rad", "position", "rad", {"load"}),
        ("following error", "", "", {"error"}),
        ("column 2", "", "", set()),
        ("theta_m", "position", "", set()),
        ("x-output-current", "current", "", set()),
        ("current_in", "current", "", set()),
        ("ms_today", "time", "ms", set()),
        ("torque [N.m]", "torque", "N*m", set()),
        ("AIPos.A1", "position", "", set()),
    ],
)
def test_a_name_says_quantity_unit_and_quality(name, kind, unit, quality):
    found = meaning(name)
    assert (found.kind, found.unit, set(found.quality)) == (kind, unit, quality)


@pytest.mark.parametrize(
    ("step", "unit"), [(1e-3, "s"), (1.0, "ms"), (0.25, "ms"), (62.5, "us"), (1e6, "ns"), (4e-3, "s")]
)
def test_the_unit_of_a_clock_is_the_one_in_which_drives_log(step, unit):
    assert clock_unit(step * np.arange(200))[0] == unit


def test_the_step_of_an_encoder_is_found_in_rounded_decimals():
    position = 4.848e-6 * np.round(300 * np.sin(np.linspace(0, 6, 4000)))
    assert quantum(np.round(position, 7)) == pytest.approx(4.848e-6, rel=0.01)
    assert quantum(np.sin(np.linspace(0, 6, 4000))) == 0.0


def wave(n=1500, seed=5):
    """Time in s, torque in N*m and position in rad of an axis in closed form, and a reference 5 ms ahead of it."""
    t, noise = np.arange(n) * 1e-3, np.random.default_rng(seed).normal(size=n)
    q, v, a = (
        np.sin(9 * t) + 0.2 * np.sin(31 * t),
        9 * np.cos(9 * t),
        -81 * np.sin(9 * t) - 0.2 * 31**2 * np.sin(31 * t),
    )
    v = v + 0.2 * 31 * np.cos(31 * t)
    torque = 0.01 * a + 0.02 * v + 0.1 * np.tanh(v / 0.1) + 0.005 * noise
    return t, torque, q, np.sin(9 * (t + 0.005)) + 0.2 * np.sin(31 * (t + 0.005))


def made_of(tmp_path, header, *columns, name="log.csv", **flags):
    """Return what `new` says of a log of these columns, in one text, and the campaign."""
    np.savetxt(tmp_path / name, np.column_stack(columns), "%.9g", ",", header=header, comments="")
    said = new(tmp_path / "axis", [tmp_path / name], **flags)
    return "\n".join(said.lines), load(tmp_path / "axis" / "campaign")


def refusal(tmp_path, header, *columns, **flags):
    with pytest.raises(WorkbenchError) as caught:
        made_of(tmp_path, header, *columns, **flags)
    assert not (tmp_path / "axis").exists()
    return str(caught.value)


def test_a_column_called_time_is_taken_with_its_jitter_and_that_is_said(tmp_path):
    t, torque, q, _ = wave()
    uneven = t + np.random.default_rng(1).uniform(-4e-4, 4e-4, t.size)
    said, campaign = made_of(tmp_path, "time,torque_Nm,angle_rad", uneven, torque, q)
    assert "time: column 'time' in 's'" in said and "resampled" in said
    assert campaign.records[0].dt == pytest.approx(1e-3, rel=0.05)


def test_a_counter_of_samples_has_a_rate_that_is_assumed(tmp_path):
    t, torque, q, _ = wave()
    said, campaign = made_of(tmp_path, "sample,torque_Nm,angle_rad", np.arange(t.size), torque, q)
    assert "1000 count/s, assumed" in said
    assert "time" in {f.subject for f in campaign.findings if f.kind == "assumed scale"}


def test_a_rate_that_two_units_would_make_is_assumed(tmp_path):
    t, torque, q, _ = wave()
    said, campaign = made_of(tmp_path, "time,torque_Nm,angle_rad", 20 * t, torque, q)  # 50 Hz in s, 50 kHz in ms
    assert "50 Hz in s, 50000 Hz in ms" in said
    assert "time" in {f.subject for f in campaign.findings if f.kind == "assumed scale"}


def test_samples_without_time_ask_for_their_rate(tmp_path):
    _, torque, q, _ = wave()
    assert "--rate HZ" in refusal(tmp_path, "torque_Nm,angle_rad,spare", torque, q, q * 0 + 1)
    _, campaign = made_of(tmp_path, "torque_Nm,angle_rad", torque, q, rate=2000.0)
    assert campaign.records[0].dt == pytest.approx(5e-4)


def test_several_axes_are_listed_and_asked_for(tmp_path):
    t, torque, q, _ = wave()
    _, other, place, _ = wave(seed=6)
    columns = (t, q, place[::-1], torque, other[::-1])
    header = "t,position.q6,position.q7,effort.q6,effort.q7"
    assert "2 axes (q6, q7); say which one is meant: --axis q6" in refusal(tmp_path, header, *columns)
    assert "did you mean 'q7'" in refusal(tmp_path, header, *columns, axis="q77")
    said, campaign = made_of(tmp_path, header, *columns, axis="q7")
    assert campaign.records[0].source.columns["torque"] == "effort.q7"
    assert "'position.q6', 'effort.q6': of axis q6" in said
    assert "a sliding joint's is in" in said and {"torque", "position"} <= {f.subject for f in campaign.findings}


def test_an_unknown_unit_is_refused_with_the_nearest_and_told_by_a_flag(tmp_path):
    t, torque, q, _ = wave()
    sentence = refusal(tmp_path, "t,torque [Nmc],angle_rad", t, 1e2 * torque, q)
    assert "states the unit 'Nmc', which is not known for a torque; nearest: N*m, N*mm, N*cm." in sentence
    assert sentence.endswith("--unit 'torque [Nmc]=N*m'")
    _, campaign = made_of(tmp_path, "t,torque [Nmc],angle_rad", t, 1e2 * torque, q, units={"torque [Nmc]": "N*cm"})
    assert np.ptp(campaign.records[1].channels["torque"]) == pytest.approx(np.ptp(torque), rel=1e-6)
    (tmp_path / "b").mkdir()
    assert "there is no such unit" in refusal(tmp_path / "b", "t,i,pos", t, torque, q, units={"i": "furlong"})


def test_a_reference_is_one_by_slope_and_scale_and_else_only_listed(tmp_path):
    t, torque, q, reference = wave()
    said, campaign = made_of(
        tmp_path, "t,torque_Nm,angle_rad,setpoint_deg,gear", t, torque, q, np.degrees(reference), 30 * q
    )
    assert campaign.records[0].source.columns["reference"] == "setpoint_deg"
    assert "'gear': it follows the position, 30 times as far: perhaps a second encoder" in said
    for folder, header, scale in (
        ("b", "t,torque_Nm,angle_rad,setpoint", 57.3),
        ("c", "t,torque_Nm,angle_rad,other", 1.2),
    ):
        (tmp_path / folder).mkdir()
        said, campaign = made_of(tmp_path / folder, header, t, torque, q, scale * reference)
        assert "reference" not in campaign.records[0].channels and "not used:" in said


def test_what_is_not_used_is_listed_with_what_it_might_be_and_what_is_stuck_is_passed_over(tmp_path):
    t, torque, q, _ = wave()
    stuck = np.where(t < 0.7, 0.0, 1.0)
    columns = (t, stuck, torque, torque / 0.1, q, 30 + t)
    said, campaign = made_of(tmp_path, "t,torque_sensor_Nm,torque_Nm,iq_A,angle_rad,motor_temp", *columns)
    assert campaign.records[0].source.columns["torque"] == "torque_Nm"
    assert "'torque_sensor_Nm': it does not change" in said
    assert "'iq_A': a current beside the drive" in said and "'motor_temp': a temperature" in said


def test_why_a_column_was_left_out_is_said_where_it_is_missed(tmp_path):
    t, torque, q, _ = wave()
    torque[100:120] = np.nan
    assert "column 'torque_Nm' holds 'nan'" in refusal(
        tmp_path, "t,torque_Nm,angle_deg,setpoint_deg", t, torque, q, q * 1.5
    )


def test_of_two_axes_without_names_neither_is_guessed(tmp_path):
    t, torque, q, _ = wave()
    _, other, place, _ = wave(seed=6)
    assert "several pairs of columns" in refusal(
        tmp_path, "a,b,c,d,e", t, torque, q, other[::-1], place[::-1] + 0.5 * t
    )


@pytest.mark.parametrize("name", ["all", "clean", "bench-trace", "-x", ".hidden", "a b", "x" * 101])
def test_a_name_that_a_command_or_a_folder_would_misunderstand_is_refused(tmp_path, name):
    with pytest.raises(WorkbenchError, match="command of the Makefile|cannot name a study"):
        new(tmp_path / name, [tmp_path / "log.csv"])


def test_the_commands_of_the_makefile_are_those_that_names_must_not_have():
    from workbench.intake.new import VERBS

    text = (Path(__file__).resolve().parents[2] / "Makefile").read_text(encoding="utf-8")
    (line,) = [line for line in text.splitlines() if line.startswith("VERBS")]
    assert set(line.split(":=")[1].split()) <= set(VERBS)


def test_one_log_under_two_names_is_refused(axis, tmp_path):
    file = csv(tmp_path / "a.csv", foreign(axis[0]["val_moves"]))
    (tmp_path / "b.csv").write_bytes(file.read_bytes())
    with pytest.raises(WorkbenchError, match="the same bytes as"):
        new(tmp_path / "axis", [file, tmp_path / "b.csv"])


def test_file_names_with_dots_make_two_records(axis, tmp_path):
    files = [csv(tmp_path / f"run.{k}.csv", foreign(axis[0][n])) for k, n in enumerate(("id_multisine", "val_moves"))]
    new(tmp_path / "axis", files)
    assert {r.name for r in load(tmp_path / "axis" / "campaign").records} == {"run_0", "run_1"}


def test_two_masses_begin_with_dry_friction_on_both(tmp_path):
    from workbench.intake.text import TWO_MASS

    assert {at for at, name, *_ in TWO_MASS if name == "coulomb_friction"} == {"motor", "load"}


def test_axis_rate_and_unit_are_told_on_the_command_line(tmp_path, monkeypatch, capsys):
    _, torque, q, _ = wave()
    monkeypatch.chdir(tmp_path)
    columns = np.column_stack([1e2 * torque, q, torque[::-1], q[::-1]])
    np.savetxt("log.csv", columns, "%.9g", ",", header="tau1 [x],q1_rad,tau2 [x],q2_rad", comments="")
    told = ["--axis", "1", "--rate", "2000", "--unit", "tau1 [x]=N*cm"]
    assert main(["new", "axis", "--records", "log.csv", *told]) == 0
    assert "2000 Hz" in capsys.readouterr().out
    record = load(Path("studies/axis/campaign")).records[1]
    assert record.dt == pytest.approx(5e-4) and record.source.columns["torque"] == "tau1 [x]"
    assert np.ptp(record.channels["torque"]) == pytest.approx(np.ptp(torque), rel=1e-6)
    for wrong, said in ((["--rate", "0"], "--rate 0"), (["--unit", "tau1"], "--unit COLUMN=UNIT")):
        assert main(["new", "other", "--records", "log.csv", *wrong]) == 2
        assert said in capsys.readouterr().err
