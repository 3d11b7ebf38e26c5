"""A campaign folder becomes frozen values in SI; whatever is wrong in it is refused with file, row or key, and mend."""

import dataclasses
import gzip
import random
import shutil

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from workbench.campaign import load
from workbench.errors import WorkbenchError
from workbench.readers.starts import promised

TOML = """\
title = "one axis on the bench"
plant = "one mass"
evaluation_bandwidth = { value = 0.15, unit = "kHz" }
actuator_limit = { value = 3000, unit = "mN*m" }
speed_limit = { value = 60.0, unit = "rpm" }
initial_condition = "at rest"

[geometry]
gear_ratio = 30
pole_pairs = 5

[channels.time]
column = "time_s"
unit = "s"
meaning = "bench clock"

[channels.torque]
column = "torque_mNm"
unit = "mN*m"

[channels.position]
column = "position_deg"
unit = "deg"
resolution = 0.01

[channels.temperature]
column = "housing_C"
unit = "degC"
resolution = 0.1

[[effects]]
effect = "inertia"
at = "axis"
law = "J*acc"
parameters.inertia = { value = 25.0, unit = "kg*cm^2", fixed = true }

[[effects]]
effect = "presliding_hysteresis"
at = "axis"
parameters.h0 = { value = 139, unit = "mN*m" }
parameters.a = { value = 525.0, unit = "1/rad", fixed = false }

[[records]]
file = "id_sine.csv.gz"
role = "identification"
motion = "slow sine"
start_time_s = 10.0

[[records]]
file = "val_moves.csv"
role = "validation"
"""
ROWS = 150


def rows(start=10.0, step=1e-3, count=ROWS):
    k = np.arange(count)
    return np.column_stack([start + step * k, 100 + k, k / 10, 20 + 0.1 * k])


def text(table, header="time_s,torque_mNm,position_deg,housing_C"):
    return "\n".join([header, *(",".join(repr(float(f"{x:.9g}")) for x in row) for row in table)]) + "\n"


class Builder:
    """A small valid campaign in a folder, which a test breaks in one way."""

    def __init__(self, folder):
        self.folder, self.toml = folder, TOML
        self.put("id_sine.csv.gz", rows())
        self.put("val_moves.csv", rows(20.0))

    def put(self, name, table):
        content = (table if isinstance(table, str) else text(table)).encode()
        (self.folder / name).write_bytes(gzip.compress(content) if name.endswith(".gz") else content)

    def swap(self, old, new, count=1):
        assert old in self.toml
        self.toml = self.toml.replace(old, new, count)
        return self

    def load(self, **options):
        (self.folder / "campaign.toml").write_text(self.toml, encoding="utf-8")
        return load(self.folder, **options)

    def refused(self, *parts, file="campaign.toml", **options):
        """The campaign is refused with one sentence that starts with the file and holds all parts."""
        with pytest.raises(WorkbenchError) as caught:
            self.load(**options)
        sentence = str(caught.value)
        assert sentence.startswith(str(self.folder / file)), sentence
        assert sentence[-1] in ".?" and "\n" not in sentence, sentence
        for part in parts:
            assert part in sentence, sentence


@pytest.fixture
def campaign(tmp_path):
    folder = tmp_path / "campaign"
    folder.mkdir()
    return Builder(folder)


def two_mass(campaign):
    """Make the fixture's campaign one of two masses."""
    campaign.swap('plant = "one mass"', 'plant = "two mass"').swap('at = "axis"', 'at = "motor"', 2)
    campaign.swap(
        "[channels.temperature]", '[channels.load_position]\ncolumn = "load"\nunit = "rad"\n[channels.temperature]'
    )
    for name in ("id_sine.csv.gz", "val_moves.csv"):
        table = np.insert(rows(), 3, 0.0, axis=1)
        campaign.put(name, text(table, "time_s,torque_mNm,position_deg,load,housing_C"))
    return campaign


# --- what comes out ---------------------------------------------------------------------------------------------------


def test_a_campaign_is_read_in_si(campaign):
    c = campaign.load()
    assert (c.title, c.bandwidth, c.folder, c.findings) == ("one axis on the bench", 150.0, campaign.folder, ())
    assert (c.plant.kind, c.plant.rotary) == ("one mass", True)
    assert (c.plant.geometry.gear_ratio, c.plant.geometry.pole_pairs) == (30.0, 5.0)
    assert c.plant.limits.drive == pytest.approx(3.0) and c.plant.limits.speed == pytest.approx(2 * np.pi)
    assert c.notes["initial_condition"] == "at rest"
    assert c.notes["channels.time.meaning"] == "bench clock"
    assert c.notes["effects.inertia@axis.law"] == "J*acc"


