"""Exported gain tables: what is in the files, what is refused, and that damage is found."""

import json
import os
import re
import struct
import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace

import jsonschema
import numpy as np
import pytest

from workbench import __version__
from workbench.definition import FORCE, Effect
from workbench.errors import WorkbenchError
from workbench.exporting import changed, export, load, load_binary, lookup32
from workbench.exporting.lookup import BOUND
from workbench.parameter import Parameter
from workbench.plant import ONE_MASS, Limits, Plant

FILES = ("gains.h", "gains.json", "gains.schema.json", "gains.bin")
SCALE = {"kp": {"unit": "A/count", "per_si": 3.7e-5}, "kd": {"unit": "A*s/count", "per_si": 0.011}}


@dataclass(frozen=True, eq=False)
class Table:
    """What an export reads of a schedule, with a look-up in float64 to compare with."""

    knots: np.ndarray
    kp: np.ndarray
    kd: np.ndarray
    rule: str = "frozen"
    reversal: float = 1.5e-5
    sample_time: float = 2.5e-4
    plant_digest: str = ""
    interpolation_error: float = 0.004
    per_octave: int = 4
    plant_lines: tuple[str, ...] | None = None

    def gains(self, amplitude):
        return tuple(np.interp(amplitude, self.knots, k) for k in (self.kp, self.kd))


def effect(name, **values) -> Effect:
    parameters = {n: Parameter(v, "F", n) for n, v in values.items()}
    return Effect(
        name=name,
        cause="",
        formula="",
        source="",
        port=FORCE,
        parameters=parameters,
        linear=(),
        reads=("a",),
        step=lambda s, z, p: ({}, 0.0),
    )


def plant(h0=0.15, rotary=True) -> Plant:
    effects = (effect("inertia", inertia=0.02), effect("presliding_hysteresis", h0=h0, x0=2e-4))
    return Plant(ONE_MASS, effects, rotary=rotary, limits=Limits(drive=3.0))


