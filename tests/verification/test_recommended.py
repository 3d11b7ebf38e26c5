"""What leaves the workbench: the controller to take, why, and its numbers beside those of the others, for one plant."""

import json
import struct
import subprocess
import zlib
from types import SimpleNamespace

import numpy as np
import pytest

from workbench.control import pi_cascade
from workbench.definition import find
from workbench.design.families.family import cascade_family, pd_family
from workbench.design.families.linear import Linear
from workbench.errors import WorkbenchError
from workbench.exporting.leaving import leave
from workbench.exporting.numbers import export_numbers, load_numbers
from workbench.firmware.naming import slug
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.report.recommend import recommended_chapter
from workbench.simulation import Loop
from workbench.task.task import Task, Weights
from workbench.verification.recommend import recommend

LOOP = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, 4.848e-6)
LINEAR = Linear(LOOP, 0.0074, 0.0, np.array([0.0]))


def plant() -> Plant:
    effects = (find("inertia")(inertia=0.0074), find("presliding_hysteresis")(h0=0.15, x0=1 / 636))
    return Plant(ONE_MASS, effects, limits=Limits(3.3, 12.57))


def tuned(family, *point):
    point = np.array(point)
    return SimpleNamespace(
        family=family,
        point=point,
        numbers=dict(zip(family.numbers, point, strict=True)),
        controller=lambda lanes=1: family.controller(point[None, :], lanes),
    )


@pytest.fixture(scope="module")
def found():
    stiff = tuned(pd_family(LINEAR, (400.0, 8.0)), 443.0, 8.9)
    hasty = tuned(pd_family(LINEAR, (400.0, 8.0)), 400.0, 3.0)
    cascade = tuned(cascade_family(LINEAR, (40.0, 5.0, 250.0), 12.3), 40.0, 5.0, 250.0)
    task = Task(plant(), LOOP, 2.5, 0.6, weights=Weights(error=0.4, overshoot=0.008))
    every = {"fixed PD": stiff, "hasty PD": hasty, "PI cascade": cascade}
    return every, recommend(task, every, "rad")


def test_the_least_worst_case_is_taken_of_those_that_do_not_overshoot(found):
    _, choice = found
    rows = {r.name: r for r in choice.rows}
    assert choice.name == "PI cascade" and choice.rows[0].name == choice.name
    assert not rows["hasty PD"].allowed and choice.rows[-1].name == "hasty PD"
    assert rows["PI cascade"].error_grid < 1e-5 < rows["fixed PD"].error_grid
    assert choice.sentence.startswith("Take PI cascade: a 1 % time of") and "Fixed PD comes next" in choice.sentence
    table = recommended_chapter(choice, plant(), LOOP.count).blocks[1]
    assert len(table.rows) == 3 and table.rows[0][0].text == "PI cascade"


def test_the_recommended_controller_stands_first_with_its_numbers_and_all_name_one_plant(found, tmp_path):
    every, choice = found
    leave(every, choice.name, plant(), 2.5e-4, tmp_path)
    content = json.loads((tmp_path / "contents.json").read_text())
    assert [c["controller"] for c in content["controllers"]][0] == "PI cascade" == content["recommended"]
    assert content["controllers"][0]["files"] == ["pi_cascade.h", "pi_cascade.json", "pi_cascade.bin"]
    for entry in content["controllers"]:
        held = json.loads((tmp_path / entry["files"][1]).read_text())
        assert held["plant"]["digest"] == content["plant"]["digest"] == plant().digest
        assert plant().digest in (tmp_path / entry["files"][0]).read_text()
        assert plant().digest in (tmp_path / entry["files"][2]).read_bytes().hex()
    numbers = json.loads((tmp_path / "pi_cascade.json").read_text())["numbers"]
    assert numbers["kv"] == {"value": 40.0, "unit": "1/s"} and numbers["ki"]["unit"] == "N*m/rad"
    assert load_numbers(tmp_path / "pi_cascade.bin").tolist() == [
        float(np.float32(n["value"])) for n in numbers.values()
    ]


def test_the_header_compiles_and_holds_the_same_numbers(found, tmp_path):
    every, choice = found
    leave(every, choice.name, plant(), 2.5e-4, tmp_path)
    source = tmp_path / "main.c"
    source.write_text(
        '#include "pi_cascade.h"\n#include <stdio.h>\nint main(void) { printf("%.9g %.9g %u\\n", (double)WB_PI_CASCADE_KV, '
        "(double)WB_PI_CASCADE_SPEED_LIMIT, (unsigned)WB_PI_CASCADE_CRC); return 0; }\n"
    )
    flags = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
    subprocess.run(["gcc", *flags, str(source), "-o", str(tmp_path / "main")], check=True)
    kv, speed, crc = subprocess.run([tmp_path / "main"], check=True, capture_output=True, text=True).stdout.split()
    assert float(kv) == 40.0 and np.float32(speed) == np.float32(12.3)
    assert int(crc) == zlib.crc32(load_numbers(tmp_path / "pi_cascade.bin").tobytes())


def test_numbers_that_are_damaged_or_do_not_fit_are_refused(tmp_path):
    paths = export_numbers("PI cascade", "u", {"kv": (40.0, "1/s")}, 1e-3, plant(), tmp_path)
    data = bytearray(paths[2].read_bytes())
    assert struct.unpack("<I", data[12:16]) == (1,) and slug("scheduled PD (error)") == "scheduled_pd_error"
    data[17] ^= 1
    paths[2].write_bytes(data)
    with pytest.raises(WorkbenchError, match="damaged"):
        load_numbers(paths[2])
    with pytest.raises(WorkbenchError, match="float32"):
        export_numbers("PD", "u", {"kp": (1e40, "N*m/rad")}, 1e-3, plant(), tmp_path / "other")
    assert not (tmp_path / "other").exists()
    law = pi_cascade(1.0, 1.0, 1.0, 1.0)
    other = SimpleNamespace(
        controller=lambda lanes=1: SimpleNamespace(tables=(), law=law.law, parameters={"odd": 1.0}, name="x")
    )
    with pytest.raises(WorkbenchError, match="no unit"):
        leave({"x": other}, "x", plant(), 1e-3, tmp_path)