def test_records_are_read_in_si(campaign):
    sine, moves = campaign.load().records
    assert (sine.name, sine.role, sine.motion, sine.locked) == ("id_sine", "identification", "slow sine", False)
    assert (moves.name, moves.role) == ("val_moves", "validation")
    assert np.allclose(sine.time, 10 + 1e-3 * np.arange(ROWS), rtol=0, atol=1e-9)
    assert sine.dt == pytest.approx(1e-3)
    assert np.allclose(sine.drive, 0.1 + 1e-3 * np.arange(ROWS))
    assert np.allclose(sine.channels["position"], np.radians(np.arange(ROWS) / 10))
    assert np.allclose(sine.channels["temperature"], 293.15 + 0.1 * np.arange(ROWS))
    assert dict(sine.resolution) == {"position": pytest.approx(np.radians(0.01)), "temperature": 0.1}
    assert dict(sine.units) == {"time": "s", "torque": "N*m", "position": "rad", "temperature": "K"}
    assert sine.source.path == campaign.folder / "id_sine.csv.gz" and len(sine.source.sha256) == 64


def test_everything_is_frozen(campaign):
    c = campaign.load()
    with pytest.raises(dataclasses.FrozenInstanceError):
        c.bandwidth = 1.0
    with pytest.raises(TypeError):
        c.notes["title"] = "another"
    for array in (c.records[0].time, *c.records[0].channels.values()):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_declared_effects_are_read_in_si(campaign):
    effects = {e.key: e for e in campaign.load().plant.effects}
    inertia = effects["inertia@axis"].outside["inertia"]
    assert inertia.value == pytest.approx(0.0025) and inertia.fixed
    hysteresis = effects["presliding_hysteresis@axis"].outside
    assert hysteresis["h0"].value == pytest.approx(0.139)
    assert hysteresis["a"].value == pytest.approx(525.0)
    assert not effects["presliding_hysteresis@axis"].parameters["h0"].fixed


def test_an_effect_keeps_its_default_where_a_parameter_is_absent(campaign):
    campaign.swap('parameters.h0 = { value = 139, unit = "mN*m" }\n', "")
    assert campaign.load().plant["presliding_hysteresis@axis"].outside["d"].value == 1.0


def test_the_exponent_of_a_unit_is_the_declared_parameter(campaign):
    campaign.swap('unit = "1/rad", fixed = false }', 'unit = "1/rad^0.8" }\nparameters.d = { value = 0.8, unit = "1" }')
    assert campaign.load().plant["presliding_hysteresis@axis"].outside["a"].value == pytest.approx(525.0)
    campaign.swap("1/rad^0.8", "1/rad").refused("parameters.a.unit", "'1/rad^0.8' is needed")
    campaign.swap('"1/rad"', '"1/rad", fixed = true').refused("parameters.a.unit", "'1/rad^0.8' is needed")
    campaign.swap('"1/rad", fixed = true', '"1/deg", fixed = false').refused(
        "parameters.a.unit", "'1/rad^0.8' is needed"
    )


def test_a_value_at_which_a_search_starts_may_be_written_without_the_exponent_of_its_unit(campaign):
    campaign.swap("fixed = false }", 'fixed = false }\nparameters.d = { value = 0.8, unit = "1" }')
    assert campaign.load().plant["presliding_hysteresis@axis"].outside["a"].value == pytest.approx(525.0)


def test_force_makes_the_axis_linear(campaign):
    campaign.swap("[channels.torque]", "[channels.force]").swap('"mN*m"', '"mN"', 3).swap('"deg"', '"mm"')
    campaign.swap("rpm", "mm/s").swap("kg*cm^2", "g").swap("1/rad", "1/mm")
    c = campaign.load()
    assert not c.plant.rotary and c.records[0].units["position"] == "m"
    assert c.plant.limits.speed == pytest.approx(0.06)
    assert c.plant["inertia"].outside["inertia"].value == pytest.approx(0.025)
    assert c.plant["presliding_hysteresis"].outside["a"].value == pytest.approx(525e3)


def test_two_masses_have_two_positions_and_a_locked_load(campaign):
    two_mass(campaign).swap('role = "validation"', 'role = "validation"\nload_locked = true')
    c = campaign.load()
    assert c.plant.kind == "two mass" and [e.at for e in c.plant.effects] == ["motor", "motor"]
    assert [r.locked for r in c.records] == [False, True]
    assert np.array_equal(c.records[0].channels["load_position"], np.zeros(ROWS))


@pytest.mark.parametrize(("place", "held"), [("sensor.load_position", False), ("sensor.position", True)])
def test_the_zero_of_a_declared_eccentricity_is_free_at_the_load_alone(campaign, place, held):
    two_mass(campaign).toml += f'[[effects]]\neffect = "encoder_eccentricity"\nat = "{place}"\n'
    assert campaign.load().plant[f"encoder_eccentricity@{place}"].parameters["zero"].fixed is held


