"""Campaigns whose answer is known: the right cause first, and the error that the true structure would leave.

Errors are computed here once more, from the files that a trace writes and the records as measured.
"""

import contextlib
import csv
import gzip
import io
import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from workbench.campaign import load
from workbench.cli import main
from workbench.tracing.of_campaign import trace_campaign
from workbench.tracing.output import write

CARRIED = Path(__file__).resolve().parents[2] / "studies" / "harmonic_drive_axis" / "campaign"
WITHIN = 1.1  # times the error of the true structure, refitted


def smooth(x: np.ndarray, rate: float, cut: float) -> np.ndarray:
    """A low pass 1/(1 + (f/cut)^8) without phase, over a reflection of half a second at both ends."""
    pad = int(rate / 2)
    left, right = 2 * x[0] - x[1 : pad + 1][::-1], 2 * x[-1] - x[-pad - 1 : -1][::-1]
    long = np.concatenate([left, x, right])
    wave = np.fft.rfft(long) / (1.0 + np.power(np.fft.rfftfreq(long.size, 1.0 / rate) / cut, 8))
    return np.fft.irfft(wave, long.size)[pad:-pad]


def column(path: Path, name: str) -> np.ndarray:
    with gzip.open(path, "rt", newline="") as f:
        rows = csv.DictReader(f)
        return np.array([float(row[name]) for row in rows])


def validation_error(folder: Path, out: Path) -> float:
    """rms(F(T - That))/rms(F(T)) on the validation record, 50 ms trimmed, from what was measured and what was written."""
    declared = tomllib.loads((folder / "campaign.toml").read_text(encoding="utf-8"))
    said = json.loads((out / "trace.json").read_text(encoding="utf-8"))
    (file,) = [r["file"] for r in declared["records"] if r["role"] == "validation"]
    channels = declared["channels"]
    time = column(folder / file, channels["time"]["column"])
    drive = column(folder / file, (channels.get("torque") or channels["force"])["column"])
    with open(out / said["predictions"][file.partition(".")[0]], newline="") as f:
        assert next(csv.reader(f)) == ["time_s", "prediction"]
        rows = np.array([[float(x) for x in row] for row in csv.reader(f)])
    rate = (time.size - 1) / (time[-1] - time[0])
    cut = declared["evaluation_bandwidth"]["value"]
    trim = int(0.05 * rate)
    true = smooth(drive, rate, cut)[trim:-trim]
    predicted = smooth(np.interp(time, rows[:, 0], rows[:, 1]), rate, cut)[trim:-trim]
    return float(np.linalg.norm(true - predicted) / np.linalg.norm(true))


def answered(folder: Path, out: Path) -> tuple[dict, float]:
    """Trace a campaign; return trace.json and the validation error of what was written beside it."""
    write(trace_campaign(load(folder)), out)
    return read(folder, out)


def read(folder: Path, out: Path) -> tuple[dict, float]:
    """Return trace.json and the validation error of what was written beside it."""
    said = json.loads((out / "trace.json").read_text(encoding="utf-8"))
    error = validation_error(folder, out)
    assert said["nrmse"]["validation"]["after"] == pytest.approx(error, rel=1e-3)
    return said, error


@pytest.mark.parametrize("name", ["c03", "c04", "c05", "c07", "c10"])
def test_the_missing_effect_is_found_and_the_error_becomes_that_of_the_true_structure(campaigns, tmp_path, name):
    truth = json.loads((campaigns / "truth.json").read_text(encoding="utf-8"))[name]
    said, error = answered(campaigns / name, tmp_path)
    assert said["verdict"] == "cause"
    assert said["ranked"][0] in truth["missing"]
    assert sorted(said["added"]) == sorted(truth["missing"])
    assert error <= WITHIN * truth["nrmse_true"]


def test_nothing_is_added_to_a_model_that_lacks_nothing(campaigns, tmp_path):
    truth = json.loads((campaigns / "truth.json").read_text(encoding="utf-8"))["c01"]
    said, error = answered(campaigns / "c01", tmp_path)
    assert said["verdict"] == "nothing_missing" and said["added"] == [] and said["causes"] == []
    assert error <= WITHIN * truth["nrmse_declared"]


@pytest.fixture(scope="module")
def carried(tmp_path_factory) -> tuple[Path, str]:
    """The carried campaign, traced once by the command: its outputs, and what was said."""
    out = tmp_path_factory.mktemp("carried") / "out"
    with contextlib.redirect_stdout(io.StringIO()) as said:
        assert main(["trace", str(CARRIED), "--out", str(out)]) == 0
    return out, said.getvalue()


def test_the_carried_campaign_lacks_stribeck_friction(carried):
    """The truth of the rig that made it: 0.0583 N*m more at rest, gone with exp(-(v/0.6 rad/s)^2); 0.937 % is left."""
    said, error = read(CARRIED, carried[0])
    assert said["verdict"] == "cause" and said["ranked"][0] == "stribeck_friction"
    assert said["added"] == ["stribeck_friction"]
    assert error <= WITHIN * 0.00937
    (cause,) = said["causes"]
    assert cause["parameters"]["drop"]["value"] == pytest.approx(0.0583, rel=0.1)
    assert cause["parameters"]["speed"]["value"] == pytest.approx(0.6, rel=0.1)


def test_trace_writes_what_the_format_asks_for(carried):
    out, said = carried
    trace = json.loads((out / "trace.json").read_text())
    assert trace["verdict"] == "cause" and trace["ranked"][0] == "stribeck_friction" == trace["added"][0]
    assert trace["sentence"] in said
    assert set(trace["nrmse"]) == {"identification", "validation"}
    assert trace["nrmse"]["validation"]["after"] < trace["nrmse"]["validation"]["before"]
    cause = trace["causes"][0]
    assert cause["at"] == "axis" and set(cause["parameters"]) == {"drop", "speed"}
    low, high = cause["parameters"]["speed"]["interval_95"]
    assert low < cause["parameters"]["speed"]["value"] < high
    follows = {p["coordinate"]: p["explained"] for p in trace["where"] if p["model"] == "declared" and not p["record"]}
    assert max(follows, key=follows.get) == "velocity" and follows["velocity"] > 0.5
    assert trace["calibrations"] == []
    promised, blind, knowing = trace["closed_loop"]["responses"]
    assert (blind["tuned_on"], blind["run_on"], knowing["tuned_on"]) == ("declared", "extended", "extended")
    assert knowing["time_1pct"] < blind["time_1pct"]
    page = (out / "trace.html").read_text(encoding="utf-8")
    assert trace["sentence"].split(".")[0] in page and "Where the residual lives" in page
    assert (out / "trace.pdf").read_bytes().startswith(b"%PDF")
    for path in trace["predictions"].values():
        assert (out / path).read_text().startswith("time_s,prediction\n")
