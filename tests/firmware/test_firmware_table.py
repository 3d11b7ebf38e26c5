"""The firmware's table: the same numbers in every format, and a loader that takes no other than the one meant."""

import ctypes
import json
import struct
import zlib
from dataclasses import replace
from functools import cache

import bincopy
import numpy as np
import pytest
from firmware_bench import AXIS, LOOP, Gains, Host, every, need

from workbench.control import fixed_pd, scheduled_pd
from workbench.errors import WorkbenchError
from workbench.firmware import document, firmware
from workbench.firmware.export import export_firmware
from workbench.firmware.image import FIELDS, HEAD, read
from workbench.plant import ONE_MASS, Limits, Plant

TRUNCATED, MAGIC, ENDIAN, VERSION, LENGTH, DAMAGED, ARITHMETIC, LAW, PLANT, SHAPE, PERIOD, KNOTS, NUMBER, FIELD = range(
    1, 15
)
ARITHMETICS = ("float32", "fixed")


@cache
def host(arithmetic: str) -> Host:
    return Host(firmware(scheduled_pd(Gains), LOOP, AXIS, arithmetic, verdict=1))


def code(arithmetic: str, data: bytes) -> int:
    return host(arithmetic).library.wb_vectors_load(data, len(data))


def sealed(data: bytes) -> bytes:
    """The bytes with a CRC-32 that fits."""
    return data[:-4] + struct.pack("<I", zlib.crc32(data[:-4]))