def test_an_effect_may_act_on_the_command(campaign):
    campaign.toml += '[[effects]]\neffect = "transport_delay"\nat = "command"\n'
    campaign.toml += 'parameters.delay = { value = 0.5, unit = "ms" }\n'
    assert campaign.load().plant["transport_delay@command"].outside["delay"].value == pytest.approx(5e-4)


def test_optional_keys_may_be_absent(campaign):
    for key in ("actuator_limit", "speed_limit", "initial_condition"):
        line = next(part for part in campaign.toml.splitlines() if part.startswith(key))
        campaign.swap(line + "\n", "")
    campaign.swap("[geometry]\ngear_ratio = 30\npole_pairs = 5\n", "")
    c = campaign.load()
    assert np.isinf(c.plant.limits.drive) and c.plant.geometry.gear_ratio == 1.0


def test_records_in_a_folder_below_and_at_another_rate_are_read(campaign):
    (campaign.folder / "moves").mkdir()
    campaign.put("moves/val.csv", rows(step=5e-4))
    c = campaign.swap("val_moves.csv", "moves/val.csv").load()
    assert c.records[1].name == "val" and c.records[1].dt == pytest.approx(5e-4)


def test_a_start_time_that_is_not_the_clocks_is_found(campaign):
    (finding,) = campaign.swap("start_time_s = 10.0", "start_time_s = 0.0").load().findings
    assert (finding.kind, finding.subject) == ("start time", "id_sine")
    assert finding.evidence == {"declared": 0.0, "measured": 10.0}


def test_a_record_whose_clock_begins_at_zero_stands_where_it_is_declared_to_start(campaign):
    campaign.put("val_moves.csv", rows(start=0.0))
    two = 'file = "val_moves.csv"\nrole = "validation"\n'
    more = 'start_time_s = 40.0\ncounts_from = { value = 0.02, unit = "s" }\n'
    read = campaign.swap(two, two + more).load()
    record, (finding,) = read.records[1], read.findings
    assert record.time[0] == pytest.approx(40.0) and record.counts_from == pytest.approx(40.02)
    assert (finding.kind, finding.evidence["declared"]) == ("start time", 40.0)
    assert "was added to its time" in finding.sentence


# --- the declaration --------------------------------------------------------------------------------------------------


def test_a_folder_without_declaration_is_refused(tmp_path):
    for folder in (tmp_path, tmp_path / "none"):
        with pytest.raises(WorkbenchError, match=r"campaign.toml: cannot be read \(No such file .* needs a readable"):
            load(folder)


def test_a_syntax_error_names_the_line(campaign):
    campaign.swap("pole_pairs = 5", "pole_pairs = = 5").refused("is no valid TOML", "line 10")
    campaign.swap("= = 5", "= 5\npole_pairs = 6").refused("is no valid TOML", "line 11")


def test_a_declaration_that_is_no_utf8_names_the_line(campaign):
    campaign.load()
    path = campaign.folder / "campaign.toml"
    path.write_bytes(path.read_bytes().replace(b"at rest", b"20 \xb0C"))
    with pytest.raises(WorkbenchError, match=r"campaign.toml, line 6: is not UTF-8 text; save the file as UTF-8\."):
        load(campaign.folder)


@pytest.mark.parametrize(
    ("key", "where"),
    [
        ('title = "one axis on the bench"', "key 'title' is missing; add it."),
        ('plant = "one mass"', "key 'plant' is missing; add it."),
        ('evaluation_bandwidth = { value = 0.15, unit = "kHz" }', "key 'evaluation_bandwidth' is missing"),
        ('value = 0.15, unit = "kHz"', "evaluation_bandwidth: key 'value' is missing"),
        (', unit = "kHz"', "evaluation_bandwidth: key 'unit' is missing"),
        ('column = "time_s"', "channels.time: key 'column' is missing"),
        ('unit = "mN*m"\n', "channels.torque: key 'unit' is missing"),
        ('effect = "inertia"', "effect 1: key 'effect' is missing"),
        ('at = "axis"', "effect 1 'inertia': key 'at' is missing"),
        (', unit = "kg*cm^2"', "effect 1 'inertia', parameters.inertia: key 'unit' is missing"),
        ('file = "id_sine.csv.gz"', "record 1: key 'file' is missing"),
        ('role = "validation"', "record 2 'val_moves.csv': key 'role' is missing"),
        (
            '[channels.time]\ncolumn = "time_s"\nunit = "s"\nmeaning = "bench clock"',
            "channels: channel 'time' is missing",
        ),
    ],
)
def test_a_missing_key_is_named(campaign, key, where):
    campaign.swap(key, "").refused(f": {where}")


