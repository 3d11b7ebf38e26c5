"""A drive logged in amperes with a model in amperes: one ampere stands for one N*m, and it is said; what does not go together is refused."""

import numpy as np
import pytest

from workbench.campaign import load
from workbench.errors import WorkbenchError
from workbench.finding import OTHER_UNIT

TOML = """\
title = "axis whose torque constant nobody knows"
plant = "one mass"
evaluation_bandwidth = { value = 40.0, unit = "Hz" }
actuator_limit = { value = 7.5, unit = "A" }

[channels.time]
column = "t"
unit = "s"

[channels.torque]
column = "i"
unit = "A"

[channels.position]
column = "q"
unit = "deg"

[[effects]]
effect = "inertia"
at = "axis"
parameters.inertia = { value = 0.6, unit = "A*s^2/rad", fixed = true }

[[effects]]
effect = "presliding_hysteresis"
at = "axis"
parameters.h0 = { value = 800.0, unit = "mA" }
parameters.a = { value = 9000.0, unit = "1/rad" }

[[records]]
file = "id.csv"
role = "identification"

[[records]]
file = "val.csv"
role = "validation"
"""


def put(folder, toml: str = TOML):
    t = 1e-3 * np.arange(300)
    rows = "\n".join(f"{x:.4f},{np.sin(9 * x):.6f},{20 * np.sin(7 * x):.6f}" for x in t)
    for name in ("id", "val"):
        (folder / f"{name}.csv").write_text(f"t,i,q\n{rows}\n", encoding="utf-8")
    (folder / "campaign.toml").write_text(toml, encoding="utf-8")
    return folder


def refused(folder, toml: str) -> str:
    with pytest.raises(WorkbenchError) as caught:
        load(put(folder, toml))
    return str(caught.value)


@pytest.mark.parametrize("unit", ["A", "%", "1"])
def test_a_drive_of_a_slide_in_its_own_unit_is_a_force_though_it_is_called_a_torque(tmp_path, unit):
    """An injection unit's screw, its drive in per cent of what is rated: the position's millimetres say that nothing turns."""
    slide = (
        TOML.replace('"deg"', '"mm"')
        .replace('"1/rad"', '"1/mm"')
        .replace("A*s^2/rad", "A*s^2/mm")
        .replace('"mA"', '"A"')
    )
    if unit == "1":
        slide = slide.replace('"A*s^2/mm"', '"s^2/mm"')
    found = load(put(tmp_path, slide.replace('"A', f'"{unit}')))
    assert not found.plant.rotary and found.plant["inertia@axis"].parameters["inertia"].value == pytest.approx(600.0)
    assert found.records[0].channels["force"][100] == pytest.approx(np.sin(0.9), abs=1e-6)
    (said,) = [f for f in found.findings if f.kind == OTHER_UNIT]
    assert (
        f"1 {'of it' if unit == '1' else unit} stands for 1 N " in f"{said.sentence} "
        and "channels.force.scale" in said.remedy
    )


def test_a_torque_of_a_slide_is_refused_still(tmp_path):
    slide = (
        TOML.replace('unit = "deg"', 'unit = "mm"')
        .replace('unit = "A"', 'unit = "N*m"')
        .replace("A*s^2/rad", "kg*m^2")
        .replace('"mA"', '"mN*m"')
    )
    assert "an angle is needed" in refused(tmp_path, slide)


@pytest.mark.parametrize("unit", ["A", "mA", "V"])
def test_a_model_in_the_drives_own_unit_is_read_one_for_one_and_said_to_be(tmp_path, unit):
    own = TOML.replace('"mA"', '"A"').replace('"A', f'"{unit}')
    found = load(put(tmp_path, own))
    assert found.plant["inertia@axis"].parameters["inertia"].value == pytest.approx(0.6)
    assert found.plant.limits.drive == pytest.approx(7.5)
    assert found.records[0].channels["torque"][100] == pytest.approx(np.sin(0.9), abs=1e-6)
    (said,) = [f for f in found.findings if f.kind == OTHER_UNIT]
    assert (
        said.sentence.startswith(f"The drive is logged in '{unit}'") and f"1 {unit} stands for 1 N*m" in said.sentence
    )
    assert f'"N*m/{unit}"' in said.remedy


def test_another_prefix_of_the_drives_unit_is_turned_into_it(tmp_path):
    friction = load(put(tmp_path)).plant["presliding_hysteresis@axis"]
    assert friction.outside["h0"].value == pytest.approx(0.8)


def test_a_model_in_kilograms_needs_the_torque_constant(tmp_path):
    sentence = refused(tmp_path, TOML.replace('"A*s^2/rad"', '"kg*m^2"'))
    assert (
        "effect 1 'inertia', parameters.inertia.unit: 'kg*m^2' does not go with a drive that is logged in 'A'"
        in sentence
    )
    assert 'channels.torque.scale, such as { value = 1.0, unit = "N*m/A" }' in sentence


def test_a_drive_in_amperes_beside_a_model_in_si_is_asked_for_its_constant(tmp_path):
    si = TOML.replace('"A*s^2/rad"', '"kg*m^2"').replace('"mA"', '"mN*m"')
    sentence = refused(tmp_path, si.replace('7.5, unit = "A"', '7.5, unit = "N*m"'))
    assert "channels.torque.unit: 'A' is no torque" in sentence and 'unit = "N*m/A"' in sentence
    assert "an inertia in 'A*s^2/rad'" in sentence


def test_with_a_scale_units_are_what_they_say(tmp_path):
    scaled = TOML.replace(
        'unit = "A"\n\n[channels.position]',
        'unit = "A"\nscale = { value = 2.0, unit = "N*m/A" }\n\n[channels.position]',
    )
    assert "unit 'A' does not fit" in refused(tmp_path, scaled)


