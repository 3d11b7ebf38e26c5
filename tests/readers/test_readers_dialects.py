"""Text tables as instruments and office programs write them: the dialect is found from the bytes, or refused in words."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from refusals import sentence_of

from workbench.errors import WorkbenchError
from workbench.readers import load, read

COLUMNS = {"time": "t", "force": "F"}


def write(folder, content, name="run.csv"):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def refused(path, columns=COLUMNS):
    return sentence_of(path, columns)


@pytest.mark.parametrize(
    ("content", "first"),
    [
        ("t,F\n0,1.5\n0.25,-2e3\n", 2),
        ("t;F\n0;1,5\n0,25;-2e3\n", 2),
        ("t;F\r\n0;1.5\r\n0.25;-2e3\r\n", 2),
        ("t\tF\n0\t1.5\n0.25\t-2e3\n", 2),
        ("t\tnote\tF\n0\ta, b\t1,5\n0,25\tc. d\t-2e3\n", 2),
        ("t F\n0 1.5\n0.25 -2e3\n", 2),
        ("  t    F\n  0    1,5\n  0,25 -2e3 \n", 2),
        ("t \tF\n0 \t1.5\n0.25\t-2e3\n", 2),
        ("# by hand\n% twice, so\n\nt,F\n0,1.5\n0.25,-2e3\n", 5),
        ("# t,F\n0,1.5\n0.25,-2e3\n", 2),
        ("# a log\n#t F\n0 1.5\n0.25 -2e3\n", 3),
        ("t,F\ns,N\n0,1.5\n0.25,-2e3\n", 3),
        ("t;x;F\n[s];[counts];[N]\n0;7;1,5\n0,25;;-2e3\n", 3),
        ("t;F;\n0;1.5;\n0.25;-2e3;\n", 2),
        ("\ufefft;F\n0;1,5\n0,25;-2e3\n", 2),
        ("\ufefft\tF\n0\t1,5\n0,25\t-2e3\n".encode("utf-16-le"), 2),
        ("F,W;t;Maß;F\n9;0;ä;1,5\n9;0,25;ö;-2e3\n".encode("latin-1"), 2),
    ],
)
def test_a_dialect_is_found(tmp_path, content, first):
    path = write(tmp_path, content)
    sheet, _ = load(path, COLUMNS)
    assert np.array_equal(sheet.channels["time"], [0, 0.25])
    assert np.array_equal(sheet.channels["force"], [1.5, -2000.0])
    assert sheet.place(1) == f"{path}, row {first + 1}"


@pytest.mark.parametrize("suffix", ["csv", "tsv", "txt"])
def test_other_suffixes_of_text_are_read(tmp_path, suffix):
    assert read(write(tmp_path, "t\tF\n1\t2\n", f"run.{suffix}"), COLUMNS)[0]["force"] == [2.0]


def test_a_header_in_latin_1_is_named_as_it_is_read_by_people(tmp_path):
    path = write(tmp_path, "t;Winkel (°)\n0;1,5\n".encode("latin-1"))
    assert read(path, {"time": "t", "position": "Winkel (°)"})[0]["position"] == [1.5]


def test_a_units_row_is_kept_as_the_file_writes_it(tmp_path):
    sheet, _ = load(write(tmp_path, "t;F;x\n(ms);kN;-\n0;1;2\n"), COLUMNS | {"position": "x"})
    assert sheet.units == {"time": "ms", "force": "kN", "position": "-"}


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("t;F\n0;1.5\n0,1;2.5\n", ", row 3: column 't' holds '0,1'; a finite number is needed"),
        ("t;F\n0;1,5\n0,1;2.5\n", ", row 3: column 'F' holds '2.5'; a finite number is needed"),
        ("t;F\n0;1.234,5\n", ", row 2: column 'F' holds '1.234,5'"),
        ("t;F\n0;1,2,3\n", ", row 2: column 'F' holds '1,2,3'"),
        ("t;F\n0;1,5\n0,1;\n", ", row 3: column 'F' is empty"),
        ("t;F\n0;1,5\n0,1\n", ", row 3: has 1 cells and the header 2; complete the row."),
        ("t;F\n0;1,5\n0;1;2\n", ", row 3: has 3 cells and the header 2 (is the delimiter inside a text?)"),
        ("t F\n0 1\n\n2 3\n", ", row 3: is blank"),
        ("# one\n# two\nt,F\ns,N\n0,1\n1,x\n", ", row 6: column 'F' holds 'x'"),
        ("# one\nt,G\n0,1\n", ", row 2: there is no column 'F' for channel 'force'; "),
        ("# only this\n# and that\n", ", row 2: there is no column 't'"),
        ("t,F\ns,N\n", ": holds no samples below its header"),
        ("t,F\ns,N\nms,kN\n0,1\n", ", row 3: column 't' holds 'ms'"),
        ("t,F\nno,data\n0,1\n", ", row 2: column 't' holds 'no'"),
        ("t,F\ns,nan\n0,1\n", ", row 2: column 't' holds 's'"),
        ("t,F\n0,N\n0,1\n", ", row 2: column 'F' holds 'N'"),
        (b"\xff\xfet", "begins as UTF-16 text and is none"),
    ],
)
def test_what_fits_no_dialect_is_refused(tmp_path, content, sentence):
    assert sentence in refused(write(tmp_path, content))


NAMES = st.sampled_from(["t", "F [N]", "Weg µm", "a.b", "x_1", "Drehmoment", "1", "%", "#2"])
FINITE = st.floats(allow_nan=False, allow_infinity=False)
UNITS = ("s", "N", "mm", "rad/s", "N*m", "degC", "°")


@st.composite
def tables(draw):
    """Return (names, numbers, units or None, bytes) of a random table in a random dialect."""
    names = draw(st.lists(NAMES, min_size=2, max_size=5, unique=True))
    numbers = draw(st.lists(st.lists(FINITE, min_size=len(names), max_size=len(names)), min_size=1, max_size=6))
    delimiter = draw(st.sampled_from([",", ";", "\t", " "]))
    comma = delimiter != "," and draw(st.booleans())
    units = [draw(st.sampled_from(UNITS)) for _ in names] if draw(st.booleans()) else None
    form = draw(st.sampled_from([repr, "{:.17e}".format, "{:+.17E}".format, "{:.400f}".format]))
    mark = (lambda text: text.replace(".", ",")) if comma else str
    blanks = draw(st.sampled_from(["", " ", "   "])) if delimiter != "\t" else ""
    join = (delimiter + blanks).join
    quoted = [f'"{n}"' if delimiter == " " or n.startswith(("#", "%")) or draw(st.booleans()) else n for n in names]
    lines = [join(quoted), *([join(units)] if units else []), *(join(mark(form(x)) for x in row) for row in numbers)]
    comments = draw(st.lists(st.sampled_from(["# a log", "%", "# 1, 2; 3", "#"]), max_size=3))
    end = draw(st.sampled_from(["\n", "\r\n", "\r"]))
    text = end.join([*comments, *lines]) + end * draw(st.integers(0, 2))
    encoding = draw(st.sampled_from(["utf-8", "utf-8-sig", "latin-1", "utf-16"]))
    return names, np.array(numbers), units, text.encode(encoding)


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(table=tables())
def test_a_random_table_in_a_random_dialect_is_read_back_to_the_last_bit(tmp_path, table):
    names, numbers, units, content = table
    sheet, _ = load(write(tmp_path, content), {f"channel {n}": n for n in names})
    assert np.array_equal(np.column_stack(list(sheet.channels.values())), numbers)
    assert list(sheet.units.values()) == (units or [])


PIECES = [
    "t",
    "F",
    ",",
    ";",
    "\t",
    " ",
    "\n",
    "\r",
    "#",
    "%",
    "1.5",
    "1,5",
    "-2e3",
    "s",
    "N",
    "nan",
    '"',
    "\ufeff",
    "°",
]


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(pieces=st.lists(st.sampled_from(PIECES), max_size=30), head=st.sampled_from(["", "t;F\n", "t F\n", "# t,F\n"]),
       encoding=st.sampled_from(["utf-8", "latin-1", "utf-16"]))  # fmt: skip
def test_any_text_is_numbers_or_is_refused_with_a_sentence(tmp_path, pieces, head, encoding):
    path = write(tmp_path, (head + "".join(pieces)).encode(encoding, errors="replace"))
    try:
        channels, _ = read(path, COLUMNS)
    except WorkbenchError as e:
        assert str(e).startswith(str(path)) and str(e)[-1] in ".?"
    else:
        assert channels["time"].size == channels["force"].size > 0
        assert all(np.isfinite(c).all() for c in channels.values())
