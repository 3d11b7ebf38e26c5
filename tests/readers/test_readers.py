"""Record files: finite numbers come out; whatever is wrong is refused with file, row and mend."""

import gzip
import hashlib

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from refusals import sentence_of, write

from workbench.errors import WorkbenchError
from workbench.readers import load, read, reader

COLUMNS = {"time": "time_s", "position": "position_rad"}
GOOD = b"time_s,torque_Nm,position_rad\n0.0,1,-0.5\n0.001,2,-1e-3\n0.002,3,+.25\n"


def refused(path, columns=COLUMNS):
    return sentence_of(path, columns)


@pytest.mark.parametrize(
    "content",
    [
        GOOD,
        GOOD.rstrip(),
        GOOD + b"\n\n",
        GOOD.replace(b"\n", b"\r\n"),
        GOOD.replace(b"\n", b"\r"),
        b"\xef\xbb\xbf" + GOOD,
        GOOD.replace(b"time_s,torque_Nm", b'"time_s", "torque_Nm"'),
        GOOD.replace(b",2,", b",switched on,"),
    ],
    ids=[
        "unix",
        "no last line end",
        "blank at the end",
        "windows",
        "old mac",
        "byte-order mark",
        "quoted",
        "a text aside",
    ],
)
def test_declared_columns_are_read(tmp_path, content):
    path = write(tmp_path, content)
    channels, source = read(path, COLUMNS)
    assert list(channels) == ["time", "position"]
    assert np.array_equal(channels["time"], [0, 0.001, 0.002])
    assert np.array_equal(channels["position"], [-0.5, -1e-3, 0.25])
    assert (source.path, source.reader, source.columns) == (path, "csv", COLUMNS)
    assert source.sha256 == hashlib.sha256(content).hexdigest()


@pytest.mark.parametrize("name", ["run.csv.gz", "RUN.CSV.GZ", "run.csv"])
def test_gzip_is_unpacked_by_name_or_content(tmp_path, name):
    path = write(tmp_path, gzip.compress(GOOD), name)
    channels, source = read(path, COLUMNS)
    assert channels["time"].size == 3
    assert source.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_a_row_is_counted_as_editors_count(tmp_path):
    path = write(tmp_path, GOOD)
    sheet, _ = load(path, COLUMNS)
    assert sheet.place(0) == f"{path}, row 2"


def test_numbers_are_read_to_the_last_bit(tmp_path):
    values = np.random.default_rng(1).normal(size=(500, 2)) * 10.0 ** np.arange(-250, 250)[:, None]
    body = "\n".join(f"{a!r},{b!r}" for a, b in values.tolist())
    channels, _ = read(write(tmp_path, b"time_s,position_rad\n" + body.encode()), COLUMNS)
    assert np.array_equal(np.column_stack([channels["time"], channels["position"]]), values)


@pytest.mark.parametrize(
    "bad", ["nan", "NaN", "inf", "-Infinity", "1e999", "abc", "1_0", "0x1", "1.2.3", "--1", '"1"', "٣"]
)
@pytest.mark.parametrize("row", [2, 3, 4])
def test_what_is_no_finite_number_is_named_with_row_and_column(tmp_path, bad, row):
    lines = GOOD.decode().splitlines()
    lines[row - 1] = f"0.001,2,{bad}"
    sentence = refused(write(tmp_path, "\n".join(lines).encode()))
    assert sentence.startswith(f", row {row}: column 'position_rad' holds '{bad}'; a finite number is needed")
    assert "mend the cell or cut the record there." in sentence


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (b"0.001,2,-1e-3", b"0.001,2,", ", row 3: column 'position_rad' is empty; fill the cell"),
        (b"0.001,2,-1e-3", b"0.001,2", ", row 3: has 2 cells and the header 3; complete the row."),
        (b"0.001,2,-1e-3", b"0,001,2,-1e-3", ", row 3: has 4 cells and the header 3 (is a comma used for decimals"),
        (b"0.001,2,-1e-3", b"", ", row 3: is blank; remove the row"),
        (b"0.001,2,-1e-3", b"  \t", ", row 3: is blank; remove the row"),
        (b"0.0,1,-0.5", b"", ", row 2: is blank"),
        (b"time_s", b"", ", row 1: there is no column 'time_s' for channel 'time'; "),
        (
            b"position_rad",
            b"positon_rad",
            "no column 'position_rad' for channel 'position'; did you mean 'positon_rad'?",
        ),
        (b"torque_Nm", b"time_s", ", row 1: column 'time_s' is there twice; rename or remove one of them."),
        (GOOD[:29], b"", ", row 1: is blank; put the header with the column names there."),
        (b",", b"|", ", row 1: there is no column 'time_s' for channel 'time'; "),
        (b"-0.5", b"\xff", ", row 2: column 'position_rad' holds 'ÿ'"),
        (b"-1e-3", b"\x00", ", row 3: column 'position_rad' holds '\x00'"),
    ],
)
def test_a_broken_row_is_named_with_the_mend(tmp_path, old, new, sentence):
    assert old in GOOD
    said = refused(write(tmp_path, GOOD.replace(old, new)))
    assert sentence in said


