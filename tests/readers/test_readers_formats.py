"""Binary record files: what a format's own library wrote is read back to the last bit; the rest is refused in words."""

import gc
import io
import struct
import sys
import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from refusals import sentence_of, take_away, write

from workbench.errors import WorkbenchError
from workbench.readers import load, read, survey
from workbench.readers.mdf4 import fault

TIME = np.arange(250) * 1e-3 + 2.0
FORCE = np.random.default_rng(3).normal(size=250) * 10.0 ** np.random.default_rng(4).integers(
    -200, 11, 250
)  # beyond 1e12 no axis has it
COLUMNS = {"time": "t", "force": "F"}


def refused(path, columns=COLUMNS):
    return sentence_of(path, columns)


# --- how each format is written --------------------------------------------------------------------------------------


def mat5(variables, **options) -> bytes:
    import scipy.io

    stream = io.BytesIO()
    scipy.io.savemat(stream, variables, **options)
    return stream.getvalue()


def mat73(variables) -> bytes:
    """HDF5 as MATLAB lays it out: 512 bytes of its own, structures as groups, arrays transposed, a class each."""
    import h5py

    stream = io.BytesIO()
    with h5py.File(stream, "w", userblock_size=512) as file:
        put(file, variables)
    content = stream.getvalue()
    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    return head.ljust(512, b"\0") + content[512:]


def put(group, variables):
    for name, value in variables.items():
        if isinstance(value, dict):
            inner = group.create_group(name)
            inner.attrs["MATLAB_class"] = np.bytes_("struct")
            put(inner, value)
        elif isinstance(value, str):
            group[name] = np.frombuffer(value.encode("utf-16-le"), np.uint16)[:, None]
            group[name].attrs["MATLAB_class"] = np.bytes_("char")
        elif np.size(value) == 0:
            group[name] = np.array(np.shape(value), np.uint64)
            group[name].attrs["MATLAB_empty"] = np.uint8(1)
        else:
            group[name] = np.transpose(value)
            group[name].attrs["MATLAB_class"] = np.bytes_("double")


def mf4(*groups) -> bytes:
    """groups: (time, {name: values}) each."""
    from asammdf import MDF, Signal

    stream = io.BytesIO()
    with MDF(version="4.10") as file:
        for time, values in groups:
            file.append([Signal(v, time, name=n, unit="kN") for n, v in values.items()])
        file.save(stream)
    return stream.getvalue()


def tdms(channels) -> bytes:
    """channels: (group, name, values, properties) each."""
    from nptdms import ChannelObject, TdmsWriter

    stream = io.BytesIO()
    with TdmsWriter(stream) as writer:
        writer.write_segment([ChannelObject(*one) for one in channels])
    return stream.getvalue()


def both(**variables):
    return {"t": TIME[:, None], "F": FORCE[None, :], **variables}


WRITTEN = {
    "mat version 5": ("a.mat", lambda: mat5(both(other="text"))),
    "mat version 5, packed": ("A.MAT", lambda: mat5(both(), do_compression=True)),
    "mat version 4": ("a.mat", lambda: mat5(both(), format="4")),
    "mat version 7.3": ("a.mat", lambda: mat73(both(other="text"))),
    "mdf": ("a.mf4", lambda: mf4((TIME, {"F": FORCE, "x": TIME}))),
    "tdms": ("a.tdms", lambda: tdms([("axis", "t", TIME, {}), ("axis", "F", FORCE, {"unit_string": "kN"})])),
}


@pytest.fixture(scope="module", params=WRITTEN)
def written(request):
    name, make = WRITTEN[request.param]
    return name, make()


def columns_of(name):
    return {"time": "time", "force": "F"} if name.endswith(".mf4") else COLUMNS


# --- what holds for every format -------------------------------------------------------------------------------------


def test_what_was_written_is_read_back(tmp_path, written):
    name, content = written
    path = write(tmp_path, content, name)
    sheet, source = load(path, columns_of(name))
    assert list(sheet.channels) == ["time", "force"]
    assert np.array_equal(sheet.channels["time"], TIME)
    assert np.array_equal(sheet.channels["force"], FORCE)
    assert all(c.flags.owndata and c.flags.writeable and c.dtype == float for c in sheet.channels.values())
    assert sheet.place(0) == f"{path}, sample 1"
    assert source.reader == name.lower().split(".")[1].replace("mf4", "mdf")