@pytest.mark.parametrize("second", ['unit = "N*m"', 'unit = "V"\nscale = { value = 2.0, unit = "N*m/V" }'])
def test_what_is_injected_is_logged_as_the_drive_is(tmp_path, second):
    both = TOML.replace("[channels.position]", f'[channels.injected]\ncolumn = "j"\n{second}\n\n[channels.position]')
    assert "channels.injected.unit" in refused(tmp_path, both)


@pytest.mark.parametrize(
    ("unit", "constant", "inertia"),
    [("%", "N*m/%", "%*s^2/rad"), ("count", "N*m/count", "count*s^2/rad"), ("1", "N*m", "s^2/rad")],
)
def test_a_drive_in_counts_beside_a_model_in_si_is_asked_for_its_constant(tmp_path, unit, constant, inertia):
    si = (
        TOML.replace('"A*s^2/rad"', '"kg*m^2"')
        .replace('"mA"', '"mN*m"')
        .replace('7.5, unit = "A"', '7.5, unit = "N*m"')
    )
    sentence = refused(tmp_path, si.replace('unit = "A"', f'unit = "{unit}"'))
    assert f"'{unit}' is no torque" in sentence
    assert f'unit = "{constant}"' in sentence and f"an inertia in '{inertia}'" in sentence


@pytest.mark.parametrize(
    ("unit", "inertia", "friction"),
    [("%", "%*s^2/rad", "%"), ("count", "count*s^2/rad", "count"), ("1", "s^2/rad", "1")],
)
def test_a_model_in_counts_of_the_drive_is_read_one_for_one(tmp_path, unit, inertia, friction):
    own = TOML.replace('"A*s^2/rad"', f'"{inertia}"').replace('"mA"', f'"{friction}"').replace('"A"', f'"{unit}"')
    found = load(put(tmp_path, own))
    assert found.plant["inertia@axis"].parameters["inertia"].value == pytest.approx(0.6)
    assert found.plant["presliding_hysteresis@axis"].outside["h0"].value == pytest.approx(800.0)
    assert found.plant["presliding_hysteresis@axis"].outside["a"].value == pytest.approx(9000.0)
    assert found.plant.limits.drive == pytest.approx(7.5)
    assert found.records[0].channels["torque"][100] == pytest.approx(np.sin(0.9), abs=1e-6)
    (said,) = [f for f in found.findings if f.kind == OTHER_UNIT]
    assert f"1 {'of it' if unit == '1' else unit} stands for 1 N*m" in said.sentence


def test_of_a_drive_without_unit_what_divides_by_a_torque_does_so_and_a_phase_is_none(tmp_path):
    own = TOML.replace('"A*s^2/rad"', '"s^2/rad"').replace('"mA"', '"1"').replace('"A"', '"1"')
    more = """[[effects]]
effect = "torque_constant_saturation"
at = "command"
parameters.fall = { value = 0.02, unit = "1" }

[[effects]]
effect = "gravity"
at = "axis"
parameters.mgl = { value = 3.0, unit = "1" }
parameters.phase = { value = 0.2, unit = "rad" }

[[records]]"""
    plant = load(put(tmp_path, own.replace("[[records]]", more, 1))).plant
    assert plant["torque_constant_saturation@command"].outside["fall"].value == pytest.approx(0.02)
    weight = plant["gravity@axis"].outside
    assert (weight["mgl"].value, weight["phase"].value) == pytest.approx((3.0, 0.2))
    wrong = refused(tmp_path, own.replace('"s^2/rad"', '"s/rad"'))
    assert "parameters.inertia.unit" in wrong and "1 of it stands for 1 N*m here" in wrong


def test_a_unit_that_does_not_fit_is_refused_with_what_stands_for_what(tmp_path):
    wrong = refused(tmp_path, TOML.replace('unit = "A*s^2/rad"', 'unit = "A*s"'))
    assert "parameters.inertia.unit" in wrong and wrong.endswith("1 A stands for 1 N*m here.")
    assert "stands for" not in refused(tmp_path, TOML.replace("9000.0", "-9000.0"))


def test_a_scale_that_is_a_number_multiplies_a_column_whose_unit_is_stated(tmp_path):
    """A drive in volts times N*m per volt, with the unit of the product: as a table, or as a number alone."""
    inside = TOML.replace("A*s^2/rad", "kg*m^2").replace('"mA"', '"N*m"').replace('unit = "A" }', 'unit = "N*m" }')
    table = inside.replace(
        'column = "i"\nunit = "A"', 'column = "i"\nunit = "A"\nscale = { value = 0.5, unit = "N*m/A" }'
    )
    number = inside.replace('column = "i"\nunit = "A"', 'column = "i"\nunit = "N*m"\nscale = 0.5')
    found = []
    for name, toml in (("table", table), ("number", number)):
        (folder := tmp_path / name).mkdir()
        found.append(load(put(folder, toml)).records[0].channels["torque"])
    np.testing.assert_array_equal(*found)
    assert np.any(found[0])


def test_a_scale_that_is_a_number_says_what_a_column_in_amperes_needs(tmp_path):
    toml = TOML.replace('column = "i"\nunit = "A"', 'column = "i"\nunit = "A"\nscale = 0.5')
    with pytest.raises(
        WorkbenchError,
        match=r"channels\.torque\.scale is a number, and 'A' is no unit of 'N\*m'; .* \{ value = 0\.5, unit = \"N\*m/A\" \}",
    ):
        load(put(tmp_path, toml))