def schedule(of=None, octaves=(-17, -6), per_octave=4, **other) -> Table:
    """Gains that fall over amplitude as those of a presliding axis do, not smoothly, so that every entry matters."""
    of = of or plant()
    k = np.arange(octaves[0] * per_octave + 1, octaves[1] * per_octave + 2)
    knots = 2.0 ** (k // per_octave) * (1 + k % per_octave / per_octave)
    draw = np.random.default_rng(5).uniform(0.9, 1.1, (2, k.size))
    kp, kd = 40.0 / (1 + knots / 1e-3) * draw[0], 0.9 / (1 + knots / 3e-3) ** 0.5 * draw[1]
    return Table(knots, kp, kd, plant_digest=of.digest, per_octave=per_octave, **other)


def refused(*words, call=export, args=(), **named) -> str:
    with pytest.raises(WorkbenchError) as caught:
        call(*args, **named)
    sentence = str(caught.value)
    assert sentence[-1] in ".?", sentence
    for word in words:
        assert word in sentence, sentence
    return sentence


# --- what is written -------------------------------------------------------------------------------------------------


def test_four_files_are_written_and_hold_one_crc(tmp_path):
    paths = export(schedule(), plant(), tmp_path / "new" / "folder", scale=SCALE)
    assert [p.name for p in paths] == list(FILES)
    assert sorted(p.name for p in paths[0].parent.iterdir()) == sorted(FILES)
    held = load_binary(paths[3])
    payload = paths[3].read_bytes()[-len(held["tables"].payload) :]
    assert zlib.crc32(b"123456789") == 0xCBF43926
    crc = zlib.crc32(payload)
    assert held["crc32"] == crc
    assert load(paths[1])["payload"]["crc32"] == f"0x{crc:08X}"
    assert f"#define WB_GAINS_CRC32 0x{crc:08X}u\n" in paths[0].read_text()


@pytest.mark.parametrize("scale", [None, SCALE])
@pytest.mark.parametrize("rule", ["frozen", "following", "error", "closing"])
def test_every_file_says_everything(tmp_path, scale, rule):
    s, p = schedule(rule=rule), plant()
    h, j, _, b = export(s, p, tmp_path, scale=scale)
    contents, binary, text = load(j), load_binary(b), h.read_text()
    for key in ("knots", "kp", "kd"):
        assert contents[key] == list(getattr(s, key))
        assert np.array_equal(binary["tables"].rows[key], getattr(s, key).astype(np.float32))
    assert contents["rule"] == binary["rule"] == rule
    assert f"WB_GAINS_FROZEN {int(rule == 'frozen')}" in text and f"WB_GAINS_ERROR {int(rule == 'error')}" in text
    assert contents["reversal"] == s.reversal and binary["reversal"] == np.float32(s.reversal)
    assert contents["sample_time"] == s.sample_time and binary["sample_time"] == np.float32(s.sample_time)
    assert contents["plant"]["digest"] == binary["digest"] == p.digest and p.digest in text
    assert contents["plant"]["lines"] == list(p.digest_lines())
    for line in p.digest_lines():
        assert f"\nplant {line}\n" in binary["text"] and f"\n *   {line}\n" in text
    assert contents["project_version"] == __version__
    assert f"project_version {__version__}\n" in binary["text"] and f'PROJECT_VERSION "{__version__}"' in text
    assert contents["units"]["kd"] == "N*m*s/rad"
    assert "unit.kd N*m*s/rad\n" in binary["text"] and 'WB_GAINS_KD_UNIT "N*m*s/rad"' in text
    assert (
        ("drive" in contents) == ("WB_GAINS_HAS_DRIVE" in text) == ("drive." in binary["text"]) == (scale is not None)
    )
    assert ("kp_drive" in binary["tables"].rows) == (scale is not None)
    if scale:
        assert contents["drive"]["kp"] == {"unit": "A/count", "per_si": 3.7e-5, "gains": list(s.kp * 3.7e-5)}
        assert np.array_equal(binary["tables"].rows["kd_drive"], (s.kd * 0.011).astype(np.float32))
        assert "drive.kp.per_si 3.7e-05\n" in binary["text"] and 'KP_DRIVE_UNIT "A/count"' in text


def test_filter_and_notch_that_gains_were_tuned_with_stand_in_every_file(tmp_path):
    own = SimpleNamespace(**vars(schedule()), velocity_filter=1e-4, numbers=(0.75, -0.5, 0.25, 0.125))
    export(own, plant(), tmp_path)
    document, text = load(tmp_path / "gains.json"), (tmp_path / "gains.h").read_text()
    assert document["velocity_filter"] == 1e-4
    assert document["notch"] == {"b0": 0.75, "b1": -0.5, "b2": 0.25, "a2": 0.125}
    assert "keep no margin" in text and "#define WB_GAINS_NOTCH_B1 -0x1.0p-1f" in text
    assert "#define WB_GAINS_VELOCITY_FILTER 0x" in text
    said = load_binary(tmp_path / "gains.bin")["text"]
    assert "velocity_filter 0.0001\n" in said and "notch.a2 0.125\n" in said


def test_a_linear_axis_is_in_metres(tmp_path):
    p = plant(rotary=False)
    contents = load(export(schedule(p), p, tmp_path)[1])
    assert contents["units"] == {"knots": "m", "kp": "N/m", "kd": "N*s/m", "reversal": "m", "sample_time": "s"}


def test_the_bytes_depend_on_nothing_else(tmp_path):
    first, second = (export(schedule(), plant(), tmp_path / f, scale=SCALE) for f in "ab")
    assert [p.read_bytes() for p in first] == [p.read_bytes() for p in second]


def test_the_header_holds_floats_that_round_to_themselves(tmp_path):
    text = export(schedule(), plant(), tmp_path)[0].read_text()
    (entries,) = re.findall(r"wb_gains_kp\[WB_GAINS_COUNT\] = \{\n(.*?)\n\};", text, flags=re.S)
    kp = schedule().kp.astype(np.float32)
    assert [float.fromhex(v) for v in re.findall(r"^ +(\S+?)f[, ]", entries, flags=re.M)] == list(map(float, kp))
    assert [np.float32(v) for v in re.findall(r"\] (\S+) \*/", entries)] == list(kp)


def test_the_schema_is_one_and_forbids_what_it_does_not_know(tmp_path):
    _, j, s, _ = export(schedule(), plant(), tmp_path, scale=SCALE)
    schema = json.loads(s.read_bytes())
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    contents = json.loads(j.read_bytes())
    validator.validate(contents)
    for key in set(contents) - {"$schema", "interpolation_error", "drive"}:
        assert not validator.is_valid({k: v for k, v in contents.items() if k != key}), key
    assert not validator.is_valid(contents | {"more": 1})


def test_the_binary_has_its_documented_layout(tmp_path):
    data = export(schedule(), plant(), tmp_path)[3].read_bytes()
    magic, version, length, m, n, octave, rule = struct.unpack_from("<8s6I", data)
    assert (magic, version, octave, rule) == (b"WBGAINS\0", 1, 4, 1)
    assert (m, n, length % 8) == (schedule().knots.size, 5, 0)
    assert np.array_equal(np.frombuffer(data, "<f4", m, length), schedule().knots)
    assert struct.unpack_from("<I", data, 40)[0] == zlib.crc32(data[length:])
    assert struct.unpack_from("<I", data, length - 4)[0] == zlib.crc32(data[: length - 4])
    assert data[48:80].hex() == plant().digest


# --- the look-up -----------------------------------------------------------------------------------------------------


def test_float32_differs_from_float64_by_no_more_than_is_stated(tmp_path):
    s = schedule()
    a = np.exp(np.random.default_rng(1).uniform(np.log(s.knots[0] / 2), np.log(s.knots[-1] * 2), 20000))
    a = a.astype(np.float32).astype(float)
    i = np.clip(np.searchsorted(s.knots, a, side="right") - 1, 0, s.knots.size - 2)
    for got, true, k in zip(lookup32(s, a), s.gains(a), (s.kp, s.kd), strict=True):
        assert got.dtype == np.float32
        error = np.abs(got - true) / np.maximum(k[i], k[i + 1])
        assert 1e-8 < error.max() <= BOUND
    contents = export(s, plant(), tmp_path, scale=SCALE)[1]
    drive = lookup32(contents, a, drive=True)[1]
    assert np.all(np.abs(drive - s.gains(a)[1] * 0.011) <= BOUND * np.maximum(s.kd[i], s.kd[i + 1]) * 0.011)
    assert np.array_equal(lookup32(load(contents), a), lookup32(s, a))


def test_the_look_up_meets_knots_and_is_flat_beyond_them():
    s = schedule()
    kp, kd = lookup32(s, s.knots)
    assert np.array_equal(kp, s.kp.astype(np.float32)) and np.array_equal(kd, s.kd.astype(np.float32))
    below = [0.0, -0.0, -1.0, -np.inf, np.nan, 1e-45, s.knots[0] / 2]
    assert np.all(lookup32(s, below)[0] == kp[0])
    assert np.all(lookup32(s, [np.inf, 1e300, 1.0, s.knots[-1]])[1] == kd[-1])


def test_one_knot_is_a_table_too(tmp_path):
    s = Table(np.array([2.0**-10]), np.array([3.0]), np.array([0.0]), plant_digest=plant().digest)
    j = export(s, plant(), tmp_path)[1]
    kp, kd = lookup32(j, [0.0, 2.0**-10, 1.0, np.nan])
    assert np.all(kp == 3.0) and np.all(kd == 0.0)


def test_gains_in_units_that_are_not_there_are_refused():
    refused("drive's units", "scale", call=lookup32, args=(schedule(), [1.0]), drive=True)


# --- what is refused -------------------------------------------------------------------------------------------------


def test_a_changed_plant_is_refused_and_the_change_is_named(tmp_path):
    s = schedule()
    tuned = plant().digest_lines()
    said = "presliding_hysteresis@axis.h0 was 0.15, is 0.16"
    refused(said, args=(s, plant(0.16), tmp_path), tuned_lines=tuned)
    refused(said, args=(replace(s, plant_lines=tuned), plant(0.16), tmp_path))
    refused("does not hold the lines", args=(s, plant(0.16), tmp_path))
    refused("yet another plant", args=(s, plant(0.16), tmp_path), tuned_lines=plant(0.2).digest_lines())
    assert not any(tmp_path.iterdir())
    export(s, plant(0.15 * (1 + 1e-12)), tmp_path)  # not a change: digests hold nine digits


def test_changes_are_named_line_by_line():
    old = plant().digest_lines()
    bigger = plant() + effect("gravity", sine=0.3)
    assert changed(old, old) == ()
    assert changed(old, bigger.digest_lines()) == ("gravity@axis.sine was absent, is 0.3",)
    assert changed(bigger.digest_lines(), old) == ("gravity@axis.sine was 0.3, is gone",)
    assert changed(["kind one mass", "x 1"], ["kind two mass", "x 1"]) == ("kind was one mass, is two mass",)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"kp": {"unit": "A/count"}}, ["scale.kp.per_si is missing"]),
        ({"kd": {"unit": "A", "per_si": 0.0}}, ["scale.kd.per_si is 0.0", "above zero"]),
        ({"kd": {"unit": "A", "per_si": -1}}, ["scale.kd.per_si is -1"]),
        ({"kd": {"unit": "A", "per_si": np.nan}}, ["scale.kd.per_si is nan"]),
        ({"kd": {"unit": "A", "per_si": np.inf}}, ["scale.kd.per_si is inf"]),
        ({"kd": {"unit": "A", "per_si": True}}, ["scale.kd.per_si is True"]),
        ({"kd": {"unit": "A", "per_si": "3"}}, ["scale.kd.per_si is '3'"]),
        ({"kd": {"unit": "A", "per_si": 1e-60}}, ["kd_drive[0]", "float32"]),
        ({"kd": {"per_si": 1.0}}, ["scale.kd.unit is missing"]),
        ({"kd": {"unit": 'A"', "per_si": 1.0}}, ["scale.kd.unit", "plain"]),
        ({"kd": {"unit": "A*/", "per_si": 1.0}}, ["scale.kd.unit", "plain"]),
        ({"kd": {"unit": "A", "per_si": 1.0, "perSI": 2}}, ["scale.kd.perSI is unknown", "'per_si'"]),
        ({"kd": 3.0}, ["scale.kd is 3.0", "table"]),
        ({"ki": {}}, ["scale.ki is unknown"]),
    ],
)
def test_a_scale_that_cannot_be_used_is_refused(tmp_path, change, words):
    refused(*words, args=(schedule(), plant(), tmp_path), scale=SCALE | change)
    assert not any(tmp_path.iterdir())