@pytest.mark.parametrize(
    ("old", "new", "where", "near"),
    [
        ("actuator_limit", "actuatorlimit", "unknown key 'actuatorlimit'", "'actuator_limit'"),
        ("gear_ratio", "gear_rato", "geometry: unknown key 'gear_rato'", "'gear_ratio'"),
        ("[channels.temperature]", "[channels.temprature]", "channels: unknown key 'temprature'", "'temperature'"),
        ("resolution", "resolutoin", "channels.position: unknown key 'resolutoin'", "'resolution'"),
        ("law", "laws", "effect 1 'inertia': unknown key 'laws'", "'law'"),
        (", fixed = true", ", fix = true", "effect 1 'inertia', parameters.inertia: unknown key 'fix'", "'fixed'"),
        ("parameters.h0", "parameters.h", "effect 2 'presliding_hysteresis', parameters: unknown key 'h'", "'h0'"),
        ("start_time_s", "start_time", "record 1 'id_sine.csv.gz': unknown key 'start_time'", "'start_time_s'"),
        ('"kHz"', '"kHz", fixed = true', "evaluation_bandwidth: unknown key 'fixed'", "known: unit, value."),
        (
            'effect = "inertia"',
            'effect = "inertial"',
            "effect 1 'inertial', effect: unknown effect 'inertial'",
            "'inertia'",
        ),
        ('"one mass"', '"one-mass"', "plant: unknown plant 'one-mass'", "'one mass'"),
        (
            '"identification"',
            '"identify"',
            "record 1 'id_sine.csv.gz', role: unknown role 'identify'",
            "'identification'",
        ),
        (
            'at = "axis"',
            'at = "motor"',
            "effect 1 'inertia', at: effect 'inertia' cannot act at 'motor'",
            "known: axis.",
        ),
        ('at = "axis"', 'at = "command"', "effect 1 'inertia', at: effect 'inertia' cannot act at 'command'", "axis"),
        ('at = "axis"', 'at = "sensor.position"', "effect 1 'inertia', at: effect 'inertia' cannot act", "axis"),
    ],
)
def test_an_unknown_name_is_answered_with_the_nearest(campaign, old, new, where, near):
    campaign.swap(old, new).refused(f": {where}", near)


def test_an_effect_at_a_place_of_the_other_plant_is_refused(campaign):
    two_mass(campaign).swap('at = "motor"', 'at = "axis"').refused("effect 1 'inertia', at", "'axis'", "motor")


def test_an_effect_twice_at_one_place_is_refused(campaign):
    campaign.toml += '[[effects]]\neffect = "inertia"\nat = "axis"\n'
    campaign.refused(
        "effect 3 'inertia', at: effect 'inertia' acts twice at 'axis'; declare it once, or give each of them a label of its own."
    )


def test_labels_tell_effects_of_one_name_apart(campaign):
    mode = '[[effects]]\neffect = "flexible_mode"\nat = "axis"\n'
    first = mode + 'label = "first"\nparameters.frequency = { value = 60.0, unit = "Hz" }\n'
    campaign.toml += first + mode + 'parameters.frequency = { value = 140.0, unit = "Hz" }\nlabel = "second"\n'
    plant = campaign.load().plant
    assert plant["flexible_mode first@axis"].parameters["frequency"].value == 60.0
    assert plant["flexible_mode second@axis"].parameters["frequency"].value == 140.0
    campaign.toml += first
    campaign.refused("effect 5 'flexible_mode', at: effect 'flexible_mode first' acts twice at 'axis'")


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("gear_ratio = 30", "gear_ratio = true", "geometry.gear_ratio is true or false; a number is needed."),
        (
            "gear_ratio = 30",
            'gear_ratio = "30"',
            "geometry.gear_ratio is the text '30'; a number is needed without quotes.",
        ),
        ("gear_ratio = 30", "gear_ratio = [30]", "geometry.gear_ratio is a list; a number is needed."),
        ("gear_ratio = 30", "gear_ratio = 1979-05-27", "geometry.gear_ratio is a date or time; a number is needed."),
        ("gear_ratio = 30", "gear_ratio = nan", "geometry.gear_ratio is nan; a finite number is needed."),
        ("gear_ratio = 30", "gear_ratio = 1e999", "geometry.gear_ratio is inf; a finite number is needed."),
        ("gear_ratio = 30", "gear_ratio = 1" + 400 * "0", "geometry.gear_ratio is inf; a finite number is needed."),
        ("gear_ratio = 30", "gear_ratio = 0", "geometry.gear_ratio is 0; a number larger than 0 is needed."),
        ("value = 0.15", 'value = "0.15"', "evaluation_bandwidth.value is the text '0.15'; a number is needed without"),
        ("value = 0.15", "value = 0", "evaluation_bandwidth.value is 0 Hz; more than 1e-06 is needed."),
        ("value = 3000", "value = -1", "actuator_limit.value is -0.001 N*m; more than 0 is needed."),
        ("value = 25.0", "value = false", "effect 1 'inertia', parameters.inertia.value is true or false; a number is"),
        ("fixed = true", "fixed = 1", "parameters.inertia.fixed is a number; true or false is needed."),
        (
            '{ value = 139, unit = "mN*m" }',
            "0.139",
            """parameters.h0 has no unit; write { value = ..., unit = "N*m" }.""",
        ),
        ('plant = "one mass"', "plant = 1", "plant is a number; a text in quotes is needed."),
        ('plant = "one mass"', 'plant = ["one mass"]', "plant is a list; a text in quotes is needed."),
        ('unit = "s"', "unit = 1", "channels.time.unit is a number; a text in quotes is needed."),
        ("resolution = 0.01", "resolution = 0", "channels.position.resolution is 0; a number larger than 0 is needed."),
        ("[geometry]\ngear_ratio = 30\npole_pairs = 5", "geometry = 30", "geometry is a number; a table is needed."),
        ("start_time_s = 10.0", 'start_time_s = "10"', "record 1 'id_sine.csv.gz', start_time_s is the text '10'"),
        (
            "start_time_s = 10.0",
            'load_locked = "no"',
            "record 1 'id_sine.csv.gz', load_locked is the text 'no'; true or",
        ),
    ],
)
def test_a_value_of_another_kind_is_refused(campaign, old, new, sentence):
    campaign.swap(old, new).refused(sentence)