def test_a_survey_finds_every_column(tmp_path, written):
    name, content = written
    found = survey(write(tmp_path, content, name))
    expected = columns_of(name)
    assert set(expected.values()) <= set(found.columns)
    np.testing.assert_array_equal(found.columns[expected["force"]], FORCE)


def test_an_absent_column_is_answered_with_the_nearest(tmp_path, written):
    name, content = written
    sentence = refused(write(tmp_path, content, name), columns_of(name) | {"position": "qm"})
    assert sentence.startswith((": there is no variable 'qm'; ", ": there is no channel 'qm'; "))


def test_a_file_that_breaks_off_is_refused_or_read_whole(tmp_path, written):
    name, content = written
    for size in sorted({0, 1, 8, 64, 65, 128, 200, 512, 600, len(content) // 2, len(content) - 9, len(content) - 1}):
        unharmed(write(tmp_path, content[:size], name), columns_of(name))


@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_any_bytes_are_numbers_or_are_refused_with_a_sentence(tmp_path, written, data):
    name, content = written
    garbage = data.draw(st.binary(max_size=80))
    at = data.draw(st.integers(0, len(content)))
    heads = st.sampled_from([garbage, content[:at] + garbage, content[:at] + garbage + content[at + len(garbage) :]])
    unharmed(write(tmp_path, data.draw(heads), name), columns_of(name))


def unharmed(path, columns):
    try:
        channels, _ = read(path, columns)
    except WorkbenchError as e:
        assert str(e).startswith(str(path)) and str(e)[-1] in ".?" and "\n" not in str(e)
    else:
        assert channels["time"].size == channels["force"].size > 0
        assert all(np.isfinite(c).all() for c in channels.values())


@pytest.mark.parametrize(
    ("module", "name", "make", "sentence"),
    [
        (
            "h5py",
            "a.mat",
            mat73,
            "a .mat file of version 7.3 needs the extra 'hdf5': pip install 'servo-workbench[hdf5]', or in a checkout pip install -e '.[hdf5]'.",
        ),
        (
            "asammdf",
            "a.mf4",
            None,
            ".mf4 files needs the extra 'mdf': pip install 'servo-workbench[mdf]', or in a checkout pip install -e '.[mdf]'.",
        ),
        (
            "nptdms",
            "a.tdms",
            None,
            ".tdms files needs the extra 'tdms': pip install 'servo-workbench[tdms]', or in a checkout pip install -e '.[tdms]'.",
        ),
    ],
)
def test_an_extra_that_is_not_installed_is_named(tmp_path, monkeypatch, module, name, make, sentence):
    path = write(tmp_path, make(both()) if make else b"", name)
    take_away(monkeypatch, module)
    assert refused(path) == f": reading {sentence}"


# --- MATLAB ----------------------------------------------------------------------------------------------------------

MATLAB = pytest.mark.parametrize("make", [mat5, mat73])


@MATLAB
def test_fields_of_structures_are_read(tmp_path, make):
    log = {"axis": {"F": FORCE[:, None], "n": np.arange(250)[None, :]}, "t": TIME[None, :]}
    path = write(tmp_path, make({"log": log, "gain": 35.15}), "a.mat")
    channels, _ = read(path, {"time": "log.t", "force": "log.axis.F", "count": "log.axis.n"})
    assert np.array_equal(channels["force"], FORCE) and np.array_equal(channels["count"], np.arange(250))
    assert read(path, {"gain": "gain"})[0]["gain"] == [35.15]
    assert ": 'log' has no field 'T'; did you mean 't'?" in refused(path, {"time": "log.T"})
    assert ": 'log.axis' has no field 'q'; known: F, n." in refused(path, {"time": "log.axis.q"})
    assert ": 'gain' is no structure and has no field 't'" in refused(path, {"time": "gain.t"})
    assert "holds a structure; " in refused(path, {"time": "log.axis"})


@MATLAB
@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        (np.ones((250, 2)), ": 'F' is "),
        ("forward", ": 'F' holds text; save it as a vector of real numbers."),
        (np.zeros((0, 0)), ": 'F' has 0 samples and 't' 250; "),
        (FORCE[:-1], ": 'F' has 249 samples and 't' 250; save all of one record at one rate."),
        (np.where(np.arange(250) == 41, np.nan, 1.0), ", sample 42: 'F' holds 'nan'; a finite number is needed"),
        (np.where(np.arange(250) == 0, -np.inf, 1.0), ", sample 1: 'F' holds '-inf'; "),
    ],
)
def test_a_variable_that_is_no_record_is_refused(tmp_path, make, value, sentence):
    assert sentence in refused(write(tmp_path, make(both(F=value)), "a.mat"))