def test_a_scale_of_one_gain_is_refused(tmp_path):
    refused("scale.kd is missing", args=(schedule(), plant(), tmp_path), scale={"kp": SCALE["kp"]})


def moved(values, i, factor):
    out = np.array(values)
    out[i] *= factor
    return out


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda s: {"rule": "freezing"}, ["'freezing'", "frozen"]),
        (lambda s: {"reversal": 0.0}, ["reversal is 0.0"]),
        (lambda s: {"sample_time": np.nan}, ["sample_time is nan"]),
        (lambda s: {"per_octave": 3}, ["per_octave is 3", "power of two"]),
        (lambda s: {"per_octave": 2}, ["knots[0]", "1 + j/2"]),
        (lambda s: {"knots": moved(s.knots, 2, 1 + 1e-12)}, ["knots[2]", "1 + j/4"]),
        (lambda s: {"knots": moved(s.knots, -1, 2.0)}, ["knots[44]", "that follows"]),
        (lambda s: {"knots": s.knots * 0}, ["knots", "at least one"]),
        (lambda s: {"kp": moved(s.kp, 3, np.nan)}, ["kp[3] is", "nan"]),
        (lambda s: {"kd": moved(s.kd, 0, 1e40)}, ["kd[0]", "float32"]),
        (lambda s: {"kd": s.kd[1:]}, ["kd has shape", "each of the"]),
    ],
)
def test_a_schedule_that_makes_no_table_is_refused(tmp_path, change, words):
    s = schedule()
    refused(*words, args=(replace(s, **change(s)), plant(), tmp_path))
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["", "Gains", "1st", "a-b", "../a", "a" * 32, "gains\n"])
def test_a_name_that_c_does_not_take_is_refused(tmp_path, name):
    refused("name", args=(schedule(), plant(), tmp_path), name=name)