@pytest.mark.parametrize(("key", "tail"), [("effects", "[[records]]\n"), ("records", "")])
def test_effects_and_records_are_lists_of_tables(campaign, key, tail):
    head = campaign.toml[: campaign.toml.index("[[effects]]")]
    campaign.toml = head.replace("plant", f"{key} = 3\nplant", 1) + tail
    campaign.refused(f": {key} is a number; a list of tables, [[{key}]], is needed.")
    campaign.toml = head.replace("plant", f"{key} = [3]\nplant", 1) + tail
    campaign.refused(f": {key[:-1]} 1 is a number; a table is needed.")


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ('unit = "kHz"', 'unit = "1/s"', ("evaluation_bandwidth.unit: unit '1/s' is a rate", "such as 'Hz'")),
        (
            'unit = "mN*m" }\nspeed',
            'unit = "N" }\nspeed',
            ("actuator_limit.unit: unit 'N' is a force", "a torque is needed"),
        ),
        (
            'unit = "rpm"',
            'unit = "m/s"',
            ("speed_limit.unit: unit 'm/s' is a velocity", "an angular velocity is needed"),
        ),
        ('unit = "s"', 'unit = "m"', ("channels.time.unit: unit 'm' is a length", "a time is needed")),
        ('unit = "mN*m"\n', 'unit = "Nm"\n', ("channels.torque.unit: unit 'Nm' is unknown", "write 'N*m'")),
        ('unit = "deg"', 'unit = ""', ("channels.position.unit: unit ''", "an angle is needed, such as 'rad'")),
        ('unit = "deg"', 'unit = "mm"', ("channels.position.unit: unit 'mm' is a length", "an angle is needed")),
        (
            'unit = "kg*cm^2"',
            'unit = "kg"',
            ("parameters.inertia.unit: unit 'kg' is a mass", "a moment of inertia is needed"),
        ),
        ('unit = "1/rad"', 'unit = "1/m"', ("parameters.a.unit: unit '1/m' does not fit", "'1/rad' is needed")),
    ],
)
def test_an_unknown_unit_or_another_dimension_is_refused(campaign, old, new, parts):
    campaign.swap(old, new).refused(*parts)


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("value = 25.0", "value = -25.0", ("effect 1 'inertia', parameters.inertia is -0.0025, outside", "0 to inf")),
        ("value = 139", "value = -1", ("parameters.h0 is -0.001, outside its physical bounds 0 to inf",)),
        ("value = 525.0", "value = 0", ("parameters.a is 0, outside its physical bounds",)),
        (
            "parameters.h0",
            'parameters.d = { value = 4, unit = "1" }\nparameters.h0',
            ("parameters.d is 4, outside", "to 1"),
        ),
    ],
)
def test_a_parameter_outside_its_bounds_is_refused(campaign, old, new, parts):
    campaign.swap(old, new).refused(*parts)


def test_the_bandwidth_is_below_what_the_slowest_record_carries(campaign):
    campaign.put("val_moves.csv", rows(20.0, 2e-3))
    campaign.swap("value = 0.15", "value = 0.3")
    campaign.refused(
        "evaluation_bandwidth is 300 Hz, but record 'val_moves' is sampled at 500 Hz; give less than 225 Hz"
    )


# --- channels ---------------------------------------------------------------------------------------------------------