@pytest.mark.parametrize("content", [b"", b"\n\n", b" \n"])
def test_an_empty_file_is_refused(tmp_path, content):
    assert "is empty; a header row and samples are needed" in refused(write(tmp_path, content))
    assert "is empty" in refused(write(tmp_path, gzip.compress(content), "run.csv.gz"))
    assert "is empty" in refused(write(tmp_path, b"", "none.csv.gz"))


def test_a_header_alone_is_refused(tmp_path):
    assert ": holds no samples below its header" in refused(write(tmp_path, b"time_s,position_rad\n"))


@pytest.mark.parametrize(
    "content",
    [gzip.compress(GOOD)[:-9], gzip.compress(GOOD)[:30], GOOD, b"\x1f\x8b" + bytes(60)],
    ids=["without its end", "cut", "plain", "zeros"],  # else the time of packing is in the name of the test
)
def test_a_corrupt_gzip_is_refused(tmp_path, content):
    sentence = refused(write(tmp_path, content, "run.csv.gz"))
    assert "is no whole gzip file" in sentence and "copy or pack it again." in sentence


def test_a_missing_file_is_answered_with_the_nearest_names(tmp_path):
    write(tmp_path, GOOD, "id_multisine.csv")
    assert "there is no such file; did you mean 'id_multisine.csv'?" in refused(tmp_path / "id_multisin.csv")
    assert "there is no such file; nor its folder." in refused(tmp_path / "sub" / "a.csv")


def test_a_folder_and_a_file_without_permission_are_refused(tmp_path, monkeypatch):
    (tmp_path / "run.csv").mkdir()
    assert ": is a folder or a device; a record is a file." in refused(tmp_path / "run.csv")
    path = write(tmp_path, GOOD, "locked.csv")

    def forbidden(self):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("pathlib.Path.read_bytes", forbidden)  # the superuser may read what a mode forbids
    assert ": cannot be read (Permission denied); make it a readable file." in refused(path)


def test_another_format_is_refused_with_those_that_are_read(tmp_path):
    for name in ("run.docx", "run", "run.csv.zip", "csv"):
        assert "no reader for this kind of file; readable are .csv, .csv.gz, " in refused(tmp_path / name)
    assert reader(tmp_path / "a.b.csv").name == "csv"


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_any_bytes_are_numbers_or_are_refused_with_a_sentence(tmp_path, data):
    pieces = [
        b"time_s",
        b"position_rad",
        b",",
        b"\n",
        b"\r",
        b"1.5",
        b"-2e3",
        b"nan",
        b'"',
        b" ",
        b"\x00",
        b"#",
        b"1e999",
    ]
    soup = st.lists(st.sampled_from(pieces), max_size=30).map(b"".join)
    content = data.draw(st.binary(max_size=60) | soup | soup.map(lambda b: b"time_s,position_rad\n" + b))
    if data.draw(st.booleans()):
        content = gzip.compress(content)
        if data.draw(st.booleans()):
            at = data.draw(st.integers(0, len(content) - 1))
            content = content[:at] + data.draw(st.binary(max_size=3)) + content[at + 1 :]
    path = write(tmp_path, content)
    try:
        channels, _ = read(path, COLUMNS)
    except WorkbenchError as e:
        assert str(e).startswith(str(path)) and str(e)[-1] in ".?"
    else:
        assert list(channels) == list(COLUMNS)
        assert channels["time"].size == channels["position"].size > 0
        assert all(np.isfinite(c).all() for c in channels.values())