# --- whole or not at all ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("there_before", [False, True])
@pytest.mark.parametrize("fails_at", [0, 1, 3])
@pytest.mark.parametrize("failure", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_a_failure_leaves_the_folder_as_it_was(tmp_path, monkeypatch, there_before, fails_at, failure):
    folder = tmp_path / "a" / "b"
    if there_before:
        export(schedule(), plant(), folder)
    before = {p: p.read_bytes() for p in folder.glob("*")}
    replace_file, calls = os.replace, []

    def failing(source, target):
        calls.append(target)
        if len(calls) == fails_at + 1:
            raise failure
        replace_file(source, target)

    monkeypatch.setattr(os, "replace", failing)
    with pytest.raises(WorkbenchError if isinstance(failure, OSError) else KeyboardInterrupt):
        export(schedule(rule="following"), plant(), folder)
    assert {p: p.read_bytes() for p in folder.glob("*")} == before
    assert there_before or not (tmp_path / "a").exists()


def test_a_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "taken").write_text("kept")
    refused("taken", "nothing was changed", args=(schedule(), plant(), tmp_path / "taken"))
    assert (tmp_path / "taken").read_text() == "kept"


# --- reading back ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> tuple[Path, ...]:
    return export(schedule(), plant(), tmp_path_factory.mktemp("written"), scale=SCALE)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.pop("rule"), ["the document", "'rule' is a required property"]),
        (lambda d: d.update(rule="slow"), ["rule", "'slow' is not one of"]),
        (lambda d: d["plant"].update(digest="x"), ["plant.digest", "'x' does not match"]),
        (lambda d: d["kp"].__setitem__(3, "4"), ["kp[3]", "'4' is not of type 'number'"]),
        (
            lambda d: d["kp"].__setitem__(3, 4.0),
            ["payload.crc32", "changed after the export", "export the table again"],
        ),
        (lambda d: d["drive"]["kd"]["gains"].__setitem__(0, 4.0), ["payload.crc32"]),
        (lambda d: d["payload"].update(crc32="0x00000000"), ["payload.crc32 is 0x00000000"]),
        (lambda d: d.pop("drive"), ["payload.rows"]),
        (lambda d: d["kd"].pop(), ["kd has shape"]),
        (lambda d: d["knots"].__setitem__(0, 1.0), ["knots[1]"]),
        (lambda d: d["plant"]["lines"].pop(), ["plant.digest", "plant.lines"]),
        (lambda d: d.update(more=1), ["'more' was unexpected"]),
    ],
)
def test_a_document_that_was_changed_is_refused(tmp_path, written, change, words):
    contents = json.loads(written[1].read_bytes())
    change(contents)
    path = tmp_path / "gains.json"
    path.write_text(json.dumps(contents))
    refused(str(path), *words, call=load, args=(path,))


