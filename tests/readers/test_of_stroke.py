"""A position logged in per cent of its stroke with a model in it: one per cent stands for one millimetre, and it is said; mixtures are refused."""

import numpy as np
import pytest

from workbench.campaign import load
from workbench.errors import WorkbenchError
from workbench.finding import OTHER_UNIT

TOML = """\
title = "control valve whose stroke nobody knows"
plant = "one mass"
evaluation_bandwidth = { value = 40.0, unit = "Hz" }
speed_limit = { value = 80.0, unit = "%/s" }

[channels.time]
column = "t"
unit = "s"

[channels.force]
column = "f"
unit = "N"

[channels.position]
column = "q"
unit = "%"
resolution = 0.001

[channels.reference]
column = "r"
unit = "%"

[[effects]]
effect = "inertia"
at = "axis"
parameters.inertia = { value = 0.12, unit = "N*s^2/%", fixed = true }

[[effects]]
effect = "presliding_hysteresis"
at = "axis"
parameters.h0 = { value = 40.0, unit = "N" }
parameters.a = { value = 0.9, unit = "1/%" }

[[records]]
file = "id.csv"
role = "identification"

[[records]]
file = "val.csv"
role = "validation"
"""


def put(folder, toml: str = TOML):
    t = 1e-3 * np.arange(300)
    rows = "\n".join(f"{x:.4f},{np.sin(9 * x):.6f},{20 * np.sin(7 * x):.6f},{20 * np.sin(7 * x):.4f}" for x in t)
    for name in ("id", "val"):
        (folder / f"{name}.csv").write_text(f"t,f,q,r\n{rows}\n", encoding="utf-8")
    (folder / "campaign.toml").write_text(toml, encoding="utf-8")
    return folder


def refused(folder, toml: str) -> str:
    with pytest.raises(WorkbenchError) as caught:
        load(put(folder, toml))
    return str(caught.value)


@pytest.mark.parametrize("drive", ["N", "A"])
def test_one_per_cent_of_a_valves_stroke_stands_for_a_millimetre_and_it_is_said(tmp_path, drive):
    found = load(put(tmp_path, TOML.replace('"N', f'"{drive}')))
    assert found.plant["inertia@axis"].parameters["inertia"].value == pytest.approx(120.0)
    assert found.plant["presliding_hysteresis@axis"].outside["a"].value == pytest.approx(900.0)
    assert found.plant.limits.speed == pytest.approx(0.08)
    record = found.records[0]
    assert record.channels["position"][100] == pytest.approx(0.02 * np.sin(0.7), abs=1e-9)
    assert record.channels["reference"][100] == pytest.approx(0.02 * np.sin(0.7), abs=1e-7)
    assert record.resolution["position"] == pytest.approx(1e-6)
    said = [f for f in found.findings if f.kind == OTHER_UNIT]
    assert "1 % stands for 1 mm" in said[0].sentence and '"mm/%"' in said[0].remedy
    assert len(said) == (1 if drive == "N" else 2)


def test_of_a_hatch_that_turns_it_stands_for_a_milliradian(tmp_path):
    turning = TOML.replace("channels.force", "channels.torque").replace('"N', '"N*m')
    found = load(put(tmp_path, turning))
    assert found.plant.rotary and found.plant["inertia@axis"].parameters["inertia"].value == pytest.approx(120.0)
    assert "1 % stands for 1 mrad" in found.findings[0].sentence


@pytest.mark.parametrize(
    ("old", "new", "where"),
    [
        ("N*s^2/%", "kg", "effect 1 'inertia', parameters.inertia.unit: 'kg'"),
        ('"1/%"', '"1/mm"', "effect 2 'presliding_hysteresis', parameters.a.unit: '1/mm'"),
        ("%/s", "mm/s", "speed_limit.unit: 'mm/s'"),
        ('column = "r"\nunit = "%"', 'column = "r"\nunit = "mm"', "channels.reference.unit: 'mm'"),
    ],
)
def test_what_is_in_a_length_beside_it_is_refused_with_what_would_mend_it(tmp_path, old, new, where):
    assert old in TOML
    sentence = refused(tmp_path, TOML.replace(old, new))
    assert f"{where} does not go with a position that is logged in '%'" in sentence
    assert 'give channels.position.scale, such as { value = 1.0, unit = "mm/%" }' in sentence


def test_position_and_drive_both_in_per_cent_ask_for_the_stroke(tmp_path):
    sentence = refused(tmp_path, TOML.replace('"N', '"%'))
    assert "position and drive are both logged in '%'" in sentence and "channels.position.scale" in sentence


def test_a_stroke_that_is_stated_is_used(tmp_path):
    stated = TOML.replace("resolution = 0.001", 'resolution = 0.001\nscale = { value = 0.4, unit = "mm/%" }')
    stated = stated.replace(
        'column = "r"\nunit = "%"', 'column = "r"\nunit = "%"\nscale = { value = 0.4, unit = "mm/%" }'
    )
    stated = stated.replace("N*s^2/%", "kg").replace('"1/%"', '"1/mm"').replace("%/s", "mm/s")
    found = load(put(tmp_path, stated))
    assert found.records[0].channels["position"][100] == pytest.approx(0.008 * np.sin(0.7), abs=1e-9)
    assert not found.findings
