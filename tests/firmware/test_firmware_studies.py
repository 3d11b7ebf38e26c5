"""A whole closed-loop trajectory of each study that exports: the bits of host C, of Python, and of an emulated Cortex-M4.

`studies/` holds what each study's run left in robustness/worst.json, without the cases: its plant, loop, task and controllers.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from firmware_bench import need, need_compiler

need("elftools", "no emulator here")
from firmware_target import CPUS, Target  # noqa: E402

from workbench.firmware import firmware  # noqa: E402
from workbench.firmware.comparison import COUNTS, reach, same_bits  # noqa: E402
from workbench.firmware.loop import run_firmware  # noqa: E402
from workbench.robustness import worst  # noqa: E402
from workbench.simulation import ScenarioArrays  # noqa: E402

STUDIES = Path(__file__).with_name("studies")
RUNS = (
    ("harmonic_drive_axis", "scheduled PD (error)"),
    ("harmonic_drive_axis", "fixed PD, compensated"),
    ("harmonic_drive_single_mass", "scheduled PD (following)"),
    ("harmonic_drive_two_mass", "scheduled PD (relative displacement)"),
)
ARITHMETICS = ("float32", "fixed")


@cache
def left(study: str):
    return worst.read(STUDIES / f"{study}.json")[0]


def beside(files: dict) -> dict:
    """The bench of a law with its compensation: the fourth word of a sample is the position that this is handed."""
    text = files["vectors.c"]
    text = text.replace('#include "axis.h"', '#include "axis.h"\n#include "compensation.h"')
    kept = "static wb_axis_state state;"
    loader = """
static wb_compensation_table beside_table;
static wb_compensation_state beside_state;
uint32_t wb_vectors_load_beside(const uint8_t *bytes, uint32_t size);
uint32_t wb_vectors_load_beside(const uint8_t *bytes, uint32_t size)
{
    return (uint32_t)wb_compensation_load(&beside_table, bytes, (size_t)size, NULL);
}
"""
    started = "    wb_axis_start(&state, &table, &now);"
    began = "    const wb_compensation_inputs here = {in[0], 0u};\n    wb_compensation_start(&beside_state, &beside_table, &here);\n"
    stepped = "    const wb_axis_inputs now = inputs_of(in);\n    return "
    handed = """    wb_axis_inputs now = inputs_of(in);
    const wb_compensation_inputs here = {in[3], 0u};
    now.added = wb_compensation_step(&beside_state, &beside_table, &here);
    return """
    assert all(text.count(x) == 1 for x in (kept, started, stepped))
    text = text.replace(kept, kept + loader).replace(started, began + started).replace(stepped, handed)
    return files | {"vectors.c": text}


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize(("study", "name"), RUNS)
def test_a_studys_trajectory_has_the_same_bits_everywhere(study, name, arithmetic, tmp_path):
    need_compiler()
    work = left(study)
    task, controller = work.task, work.controllers[name]
    count = task.loop.count
    aim = count * np.floor(task.step / count + 0.5)
    scenario = ScenarioArrays(1, target=aim, noise=task.noise, phase=0.3, seed=np.array([5]))
    made = firmware(controller, task.loop, task.plant, arithmetic, **reach(task))
    run = run_firmware(made, task.plant, task.loop, scenario, task.duration, task.criteria)
    samples, same = same_bits(made, run, np.array([aim]))
    assert same == samples == round(task.duration / task.loop.sample_time)

    raw = (np.floor(run.trajectories["y"][:, 0] / count + 0.5).astype(np.int64) & 0xFFFFFFFF).astype(np.uint32)
    aims = np.full_like(raw, round(aim / count))
    added = np.zeros_like(raw)
    if made.compensation:
        added = raw if made.compensation.reads else aims
    words = np.stack([raw, run.trajectories["other"][:, 0].astype(np.uint32), aims, added], axis=1)
    for cpu in CPUS if made.compensation else ("cortex-m4",):  # laws alone run on both in test_firmware_target.py
        target = Target(made, tmp_path, beside if made.compensation else lambda files: files, cpu)
        if made.compensation:
            data = made.compensation.image.bytes()
            assert target.call("wb_vectors_load_beside", target.put(data), len(data)) == 0
        got = target.run(words, np.arange(samples) == 0).view(made.reference.dtype)
        assert np.count_nonzero(made.reference.real("u_c", got) != run.trajectories["u"][:, 0]) == 0
    if (study, name, arithmetic) == (*RUNS[0], "fixed"):  # one of them: `workbench verify` asks it of every controller
        law = task.run(controller, scenario)
        assert np.abs(law.final_error - run.final_error).max() <= COUNTS * count
