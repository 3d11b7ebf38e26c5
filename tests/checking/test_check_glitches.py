"""A glitch of one sample is named, with its record, and nothing else is blamed; what an axis really did is no glitch."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from declared import declared

from workbench.checking.checking import check
from workbench.checking.glitches import lone
from workbench.cli import main
from workbench.intake.new import new

LOGS = Path(__file__).resolve().parents[2] / "docs" / "tutorial"


@pytest.fixture(scope="module")
def fast(tmp_path_factory):
    """The tutorial's campaign with the numbers of the data sheet."""
    place = tmp_path_factory.mktemp("fast") / "fast"
    new(place, [LOGS / "excitation.csv", LOGS / "moves.csv"])
    file = place / "campaign" / "campaign.toml"
    lines = file.read_text(encoding="utf-8").splitlines()
    scales = iter(('scale = { value = 2.79, unit = "N*m/A" }', 'scale = { value = 1.2e6, unit = "count/rev" }'))
    made = [next(scales) if line.startswith("scale =") else line for line in lines if not line.startswith("assumed")]
    file.write_text("\n".join(made) + "\n", encoding="utf-8")
    return place / "campaign"


def spiked(fast: Path, place: Path, column: int, value: str, rows=(999,), file: str = "excitation.csv") -> Path:
    """Copy a campaign with one cell changed. rows: from 0, below the header; column: of t, i, pos."""
    shutil.copytree(fast, place)
    lines = (place / file).read_text().splitlines()
    for row in rows:
        cells = lines[row + 1].split(",")
        cells[column] = value
        lines[row + 1] = ",".join(cells)
    (place / file).write_text("\n".join(lines) + "\n")
    return place


def test_the_sound_campaign_has_no_findings(fast):
    assert check(fast) == ()


@pytest.mark.parametrize("value", ["1e9", "1e15", "1e30", "500000", "1e200", "1e308", "-1e308"])
def test_one_wrong_sample_of_the_encoder_is_named_and_nothing_else(fast, tmp_path, value):
    (found,) = check(spiked(fast, tmp_path / "c", 2, value))
    assert found.kind == "glitch" and "sample 1000 of position" in found.sentence and "'excitation'" in found.sentence


@pytest.mark.parametrize("value", ["1e4", "1e6", "1e30", "1e308"])
def test_one_wrong_sample_of_the_drive_is_named_and_no_sound_record_is_blamed(fast, tmp_path, value):
    (found,) = check(spiked(fast, tmp_path / "c", 1, value))
    assert found.kind == "glitch" and "sample 1000 of torque" in found.sentence and "moves" not in found.sentence


@pytest.mark.parametrize("row", [0, 1, 7, 2500, -2, -1])
@pytest.mark.parametrize("file", ["excitation.csv", "moves.csv"])
def test_it_is_named_wherever_it_is(fast, tmp_path, row, file):
    rows = len((fast / file).read_text().splitlines()) - 1
    (found,) = check(spiked(fast, tmp_path / "c", 2, "400000", (row % rows,), file))
    assert found.kind == "glitch" and f"sample {row % rows + 1} of position" in found.sentence
    assert found.subject.startswith(file.removesuffix(".csv"))


def test_a_position_that_no_axis_has_is_a_sentence_in_every_verb(fast, tmp_path, capsys):
    place = spiked(fast, tmp_path / "c", 2, "1e300", range(3000))
    (found,) = check(place)
    assert "sample 1 of position in record 'excitation'" in found.sentence and "2999 further" in found.sentence
    assert main(["trace", str(place), "--out", str(tmp_path / "o")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "no axis has that" in said and not (tmp_path / "o").exists()


def made(place: Path, spike_felt: bool, size: float) -> Path:
    """Write a campaign of a rigid axis, J dv/dt = u - b v, whose drive has one sample of `size` in its log, felt or not."""
    place.mkdir()
    (place / "campaign.toml").write_text(declared("made", 60, 1e-5))
    t, dt = np.arange(3000) * 1e-3, 1e-3
    for name, seed in (("a", 1), ("b", 2)):
        phases = np.random.default_rng(seed).uniform(0, 6, 6)
        u = 1.0 + sum(
            0.2 * np.sin(2 * np.pi * f * t + p) for f, p in zip((1, 2.3, 4.1, 7, 12, 19), phases, strict=True)
        )
        logged = u.copy()
        if name == "a":
            logged[1500] += size
            u[1500] += size if spike_felt else 0.0
        v = q = 0.0
        seen = np.empty(t.size)
        for k in range(t.size):
            seen[k] = q
            v += dt * (u[k] - 2.0 * v) / 0.05
            q += dt * v
        rows = np.column_stack([t, logged, 1e-5 * np.floor(seen / 1e-5)])
        np.savetxt(place / f"{name}.csv", rows, "%.8g", ",", header="t,u,q", comments="")
    return place


@pytest.mark.parametrize("size", [100.0, 400.0])
def test_a_pulse_of_one_sample_that_the_axis_felt_is_none(tmp_path, size):
    assert "glitch" not in {f.kind for f in check(made(tmp_path / "felt", True, size))}
    (found,) = [f for f in check(made(tmp_path / "not", False, size)) if f.kind == "glitch"]
    assert "sample 1501 of torque" in found.sentence and "did not feel" in found.sentence


@pytest.mark.parametrize("seed", range(20))
def test_noise_steps_and_bursts_are_no_lone_samples(seed):
    rng = np.random.default_rng(seed)
    x = np.cumsum(rng.normal(0, 1, 4000)) + rng.normal(0, 3, 4000)
    x[2000:] += 500.0  # a step
    x[1000:1004] += 300.0  # a burst
    assert lone(x, 0.0).size == 0
    x[3000] += 1e3
    assert lone(x, 0.0).tolist() == [3000]