def test_matlab_kinds_that_are_no_vectors_are_refused(tmp_path):
    cells = np.empty((1, 2), object)
    cells[0, :] = [1.0, "x"]
    path = write(tmp_path, mat5(both(c=1j * FORCE, cells=cells, many=np.zeros(3, [("F", float)]))), "a.mat")
    assert ": 'c' holds complex numbers; " in refused(path, {"force": "c"})
    assert ": 'cells' holds no plain numbers; " in refused(path, {"force": "cells"})
    assert ": 'many' holds cells or not just one structure; " in refused(path, {"force": "many.F"})


# --- MDF -------------------------------------------------------------------------------------------------------------


def test_groups_of_one_raster_are_read_together(tmp_path):
    path = write(tmp_path, mf4((TIME, {"F": FORCE}), (TIME, {"x": 2 * TIME})), "a.mf4")
    sheet, _ = load(path, {"time": "time", "force": "F", "position": "x"})
    assert np.array_equal(sheet.channels["position"], 2 * TIME) and np.array_equal(sheet.channels["time"], TIME)
    assert sheet.units == {"time": "s", "force": "kN", "position": "kN"}


def test_groups_of_different_rates_are_refused(tmp_path):
    path = write(tmp_path, mf4((TIME[::10], {"x": TIME[::10]}), (TIME, {"F": FORCE})), "a.mf4")
    assert read(path, {"force": "F", "time": "time"})[0]["time"].size == 250
    assert read(path, {"position": "x", "time": "time"})[0]["time"].size == 25
    sentence = refused(path, {"time": "time", "force": "F", "position": "x"})
    assert sentence == (
        ": 'F' (250 samples, 1000 Hz) and 'x' (25 samples, 100 Hz) are not sampled at the same instants; export them on "
        "one raster."
    )


def test_a_channel_name_that_is_there_twice_is_refused(tmp_path):
    path = write(tmp_path, mf4((TIME, {"F": FORCE}), (TIME, {"F": FORCE})), "a.mf4")
    assert ": channel 'F' is there 2 times; " in refused(path, {"force": "F"})


def test_another_version_of_mdf_is_refused(tmp_path):
    assert ": is no MDF 4 file; " in refused(write(tmp_path, b"MDF     3.30    ".ljust(200), "a.mf4"))
    assert ": was not closed by its logger; " in refused(
        write(tmp_path, b"UnFinMF 4.10    ".ljust(200, b"\0"), "a.mf4")
    )


def test_an_mdf_file_that_is_given_up_half_opened_is_refused_without_another_word(tmp_path, monkeypatch):
    said = []
    monkeypatch.setattr(sys, "unraisablehook", said.append)
    content = bytearray(mf4((TIME, {"F": FORCE})))
    content[12] = 0xFF  # its version is no text: asammdf stops before there is anything that it could close
    assert ": is no whole MDF 4 file (" in refused(write(tmp_path, bytes(content), "a.mf4"), {"force": "F"})
    gc.collect()
    assert said == []


