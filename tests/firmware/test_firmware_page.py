"""The firmware's page of a report: what it says is what the firmware holds."""

import json
from dataclasses import replace

import numpy as np
import pytest
from firmware_bench import AXIS, COUNT, LOOP, Gains, need_compiler

from workbench.compensation import Compensator, compensated
from workbench.control import fixed_pd, scheduled_pd
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.firmware import firmware, host
from workbench.firmware.image import read
from workbench.firmware.summary import known, ram_of, rounding, summaries
from workbench.report.firmware import firmware_chapter
from workbench.study.firmware import firmware_part
from workbench.task.task import Task

EFFECTS = (
    find("inertia")(inertia=0.0074),
    find("viscous_friction")(viscous=0.02),
    find("presliding_hysteresis")(h0=0.15, x0=1.6e-3),
)
TASK = Task(replace(AXIS, effects=EFFECTS), LOOP, 20000 * COUNT, 0.2, frictions=(0.8, 1.2), phases=1)


def silent(_):
    return None


def test_a_study_leaves_firmware_and_its_page(tmp_path):
    need_compiler()
    part = firmware_part({"scheduled PD": lambda lanes: scheduled_pd(Gains)}, TASK, "cause", silent)
    assert part.figures["firmware_error_counts_float32"] <= 2.0
    assert part.figures["firmware_error_counts"] <= 2.0 and part.figures["firmware_bits_equal"] == 1.0
    (chapter,) = part.chapters
    assert chapter.title == "Firmware" and len([b for b in chapter.blocks if hasattr(b, "columns")]) == 3
    json.dumps(part.tables, allow_nan=False)
    (write,) = part.files
    write(tmp_path)
    image = read((tmp_path / "firmware" / "fixed" / "axis.bin").read_bytes())
    assert image.plant == TASK.plant.digest and image.verdict == 4


def test_the_page_holds_a_compensated_controller_beside_the_recommended_one(tmp_path):
    need_compiler()
    named = compensated(fixed_pd(900.0, 5.0), Compensator.of(TASK.plant, ["presliding_hysteresis"], source="reference"))
    both = {"scheduled PD": lambda lanes: scheduled_pd(Gains), named.name: lambda lanes: named}
    part = firmware_part(both, TASK, "cause", silent)
    assert part.figures["firmware_error_counts_float32"] <= 2.0
    assert part.figures["firmware_error_counts"] <= 2.0 and part.figures["firmware_bits_equal"] == 1.0
    assert "presliding hysteresis is a firmware beside it" in str(part.chapters[0].blocks)
    assert [t["controller"] for t in part.tables["firmware"]["beside"]] == [named.name]
    for write in part.files:
        write(tmp_path)
    place = tmp_path / "firmware" / "fixed_pd_compensated" / "fixed"
    assert {"axis.bin", "compensation.c", "compensation.bin", "compensation.hex", "compensation_table.h"} <= {
        p.name for p in place.iterdir()
    }


def test_without_a_compiler_the_page_says_so(monkeypatch):
    monkeypatch.setattr(host.shutil, "which", lambda name: None)
    part = firmware_part({"fixed PD": lambda lanes: fixed_pd(900.0, 5.0)}, TASK, "unknown", silent)
    assert "firmware_error_counts" not in part.figures
    assert "no C compiler here" in str(part.chapters[0].blocks)


def test_an_axis_without_counts_has_no_firmware():
    task = replace(TASK, loop=replace(LOOP, resolution=0.0))
    assert firmware_part({"fixed PD": lambda lanes: fixed_pd(900.0, 5.0)}, task, "cause", silent).chapters == ()


def test_what_was_compiled_leaves_nothing_on_the_disk(tmp_path, monkeypatch):
    need_compiler()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    source = {"seven.c": "int seven(void);\nint seven(void) { return 7; }\n"}
    assert host.compiled(source).seven() == 7
    with pytest.raises(WorkbenchError, match="does not compile"):
        host.compiled({"seven.c": "int seven(void) { return x; }"})
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("arithmetic", ["float32", "fixed"])
def test_memory_is_what_the_compiler_lays_out(arithmetic):
    need_compiler()
    for controller in (scheduled_pd(Gains), fixed_pd(900.0, 5.0)):
        made = firmware(controller, LOOP, AXIS, arithmetic)
        bench = '#include "axis.h"\nunsigned wb_size_of(void);\nunsigned wb_size_of(void) { return sizeof(wb_axis_table) + sizeof(wb_axis_state); }\n'
        library = host.compiled(made.files | {"bench.c": bench})
        assert library.wb_size_of() == ram_of(made)


def test_rounding_moves_the_sensitivity_by_no_more_than_said():
    """A loop with one gain off by the largest rounding error: its Ms lies within the bound."""
    made = summaries([(lambda lanes: fixed_pd(900.0, 5.0), "fixed")], replace(TASK, duration=0.05))[0]
    off, theta = rounding(made.made), np.geomspace(1e-2, 3.0, 400)
    loop = 0.12 * np.exp(-1j * theta) / (1.0 - np.exp(-1j * theta))
    peaks = [np.max(1.0 / np.abs(1.0 + g * loop)) for g in (1.0, 1.0 + off)]
    assert peaks[0] < 2.0 and abs(peaks[1] - peaks[0]) <= made.sensitivity


def test_the_measured_numbers_keep_what_a_schedule_may_take():
    """Those of the laws that a study's schedule may choose; the target's own tests hold the numbers themselves."""
    for rule in (
        "following",
        "frozen",
        "error",
        "closing",
        "following, joint, speed of the motor",
        "frozen, speed of the motor",
    ):
        found = known()[f"scheduled_pd, {rule}"]
        assert found["float32"]["worst"] <= 120 and found["fixed"]["worst"] <= 200
        assert max(v["code"] for v in found.values()) <= 4096
    assert firmware_chapter.__doc__