def test_exactly_one_drive_channel_is_needed(campaign):
    campaign.swap("[channels.torque]", "[channels.normal]").refused(
        ": channels: neither 'torque' nor 'force' is declared; add"
    )
    campaign.swap("[channels.temperature]", "[channels.force]").swap("[channels.normal]", "[channels.torque]")
    campaign.refused(": channels: both 'torque' and 'force' are declared; keep the one that the drive reports.")


def test_two_masses_need_the_load_position(campaign):
    campaign.swap('"one mass"', '"two mass"').refused(
        ": channels: channel 'load_position' is missing; the plant needs it"
    )


def test_a_column_for_two_channels_is_refused(campaign):
    campaign.swap('column = "housing_C"', 'column = "torque_mNm"')
    campaign.refused(
        "channels.temperature.column: column 'torque_mNm' is channel 'torque' already; name another column."
    )


def test_a_column_that_the_file_lacks_is_refused(campaign):
    campaign.swap('column = "position_deg"', 'column = "position_dg"')
    campaign.refused("row 1: there is no column 'position_dg'", "did you mean 'position_deg'", file="id_sine.csv.gz")


def test_a_record_that_follows_no_reference_may_lack_its_column(campaign):
    """An output that is clamped has no set-point; what no record has is a wrong name."""
    campaign.swap(
        "[channels.temperature]", '[channels.reference]\ncolumn = "set_deg"\nunit = "deg"\n[channels.temperature]'
    )
    wide = np.insert(rows(20.0), 4, 1.0, axis=1)
    campaign.put("val_moves.csv", text(wide, "time_s,torque_mNm,position_deg,housing_C,set_deg"))
    c = campaign.load()
    assert ["reference" in r.channels for r in c.records] == [False, True]
    (found,) = c.findings
    assert found.subject == "id_sine" and "no column 'set_deg'" in found.sentence
    campaign.put("val_moves.csv", rows(20.0))
    campaign.refused("row 1: there is no column 'set_deg' for channel 'reference'", file="id_sine.csv.gz")


# --- records ----------------------------------------------------------------------------------------------------------


def test_both_roles_are_needed(campaign):
    campaign.swap('"validation"', '"identification"').refused(": records: no record has role 'validation'; add one")
    campaign.swap('"identification"', '"validation"', 2).refused(
        ": records: no record has role 'identification'; add one"
    )
    campaign.toml = campaign.toml[: campaign.toml.index("[[records]]")].replace("plant", "records = []\nplant", 1)
    campaign.refused(": records: no record has role 'identification'")


@pytest.mark.parametrize(
    "file", ["/etc/passwd.csv", "../val_moves.csv", "a/../../val_moves.csv", "a/../val_moves.csv", ""]
)
def test_a_path_that_leaves_the_folder_is_refused(campaign, file):
    shutil.copy(campaign.folder / "val_moves.csv", campaign.folder.parent)
    campaign.swap('"val_moves.csv"', f'"{file}"').refused(
        f"file: '{file}' is no path in the folder; copy the record into it."
    )


@pytest.mark.parametrize("file", ["a\\u0000.csv", "a" * 300 + ".csv", ".csv", "val_moves.docx"])
def test_a_path_that_is_no_record_is_refused(campaign, file):
    with pytest.raises(
        WorkbenchError,
        match=r"is no path in the folder|File name too long|rename the file|null character|readable are .csv",
    ):
        campaign.swap('"val_moves.csv"', f'"{file}"').load()


def test_a_link_is_followed_and_may_not_leave_the_folder(campaign):
    path, outside = campaign.folder / "val_moves.csv", campaign.folder.parent / "elsewhere.csv"
    path.rename(outside)
    path.symlink_to(outside)
    campaign.refused("record 2 'val_moves.csv', file: 'val_moves.csv' is no path in the folder")
    path.unlink()
    path.symlink_to(path)
    campaign.refused("record 2 'val_moves.csv', file: 'val_moves.csv' is no path in the folder")
    path.unlink()
    outside.rename(campaign.folder / "other.csv")
    path.symlink_to(campaign.folder / "other.csv")
    assert campaign.load().records[1].name == "val_moves"


def test_two_records_of_one_name_are_refused(campaign):
    campaign.put("id_sine.csv", rows())
    campaign.swap("val_moves.csv", "id_sine.csv")
    campaign.refused(
        "record 2 'id_sine.csv', file: 'id_sine.csv' and 'id_sine.csv.gz' are both record 'id_sine'; rename one, or give it a key 'name'."
    )


def test_a_record_that_is_not_there_is_refused(campaign):
    campaign.swap("val_moves.csv", "val_move.csv").refused(
        "no such file; did you mean 'val_moves.csv'?", file="val_move.csv"
    )


def test_a_short_record_is_refused(campaign):
    campaign.put("val_moves.csv", rows(count=50))
    campaign.load()
    campaign.put("val_moves.csv", rows(count=49))
    campaign.refused("row 50: the record ends after 49 samples; at least 50 are needed", file="val_moves.csv")