def test_blocks_that_are_not_whole_or_lead_in_a_circle_are_found():
    def block(kind, *links, rest=b"", size=None):
        links = struct.pack(f"<{len(links)}Q", *links)
        return (
            b"##" + kind + bytes(4) + struct.pack("<QQ", size or 24 + len(links + rest), len(links) // 8) + links + rest
        )

    head = bytes(64) + block(b"HD", 136, 0, rest=bytes(32))
    assert fault(bytes(64) + block(b"HD", 0, 0, rest=bytes(32))) == ""
    assert fault(bytes(64)) == "there is no block at byte 64"
    assert fault(bytes(64) + block(b"HD", 0, 0)) == "the block at byte 64 is not whole"
    assert fault(head) == "there is no block at byte 136"
    assert fault(head + block(b"DG", 0, 0, 0, 0)) == ""
    assert fault(head + block(b"DG", 0, 0, 0, 0, size=99)) == "the block at byte 136 is not whole"
    assert fault(head + block(b"DG", 0, 0, 0, 999)) == "there is no block at byte 999"
    assert fault(head + block(b"DG", 136, 0, 0, 0)) == "its links lead to byte 136 twice"
    group = head + block(b"DG", 0, 192, 0, 0)
    group += block(b"CG", 0, 288, 0, 0, 0, rest=bytes(24) + struct.pack("<II", 8, 0))
    for bits, said in ((64, ""), (65, "the channel at byte 288 lies beyond its record")):
        channel = block(b"CN", 0, 0, rest=struct.pack("<BBBBII", 0, 0, 4, 0, 0, bits).ljust(48, b"\0"))
        assert fault(group + channel) == said


# --- TDMS ------------------------------------------------------------------------------------------------------------


def test_a_channel_is_named_by_its_group_where_that_is_needed(tmp_path):
    path = write(tmp_path, tdms([("a", "F", FORCE, {}), ("b", "F", -FORCE, {"unit_string": "kN"})]), "a.tdms")
    sheet, _ = load(path, {"force": "b/F"})
    assert np.array_equal(sheet.channels["force"], -FORCE) and sheet.units == {"force": "kN"}
    assert ": channel 'F' is there 2 times; name 'a/F' or 'b/F'." in refused(path, {"force": "F"})


def test_the_time_of_waveforms_is_made_from_start_and_step(tmp_path):
    wave = {"wf_increment": 1e-3, "wf_start_offset": 2.0}
    columns = {"time": "wf_increment", "force": "F", "position": "x"}
    path = write(tmp_path, tdms([("a", "F", FORCE, wave), ("a", "x", TIME, wave)]), "a.tdms")
    assert np.array_equal(read(path, columns)[0]["time"], 2.0 + 1e-3 * np.arange(250))
    path = write(tmp_path, tdms([("a", "F", FORCE, wave), ("a", "x", TIME, wave | {"wf_increment": 2e-3})]), "a.tdms")
    assert ": its waveforms differ in start, 'wf_increment' or length; " in refused(path, columns)
    path = write(tmp_path, tdms([("a", "F", FORCE, {}), ("a", "x", TIME, {})]), "a.tdms")
    assert ": its channels have no 'wf_increment'; " in refused(path, columns)


def test_channels_of_other_lengths_and_kinds_are_refused(tmp_path):
    times = (TIME * 1e6).astype("datetime64[us]")
    path = write(tmp_path, tdms([("a", "t", TIME, {}), ("a", "F", FORCE[:9], {}), ("a", "date", times, {})]), "a.tdms")
    assert ": 'F' has 9 samples and 't' 250; " in refused(path)


def test_dates_are_seconds(tmp_path):
    times = (TIME * 1e6).astype("datetime64[us]")
    path = write(tmp_path, tdms([("a", "F", FORCE, {}), ("a", "date", times, {})]), "a.tdms")
    assert np.allclose(read(path, {"time": "date"})[0]["time"], TIME, atol=1e-9)


# --- units that a file writes ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("written_unit", "count"), [("kN", 1), ("N", 0), ("mm", 1), ("Nm", 0), ("counts", 0), ("", 0)])
def test_a_unit_of_the_file_that_is_not_the_declared_one_is_said(tmp_path, written_unit, count):
    from workbench.readers import declaration
    from workbench.readers.channels import channels
    from workbench.readers.records import records

    text = "t;F;x\n" + f"s;{written_unit};m\n" + "".join(f"{k};1;2\n" for k in range(120))
    write(tmp_path, text.encode(), "a.csv")
    write(tmp_path, text.encode(), "b.csv")
    (tmp_path / "campaign.toml").write_text(
        '[channels]\ntime = { column = "t", unit = "s" }\nforce = { column = "F", unit = "N" }\n'
        'position = { column = "x", unit = "m" }\n[[records]]\nfile = "a.csv"\nrole = "identification"\n'
        '[[records]]\nfile = "b.csv"\nrole = "validation"\n'
    )
    top = declaration.read(tmp_path / "campaign.toml", ("channels", "records"), ())
    _, findings = records(top, tmp_path, channels(top, False, {}), False)
    assert [f.kind for f in findings] == ["unit"] * (2 * count)
    if count:
        assert findings[0].sentence == (
            f"Record 'a' states column 'F' in '{written_unit}', and it is declared in 'N'; the latter is used."
        )


def test_reading_leaves_no_warning(tmp_path, written):
    name, content = written
    path = write(tmp_path, content, name)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read(path, columns_of(name))