@pytest.mark.parametrize(
    "text", [b"", b"{", b"[NaN]", b"\xff", b"[" * 100000, b"[]", b"null", b"[1" + 400 * b"0" + b"]"]
)
def test_what_is_no_document_is_refused(tmp_path, text):
    (tmp_path / "gains.json").write_bytes(text)
    refused("gains.json", call=load, args=(tmp_path / "gains.json",))


def test_a_file_that_is_not_there_is_refused(tmp_path):
    for call in (load, load_binary):
        refused("cannot be read", call=call, args=(tmp_path / "none",))


def test_every_flipped_bit_of_the_binary_is_found(tmp_path, written):
    data = written[3].read_bytes()
    path = tmp_path / "gains.bin"
    for bit in range(8 * len(data)):
        damaged = bytearray(data)
        damaged[bit // 8] ^= 1 << bit % 8
        path.write_bytes(damaged)
        refused("gains.bin", "export the table again", call=load_binary, args=(path,))


def test_a_binary_cut_short_or_grown_is_refused(tmp_path, written):
    data = written[3].read_bytes()
    for damaged in (b"", data[:60], data[:200], data[:-1], data + b"\0"):
        (tmp_path / "gains.bin").write_bytes(damaged)
        refused("gains.bin", call=load_binary, args=(tmp_path / "gains.bin",))