@pytest.mark.parametrize("back", [0.0, 0.0005])
def test_time_that_does_not_increase_is_refused_with_its_row(campaign, back):
    table = rows(20.0)
    table[41:, 0] -= 1e-3 + back
    campaign.put("val_moves.csv", table)
    for resample in (False, True):
        campaign.refused("row 43: time does not increase", "split the record", file="val_moves.csv", resample=resample)


def test_a_step_that_is_off_is_refused_with_its_row(campaign):
    table = rows(20.0)
    table[41:, 0] += 0.9e-5
    campaign.put("val_moves.csv", table)
    assert campaign.load().findings == ()
    table[41:, 0] += 0.3e-5
    campaign.put("val_moves.csv", table)
    campaign.refused(
        "row 43: the time step is 0.001012 s and the median step 0.001 s, more than 1 % apart (1 of 149 steps are)",
        "log at one rate, or allow resampling (--resample).",
        file="val_moves.csv",
    )


@pytest.mark.parametrize("late", [0, 1])
def test_stamps_that_were_rounded_are_those_of_one_rate_and_a_late_one_is_not(campaign, late):
    table = rows(20.0)
    instants = 3.0 + np.arange(len(table)) / 1200.0
    table[:, 0] = np.round(instants, 5)  # steps of 0.83 and 0.84 ms
    table[90:, 0] += late * 2e-5
    campaign.put("val_moves.csv", table)
    if late:
        campaign.refused("more than 1 % apart", file="val_moves.csv")
    else:
        c = campaign.load()
        assert c.findings == ()
        assert np.allclose(c.records[1].time, instants, rtol=0, atol=5e-6)
        assert np.allclose(np.diff(c.records[1].time), 1 / 1200.0, rtol=1e-3)


def test_ties_may_round_either_way(campaign):
    table = rows(20.0)
    instants = 0.7 + np.arange(len(table)) / 800.0  # every other one a tie of the fourth decimal
    table[:, 0] = (
        np.where(
            np.arange(len(table)) < len(table) // 2, np.floor(1e4 * instants + 1e-6), np.ceil(1e4 * instants - 1e-6)
        )
        / 1e4
    )
    campaign.put("val_moves.csv", table)
    c = campaign.load()
    assert c.findings == () and np.allclose(c.records[1].time, instants, rtol=0, atol=6e-5)


@pytest.mark.parametrize("begin", [0.0, 13.16, 38.1])
def test_a_period_may_be_the_round_number_and_every_other_stamp_a_tie(campaign, begin):
    """One sample in thirteen of 40 kHz, with five decimals; floating point rounds the ties of one half of a record up, and of the other down."""
    table = rows(20.0)
    table = np.vstack([table] * 20)
    table[:, 0] = np.round(begin + 3.25e-4 * np.arange(len(table)), 5)
    campaign.put("val_moves.csv", table)
    c = campaign.load()
    assert c.findings == () and c.records[1].dt == pytest.approx(3.25e-4, rel=1e-9)


def test_resampling_is_straight_lines_at_the_median_step_and_is_said(campaign):
    table = np.delete(rows(20.0), [40, 41, 42, 90], axis=0)
    campaign.put("val_moves.csv", table)
    c = campaign.load(resample=True)
    record = c.records[1]
    assert record.time.size == ROWS
    assert np.allclose(np.diff(record.time), 1e-3, rtol=1e-6, atol=0)
    assert np.allclose(record.drive, 0.1 + 1e-3 * np.arange(ROWS), rtol=1e-9)
    assert np.allclose(record.channels["temperature"], 293.15 + 0.1 * np.arange(ROWS))
    (finding,) = c.findings
    assert (finding.kind, finding.subject) == ("resampled", "val_moves")
    assert finding.evidence["steps_off"] == 2 and finding.evidence["longest_gap"] == pytest.approx(4e-3)
    assert "2 of 145 time steps" in finding.sentence and "0.004 s" in finding.sentence and finding.remedy


def test_even_records_are_not_touched_by_resampling(campaign):
    asked, plain = campaign.load(resample=True), campaign.load()
    assert asked.findings == ()
    for a, b in zip(asked.records, plain.records, strict=True):
        assert np.array_equal(a.time, b.time) and np.array_equal(a.drive, b.drive)


