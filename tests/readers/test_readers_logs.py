"""Logs of tools and robots: what a format's library wrote, or its specification says, is read; the rest is refused in words."""

import gzip
import io
import json
import zlib

import numpy as np
import pytest
from logs import binary, text
from refusals import take_away

from workbench.errors import WorkbenchError
from workbench.readers import SUFFIXES, limits, load, read, stem, survey

TIME = np.arange(250) * 1e-3 + 2.0
FORCE = np.random.default_rng(3).normal(size=250)
NAMES, UNITS = ["t", "F", "x"], ["s", "N", "m"]
TABLE = np.array([TIME, FORCE, TIME**2])


def feather(path):
    import pyarrow as pa
    import pyarrow.feather

    pyarrow.feather.write_feather(pa.table(dict(zip(NAMES, TABLE, strict=True))), path)


def split(path):
    path.write_text(json.dumps({"columns": NAMES, "index": list(range(250)), "data": TABLE.T.tolist()}))


def records(path):
    path.write_text(json.dumps([dict(zip(NAMES, row, strict=True)) for row in TABLE.T.tolist()]))


def channels(path):
    held = [{"name": n, "unit": u, "values": v.tolist()} for n, u, v in zip(NAMES, UNITS, TABLE, strict=True)]
    path.write_text(json.dumps({"device": "axis", "channels": held}))


def structured(path):
    np.save(path, np.rec.fromarrays(TABLE, names=NAMES))


def written(writer, *names):
    return lambda path: writer(path, list(names) or NAMES, TABLE, UNITS, 1000.0, False)


WRITTEN = {
    "parquet": ("a.parquet", written(binary.parquet), "s"),
    "feather": ("a.feather", feather, ""),
    "excel": ("a.xlsx", written(binary.excel), ""),
    "hdf5": ("a.h5", written(binary.hdf5), "s"),
    "npz": ("a.npz", written(binary.npz), ""),
    "npy of records": ("a.npy", structured, ""),
    "json lists": ("a.json", written(text.lists), ""),
    "json of pandas": ("a.json", split, ""),
    "json records": ("a.json", records, ""),
    "json channels": ("a.json", channels, "s"),
}


@pytest.fixture(params=WRITTEN)
def file(request, tmp_path):
    name, make, unit = WRITTEN[request.param]
    make(tmp_path / name)
    return tmp_path / name, unit


def refused(path, columns=None):
    with pytest.raises(WorkbenchError) as caught:
        read(path, columns or {"time": "t", "force": "F"})
    sentence = str(caught.value)
    assert sentence.startswith(str(path)) and sentence[-1] in ".?)" and "\n" not in sentence, sentence
    return sentence


def test_what_was_written_is_read_back_with_its_units(file):
    path, unit = file
    sheet, source = load(path, {"time": "t", "force": "F"})
    exact = {"rtol": 1e-15 if path.suffix == ".xlsx" else 0.0, "atol": 0.0}  # Excel keeps 15 to 16 digits
    assert np.allclose(sheet.channels["time"], TIME, **exact) and np.allclose(sheet.channels["force"], FORCE, **exact)
    assert sheet.units.get("time", "") == unit and source.columns == {"time": "t", "force": "F"}
    assert set(survey(path).columns) == set(NAMES)
    assert "'F'" in refused(path, {"force": "f"})


