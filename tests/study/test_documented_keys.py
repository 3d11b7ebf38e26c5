"""What the pages show of campaign.toml, study.toml and C is read by the workbench as it stands there."""

import re
from pathlib import Path

import fuzz
import pytest

from workbench.campaign import load
from workbench.definition import find
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.simulation import Loop
from workbench.study import compensation, configuration, drive, limit_cycle, robustness
from workbench.task.task import Task

ROOT = Path(__file__).resolve().parents[2]
PLANT = Plant(ONE_MASS, (
    find("inertia")(inertia=2e-3), find("presliding_hysteresis")(h0=0.14, x0=1.7e-3), find("stribeck_friction")(drop=0.06, speed=0.6),
), limits=Limits(3.0, 20.0))  # fmt: skip
TASK = Task(PLANT, Loop(2.5e-4, 2, 1e-4, 2e-4, 5e-6), 0.5, 0.3)
OTHER = '[[records]]\nfile = "run.csv"\nrole = "validation"\n'
READ = {
    "robustness": lambda study: robustness.declared(study.table, TASK).limits,
    "limit_cycle": lambda study: limit_cycle.asked_of(study.table, TASK).controllers,
    "compensation": lambda study: compensation.asked(study, PLANT).on(PLANT),
    "drive": lambda study: drive.stated(study.table, PLANT, TASK.loop.count).formats,
}


def blocks(page: str, language: str) -> list[str]:
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", ["axes-that-differ.md", "compensation.md", "firmware.md"])
def test_a_table_of_study_toml_is_read_as_the_page_shows_it(tmp_path, page):
    for text in blocks(page, "toml"):
        (tmp_path / "study.toml").write_text(f'title = "t"\nquestion = "q"\n{text}', encoding="utf-8")
        assert READ[re.match(r"\[(\w+)\]", text)[1]](configuration.load(tmp_path))


def test_a_record_is_read_as_the_page_shows_it(tmp_path):
    (text,) = blocks("logs.md", "toml")
    head = fuzz.CAMPAIGN.partition("[[records]]")[0]
    (tmp_path / "campaign.toml").write_text(head + text + OTHER, encoding="utf-8")
    rows = "".join(f"{k / 1000:.3f},{(k * 7) % 5 - 2},{(k % 300) * 1e-3:.3f}\n" for k in range(10_000))
    (tmp_path / "run.csv").write_text("t,u,q\n" + rows)
    record, _ = load(tmp_path).records
    assert record.name == "run_loaded" and record.time[-1] - record.time[0] == pytest.approx(6.5, abs=0.01)


def test_c_that_the_page_shows_calls_what_is_written():
    (text,) = blocks("firmware.md", "c")
    folder = ROOT / "workbench" / "firmware"
    written = "".join(p.read_text(encoding="utf-8") for p in folder.iterdir() if p.suffix in (".h", ".c", ".in"))
    for name in set(re.findall(r"\bwb_axis_(\w+)|\b(WB_\w+)", text)):
        assert next(filter(None, name)) in written, name


def test_the_law_that_the_architecture_shows_is_the_one_of_the_catalogue():
    (text,) = blocks("architecture/effects.md", "python")
    law = text.splitlines()[-1].strip()
    assert any(law in p.read_text(encoding="utf-8") for p in (ROOT / "workbench" / "effects").glob("*.py"))