def changed(data: bytes, field: str, value) -> bytes:
    values = list(HEAD.unpack_from(data))
    values[FIELDS.index(field)] = value
    return sealed(HEAD.pack(*values) + data[HEAD.size :])


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_the_loader_refuses_every_flipped_bit_and_every_truncation(arithmetic):
    data = host(arithmetic).made.image.bytes()
    assert code(arithmetic, data) == 0
    found = set()
    for bit in range(8 * len(data)):
        flipped = bytearray(data)
        flipped[bit // 8] ^= 1 << bit % 8
        refused = code(arithmetic, bytes(flipped))
        assert refused != 0, f"bit {bit}"
        found.add(refused)
    assert found == {MAGIC, ENDIAN, VERSION, TRUNCATED, LENGTH, DAMAGED}
    assert {code(arithmetic, data[:n]) for n in range(len(data))} == {TRUNCATED}
    assert code(arithmetic, data + b"\0") == LENGTH


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_every_refusal_has_its_own_code(arithmetic):
    image = host(arithmetic).made.image
    data = image.bytes()
    swapped = data[:8] + b"".join(data[i : i + 4][::-1] for i in range(8, len(data), 4))
    m = image.knots.size
    off = np.array(image.knots)
    off[3] *= 1.01
    cases = {
        MAGIC: sealed(b"X" + data[1:]),
        ENDIAN: swapped,
        VERSION: changed(data, "version", 2),
        TRUNCATED: data[:-4],
        LENGTH: data + b"\0\0\0\0",
        DAMAGED: data[:-1] + bytes((data[-1] ^ 1,)),
        ARITHMETIC: changed(data, "arithmetic", 3 - image.arithmetic),
        LAW: changed(data, "law", image.law ^ 1),
        SHAPE: changed(data, "knots", m + 9999),
        KNOTS: replace(image, knots=off).bytes(),
        FIELD: changed(data, "bits", 33),
    }
    for wanted, bad in cases.items():
        assert code(arithmetic, bad) == wanted
    for field, value in (("sample_time", 0.0), ("sample_time", np.nan), ("count", np.inf), ("limit", -1.0), ("verdict", 3),
                         ("jump", 2**22 + 1), ("bits", 1)):  # fmt: skip
        assert code(arithmetic, changed(data, field, value)) == FIELD
    for field, value in (("per_octave", 3), ("per_octave", 0), ("per_octave", 8192), ("per_octave", 1)):
        assert code(arithmetic, changed(data, field, value)) == KNOTS
    for field in ("constants", "rows", "knots"):
        assert code(arithmetic, changed(data, field, 0)) == SHAPE
    assert code(arithmetic, changed(data, "knots", m - 1)) == LENGTH


def test_a_number_that_is_not_finite_is_refused():
    image = host("float32").made.image
    for value in (np.nan, np.inf, -np.inf):
        constants, rows = np.array(image.constants), np.array(image.rows)
        constants[2], rows[1, 4] = value, value
        assert code("float32", replace(image, constants=constants).bytes()) == NUMBER
        assert code("float32", replace(image, rows=rows).bytes()) == NUMBER


def test_a_table_of_another_plant_law_or_encoder_is_refused():
    made = host("fixed").made
    text = "enum wb_refusal wb_axis_load(wb_axis_table *, const uint8_t *, size_t, const uint8_t *);"
    assert text.split("(")[0] in made.files["axis.h"]
    load = host("fixed").library.wb_axis_load
    memory = ctypes.create_string_buffer(100000)
    data = made.image.bytes()
    assert load(memory, data, ctypes.c_size_t(len(data)), bytes.fromhex(made.image.plant)) == 0
    other = Plant(ONE_MASS, limits=Limits(3.2, 20.9))
    assert load(memory, data, ctypes.c_size_t(len(data)), bytes.fromhex(other.digest)) == PLANT
    for another in (
        firmware(fixed_pd(1.0, 1.0), LOOP, AXIS, "fixed"),
        firmware(scheduled_pd(Gains, "frozen"), LOOP, AXIS, "fixed"),
        firmware(scheduled_pd(Gains), replace(LOOP, resolution=1e-5), AXIS, "fixed"),
    ):
        assert code("fixed", another.image.bytes()) == LAW
    assert code("float32", data) == ARITHMETIC
    assert code("fixed", host("float32").made.image.bytes()) == ARITHMETIC


def test_gains_tuned_again_load_into_the_firmware_that_is_there():
    """Within the powers of two that the scales were made for, a table needs no new firmware."""

    class Softer(Gains):
        kp, kd = 0.9 * Gains.kp, 0.95 * Gains.kd

    again = firmware(scheduled_pd(Softer), LOOP, AXIS, "fixed")
    assert again.image.law == host("fixed").made.image.law
    assert code("fixed", again.image.bytes()) == 0


@pytest.mark.parametrize("name", every())
@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_every_format_holds_the_same_table(arithmetic, name, tmp_path):
    made = firmware(*every()[name], arithmetic)
    paths = {p.name: p for p in export_firmware(made, tmp_path, address=0x0803FFF0)}
    data = paths["axis.bin"].read_bytes()
    assert read(data).bytes() == data == made.image.bytes()
    file = bincopy.BinFile(str(paths["axis.hex"]))
    assert file.as_binary() == data and file.minimum_address == 0x0803FFF0
    assert document.load(paths["axis.json"]).bytes() == data
    listed = paths["axis_table.h"].read_text().split("= {")[1].split("}")[0]
    assert bytes(int(b, 16) for b in listed.replace("\n", "").split(",")) == data
    assert all("icence is claimed" in p.read_text() for n, p in paths.items() if n.endswith((".c", ".h", ".a2l")))


def test_the_a2l_reads_back_by_another_reader(tmp_path):
    need("pya2l", "no A2L reader here")
    from pya2l import import_a2l, model  # GPL: in tests alone; seconds to import, so both arithmetics are read here

    for arithmetic in ARITHMETICS:
        made = firmware(scheduled_pd(Gains), LOOP, AXIS, arithmetic)
        export_firmware(made, tmp_path / arithmetic, address=0x1000)
        session = import_a2l(str(tmp_path / arithmetic / "axis.a2l"), in_memory=True, loglevel="ERROR")
        found = {c.name: c for c in session.query(model.Characteristic).all()}
        methods = {m.name: m for m in session.query(model.CompuMethod).all()}
        constants = made.numbers.stages.constants
        rows = [n + s for n in made.numbers.columns for s in (("", "_slope") if arithmetic == "float32" else ("",))]
        assert set(found) == {c.identifier for c in constants} | set(rows)
        data, word = made.image.bytes(), "<f" if arithmetic == "float32" else "<i"
        for c, value, real in zip(constants, made.image.constants, made.numbers.values, strict=True):
            assert struct.unpack_from(word, data, found[c.identifier].address - 0x1000)[0] == value
            factor = methods[found[c.identifier].conversion].coeffs.b
            assert value / factor == pytest.approx(real, rel=1e-6 if "limit" not in c.identifier else 1e-4)
        for name, row in zip(rows, made.image.rows, strict=True):
            assert struct.unpack_from(word, data, found[name].address - 0x1000)[0] == row[0]


def test_a_document_that_was_changed_is_refused_by_name(tmp_path):
    export_firmware(firmware(scheduled_pd(Gains), LOOP, AXIS), tmp_path)
    path = tmp_path / "axis.json"
    good = json.loads(path.read_text())
    for change, said in (
        (lambda d: d["constants"][0].update(value=1.0), "crc32"),
        (lambda d: d.update(jump=0), "jump"),
        (lambda d: d.pop("limit"), "limit"),
        (lambda d: d.update(surplus=1), "surplus"),
    ):
        bad = json.loads(json.dumps(good))
        change(bad)
        path.write_text(json.dumps(bad))
        with pytest.raises(WorkbenchError, match=said):
            document.load(path)
    path.write_text("{")
    with pytest.raises(WorkbenchError, match="not JSON"):
        document.load(path)


def test_python_refuses_a_damaged_table_by_name():
    data = firmware(fixed_pd(900.0, 5.0), LOOP, AXIS).image.bytes()
    for bad, said in ((data[:50], "fewer"), (b"X" + data[1:], "magic"), (changed(data, "version", 9), "version is 9"),
                      (changed(data, "order", 0x04030201), "byte order"), (data[:-1], "says"), (data[:-1] + b"\0", "CRC-32"),
                      (changed(data, "arithmetic", 7), "arithmetic 7")):  # fmt: skip
        with pytest.raises(WorkbenchError, match=said):
            read(bad)


def test_names_and_addresses_that_cannot_be_are_refused(tmp_path):
    with pytest.raises(WorkbenchError, match="a letter first"):
        export_firmware(firmware(fixed_pd(1.0, 1.0), LOOP, AXIS, name="2x"), tmp_path)
    with pytest.raises(WorkbenchError, match="32 bits"):
        export_firmware(firmware(fixed_pd(1.0, 1.0), LOOP, AXIS), tmp_path, address=2**32 - 5)