def test_a_file_that_is_cut_off_or_changed_is_refused_or_read_and_nothing_else(file):
    path, _ = file
    content = path.read_bytes()
    for k in range(24):
        broken = bytearray(content[: max(1, len(content) * (k + 1) // 25)])
        if k % 2:
            broken = bytearray(content)
            broken[(k * 7919) % len(broken)] ^= 0xFF
        path.write_bytes(bytes(broken))
        try:
            sheet, _ = load(path, {"time": "t", "force": "F"})
        except WorkbenchError as e:
            assert str(e).startswith(str(path)) and "\n" not in str(e)
        else:
            assert all(np.isfinite(c).all() for c in sheet.channels.values())


@pytest.mark.parametrize(
    ("module", "name", "extra"),
    [("pyarrow", "a.parquet", "parquet"), ("openpyxl", "a.xlsx", "excel"), ("mcap", "a.mcap", "mcap"), ("h5py", "a.h5", "hdf5")],
)  # fmt: skip
def test_an_extra_that_is_not_installed_is_named(tmp_path, monkeypatch, module, name, extra):
    (tmp_path / name).write_bytes(b"\x89HDF\r\n\x1a\n")
    take_away(monkeypatch, module)
    assert f"needs the extra '{extra}': pip install 'servo-workbench[{extra}]'" in refused(tmp_path / name)


# --- matrices --------------------------------------------------------------------------------------------------------


def matrix(path):
    import h5py
    import scipy.io

    if path.suffix == ".mat":
        scipy.io.savemat(path, {"log": {"m": TABLE.T, "turned": TABLE}})
    elif path.suffix == ".h5":
        with h5py.File(path, "w") as file:
            file["log/m"], file["log/turned"] = TABLE.T, TABLE
    else:
        np.savez(path, **{"log.m": TABLE.T, "log.turned": TABLE})
    return path


@pytest.mark.parametrize("suffix", [".mat", ".h5", ".npz"])
def test_rows_and_columns_of_matrices_are_addressed_and_their_shapes_said(tmp_path, suffix):
    path = matrix(tmp_path / f"a{suffix}")
    found, _ = read(path, {"time": "log.m(:,1)", "force": "log.m(:,2)", "row": "log.turned(3,:)"})
    assert np.array_equal(found["time"], TIME) and np.array_equal(found["force"], FORCE)
    assert np.array_equal(found["row"], TABLE[2])
    assert {"log.m(:,3)", "log.turned(1,:)"} <= set(survey(path).columns)
    if suffix != ".npz":
        assert "'log.m' is 250 x 3" in refused(path, {"time": "log.m(:,4)"}) + refused(path, {"time": "log.m"})


def test_fields_of_an_array_of_structures_are_counted_from_one(tmp_path):
    import scipy.io

    both = np.array([(FORCE, 1.0), (TIME, 2.0)], dtype=[("Data", "O"), ("Gain", "O")])
    scipy.io.savemat(tmp_path / "a.mat", {"Y": both})
    found, _ = read(tmp_path / "a.mat", {"force": "Y(1).Data", "time": "Y(2).Data"})
    assert np.array_equal(found["time"], TIME) and np.array_equal(found["force"], FORCE)
    assert "holds cells or not just one structure" in refused(tmp_path / "a.mat", {"time": "Y.Data"})


def test_hdf5_of_compound_datasets_is_read_by_their_fields(tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["run/rows"] = np.rec.fromarrays(TABLE, names=NAMES)
    assert np.array_equal(read(tmp_path / "a.hdf5", {"force": "run.rows.F"})[0]["force"], FORCE)
    assert set(survey(tmp_path / "a.hdf5").columns) == {"run.rows.t", "run.rows.F", "run.rows.x"}


# --- columns with clocks of their own --------------------------------------------------------------------------------


def scope(path, slow):
    lines = [
        "Name\tScope\nFile\tC:\\a.svdx\nStarttime of export\t132959949843760000\n",
        "Name\tForce\tName\tTemp\nUnit\tN\tUnit\t°C\n",
    ]
    for k in range(1000):
        lines.append(
            f"{k}\t{k * 0.5:.1f}".replace(".", ",") + (f"\t{slow * k}\t{30 + k}" if slow * k < 1000 else "\t\t") + "\n"
        )
    path.write_text("\n".join(lines[:1]) + "\n" + lines[1] + "\n" + "".join(lines[2:]) + "EOF\n")


def test_channels_of_a_scope_that_were_sampled_at_other_instants_are_put_on_the_slower_raster_and_that_is_said(
    tmp_path,
):
    scope(tmp_path / "a.csv", 4)
    sheet, _ = load(tmp_path / "a.csv", {"time": "time", "force": "Force", "temperature": "Temp"})
    assert np.allclose(np.diff(sheet.channels["time"]), 4e-3)
    assert np.allclose(sheet.channels["force"], 500.0 * sheet.channels["time"])
    assert "'Force' was not sampled at the instants of 'Temp' (250 Hz)" in sheet.notes[0]
    assert sheet.units == {"time": "s", "force": "N", "temperature": "°C"}


def test_what_is_twenty_times_slower_decides_no_raster(tmp_path):
    scope(tmp_path / "a.csv", 100)
    sheet, _ = load(tmp_path / "a.csv", {"time": "time", "force": "Force", "temperature": "Temp"})
    assert np.allclose(np.diff(sheet.channels["time"]), 1e-3)
    assert np.allclose(sheet.channels["temperature"][:901], 30 + 10 * sheet.channels["time"][:901])
    assert load(tmp_path / "a.csv", {"time": "time", "force": "Force"})[0].notes == ()


def test_topics_of_a_bag_are_called_by_their_paths(tmp_path):
    binary.mcap_json(tmp_path / "a.mcap", ["t", "/drive.position", "/drive.iq"], TABLE, UNITS, 1000.0, False)
    found, _ = read(tmp_path / "a.mcap", {"time": "time", "force": "/drive.position", "slow": "/thermal.winding"})
    assert np.array_equal(found["force"], FORCE) and np.allclose(np.diff(found["time"]), 1e-3, atol=1e-6)
    assert np.allclose(found["slow"][:200], 30 + 0.01 * np.arange(200), atol=1e-6)


def test_entries_of_a_wpilib_log_and_a_last_record_that_is_half_written(tmp_path):
    binary.wpilog(tmp_path / "a.wpilog", ["t", "F", "x"], TABLE, UNITS, 1000.0, False)
    content = (tmp_path / "a.wpilog").read_bytes()
    (tmp_path / "a.wpilog").write_bytes(content[:-5])
    found, _ = read(tmp_path / "a.wpilog", {"time": "time", "force": "F"})
    assert np.array_equal(found["force"], FORCE) and np.allclose(found["time"], TIME + 1e-6, atol=1e-7)
    (tmp_path / "b.wpilog").write_bytes(b"WPILOX" + content[6:])
    assert "is no whole WPILib data log" in refused(tmp_path / "b.wpilog")


# --- dates, quotes, comments -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "form",
    ["2026-11-22T10:15:{:06.3f}", "2026-11-22 10:15:{:06.3f}Z", "2026-11-22T10:15:{:06.3f}+01:00", "10:15:{:06.3f}"],
)
def test_dates_and_times_of_day_are_seconds(tmp_path, form):
    (tmp_path / "a.csv").write_text("t;F\n" + "".join(f"{form.format(2 + k / 100)};{k}\n" for k in range(200)))
    time = read(tmp_path / "a.csv", {"time": "t", "force": "F"})[0]["time"]
    assert np.allclose(np.diff(time), 0.01, atol=1e-6)


def test_numpy_s_own_text_and_quoted_cells_are_read(tmp_path):
    np.savetxt(tmp_path / "a.txt", TABLE.T, header="t F x")
    assert np.allclose(read(tmp_path / "a.txt", {"force": "F"})[0]["force"], FORCE)
    rows = "".join(f'"{a}","{b}"\n' for a, b in TABLE.T[:, :2])
    (tmp_path / "b.csv").write_text('"t","F"\n' + rows)
    assert np.array_equal(read(tmp_path / "b.csv", {"force": "F"})[0]["force"], FORCE)


# --- sizes and names -------------------------------------------------------------------------------------------------


def test_a_packed_file_that_would_fill_the_memory_is_refused_by_what_it_says(tmp_path, monkeypatch):
    monkeypatch.setattr(limits, "LARGEST", 2**20)
    (tmp_path / "a.csv.gz").write_bytes(gzip.compress(b"t,F\n" + b"0,0\n" * 2**19))
    assert "is more than 1 MiB when it is unpacked" in refused(tmp_path / "a.csv.gz")
    np.savez_compressed(tmp_path / "a.npz", t=np.zeros(2**19), F=np.zeros(9))
    assert "when it is unpacked" in refused(tmp_path / "a.npz")
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("t", (2**40,), "f8", chunks=(2**10,))
    assert "when it is unpacked" in refused(tmp_path / "a.h5", {"time": "t"})


def test_a_gzip_bomb_is_given_up_where_the_limit_is_reached(tmp_path, monkeypatch):
    monkeypatch.setattr(limits, "LARGEST", 2**16)
    packer, stream = zlib.compressobj(wbits=31), io.BytesIO()
    for _ in range(64):
        stream.write(packer.compress(bytes(2**20)))
    stream.write(packer.flush())
    (tmp_path / "a.csv.gz").write_bytes(stream.getvalue())
    assert "when it is unpacked" in refused(tmp_path / "a.csv.gz")


@pytest.mark.parametrize(
    ("name", "said"), [("run.2.csv.gz", "run_2"), ("a.b.mat", "a_b"), ("x.CSV", "x"), ("t.txt", "t")]
)
def test_dots_belong_to_a_record_s_name(name, said, tmp_path):
    assert stem(tmp_path / name) == said
    assert all(s.startswith(".") for s in SUFFIXES)