def test_a_long_gap_is_refused_and_with_resampling_the_record_is_cut_there(campaign):
    def load_without(*gap):
        campaign.put("val_moves.csv", np.delete(rows(20.0), range(*gap), axis=0))
        return campaign.load(resample=True)

    assert [r.name for r in load_without(60, 69).records] == ["id_sine", "val_moves"]
    cut = load_without(60, 70)
    campaign.refused(
        "row 62: a gap of 0.011 s in time, 11 median steps of 0.001 s; split the record there into two files, or into two records by 'until' and 'from', "
        "or allow resampling (--resample), which does.",
        file="val_moves.csv",
        resample=False,
    )
    first, second = cut.with_role("validation")
    assert [first.name, second.name] == ["val_moves_1", "val_moves_2"] and first.history == cut.records[0].history
    assert second.history is None  # what lay in the gap is not known
    assert (first.time.size, second.time.size) == (60, ROWS - 70)
    kept = np.delete(0.1 + 1e-3 * np.arange(ROWS), range(60, 70))
    assert np.allclose(np.concatenate([first.drive, second.drive]), kept, rtol=1e-9)
    (finding,) = cut.findings
    assert (finding.kind, finding.subject) == ("cut at gaps", "val_moves") and finding.remedy
    assert "0.011 s" in finding.sentence and "val_moves_1, val_moves_2" in finding.sentence


def test_what_is_too_short_between_gaps_is_left_out_and_said(campaign):
    campaign.put("val_moves.csv", np.delete(rows(20.0), range(40, 51), axis=0))
    cut = campaign.load(resample=True)
    assert [(r.name, r.time.size) for r in cut.with_role("validation")] == [("val_moves", ROWS - 51)]
    assert "'val_moves' alone, and 40 samples between gaps are left out" in cut.findings[0].sentence


def test_a_record_of_which_no_stretch_is_long_enough_is_refused_and_resampling_is_no_remedy(campaign):
    campaign.put("val_moves.csv", np.delete(rows(20.0), [*range(40, 52), *range(90, 102)], axis=0))
    campaign.refused(
        "two records by 'until' and 'from', of which each is long enough.", file="val_moves.csv", resample=True
    )


def test_a_record_that_is_cut_takes_no_name_that_another_one_has(campaign):
    campaign.put("val_moves.csv", np.delete(rows(20.0), range(60, 72), axis=0))
    campaign.swap('file = "id_sine.csv.gz"\n', 'file = "id_sine.csv.gz"\nname = "val_moves_2"\n')
    names = [r.name for r in campaign.load(resample=True).records]
    assert names == ["val_moves_2", "val_moves__1", "val_moves__2"]


def test_a_value_too_large_in_si_is_refused(campaign):
    table = text(rows(20.0)).replace("100.0,0.0", "1e308,0.0", 1)
    campaign.swap('unit = "mN*m"\n', 'unit = "kN*km"\n').put("val_moves.csv", table)
    campaign.refused(
        ", row 2: sample 1 of torque in record 'val_moves' is 1e+308 kN*km, more than", file="val_moves.csv"
    )


# --- anything at all --------------------------------------------------------------------------------------------------

TOKENS = [
    "",
    "0",
    "-1",
    "nan",
    "inf",
    "1e400",
    "true",
    '""',
    '"x"',
    "[]",
    "{}",
    "[[records]]",
    "[channels.x]",
    "\\",
    '"',
    "=",
]
TOKENS += [
    "\n",
    "\x00",
    "é",
    "9" * 5000,
    "[" * 2000,
    '"\\u0000"',
    '"m"',
    '"rad^9"',
    "1979-05-27",
    '"axis"',
    '"command"',
    "d =",
]


@settings(max_examples=250, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 2**32), tokens=st.lists(st.sampled_from(TOKENS), min_size=1, max_size=3))
def test_a_mutated_declaration_loads_or_is_refused_with_a_sentence(tmp_path, seed, tokens):
    (tmp_path / "campaign").mkdir(exist_ok=True)
    campaign = Builder(tmp_path / "campaign")
    draw = random.Random(seed)
    for token in tokens:
        kind, at = draw.randrange(4), draw.randrange(len(campaign.toml))
        lines = campaign.toml.split("\n")
        row = draw.randrange(len(lines))
        if kind == 0:  # another value for a key
            lines[row] = f"{lines[row].partition('=')[0]}= {token}" if "=" in lines[row] else token
        elif kind == 1:
            del lines[row]
        elif kind == 2:
            lines.insert(row, lines[draw.randrange(len(lines))])
        else:
            lines = (campaign.toml[:at] + token + campaign.toml[at + draw.randrange(8) :]).split("\n")
        campaign.toml = "\n".join(lines)
    try:
        assert campaign.load().records
    except WorkbenchError as e:
        assert str(e).startswith(str(tmp_path)) and str(e)[-1] in ".?"


@pytest.mark.parametrize(("note", "relaxed"), [("friction virgin", True), ("at rest, belt Relaxed", True), ("at rest", False), ("not relaxed", False), ("not yet relaxed", False), ("friction may be loaded", False), ("", False)])  # fmt: skip
def test_only_a_note_that_says_relaxed_promises_how_friction_starts(note, relaxed):
    assert promised(note) == relaxed
