"""The report says what was found, in a page and a PDF that are the same bytes for the same result."""

import os
import re
import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from pypdf import PdfReader
from report_example import further, study

from workbench.definition import find
from workbench.finding import Finding
from workbench.report import drawing, write
from workbench.report.chapters import standard
from workbench.report.contents import Callout, Chapter, Figure, Heading, Items, Marked, Paragraph, Table
from workbench.report.model import declared
from workbench.report.wording import printable
from workbench.tracing.result import NOTHING, UNKNOWN, Refinement

TESTS = Path(__file__).resolve().parents[1]
HOSTILE = (
    "#let x = 1 $y$ [z] *b* _i_ <lab> \\ \"q\" 'r' `c` @ref // /* - = \\u{41} &amp; </script> \u03bb \u65e5 \u2212 10^2"
)
VOID = {"meta", "img", "br", "link", "hr"}


class Page(HTMLParser):
    """Text, tags and attributes of a page; an end tag that nothing opened is an error."""

    def __init__(self, source: str):
        super().__init__()
        self.open, self.seen, self.text, self.images = [], [], "", []
        self.feed(source)

    def handle_starttag(self, tag, attrs):
        self.seen.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.seen.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("style", "title", "script"):
            self.text += data


def squeezed(text: str) -> str:
    """Return text without any space, so that line breaks and hyphens of a layout do not matter."""
    return re.sub(r"[\s\u00a0\u202f\u00ad\u2010-]+", "", text)


@pytest.fixture(scope="module")
def result():
    return replace(study(), chapters=(further(),))


@pytest.fixture(scope="module")
def folder(result, tmp_path_factory):
    path = tmp_path_factory.mktemp("report")
    write(result, path)
    return path


@pytest.fixture(scope="module")
def source(folder):
    return (folder / "report.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(source):
    return Page(source)


@pytest.fixture(scope="module")
def paper(folder):
    return PdfReader(folder / "report.pdf")


def contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


# --- the same bytes --------------------------------------------------------------------------------------------------


def test_the_example_is_one_in_which_the_cause_shows():
    t = study().trace
    assert t.after.validation < 0.3 * t.before.validation
    assert t.added == ("stribeck_friction",)


def test_two_writes_are_the_same_bytes(result, folder, tmp_path):
    write(result, tmp_path)
    assert contents(tmp_path) == contents(folder)
    assert {"report.html", "report.pdf", "figures/candidates.svg"} <= set(contents(folder))


def test_processes_in_other_places_write_the_same_bytes(tmp_path, folder):
    code = (
        "import sys; from dataclasses import replace; from pathlib import Path; sys.path.insert(0, sys.argv[1]);"
        "from report_example import further, study; from workbench.report import write;"
        "write(replace(study(), chapters=(further(),)), Path(sys.argv[2]))"
    )
    running = []
    for seed in ("1", "4242"):
        here = tmp_path / seed
        out, scratch = here / "out", here / "scratch"
        out.mkdir(parents=True)
        scratch.mkdir()
        (here / "matplotlibrc").write_text("font.size: 20\naxes.facecolor: red\n")
        paths = [str(TESTS.parent), os.environ.get("PYTHONPATH", "")]
        env = {
            **os.environ,
            "PYTHONHASHSEED": seed,
            "TMPDIR": str(scratch),
            "PYTHONPATH": os.pathsep.join(filter(None, paths)),
        }
        running.append((subprocess.Popen([sys.executable, "-c", code, str(TESTS), str(out)], cwd=here, env=env), out))
    for process, out in running:
        assert process.wait() == 0
        assert contents(out) == contents(folder)


# --- what it says ----------------------------------------------------------------------------------------------------


def said(result) -> list[str]:
    """Return every piece of text that the chapters hold."""
    texts = [result.title, result.question, result.trace.sentence]
    for chapter in (*standard(result), *result.chapters):
        texts.append(chapter.title)
        for block in chapter.blocks:
            texts += [getattr(block, n) for n in ("text", "caption") if hasattr(block, n)]
            texts += getattr(block, "texts", ())
            if isinstance(block, Table):
                cells = [c for row in (block.columns, *block.rows) for c in row]
                texts += [c.text if isinstance(c, Marked) else c for c in cells]
    return texts


def test_the_page_holds_every_text(result, page):
    seen = squeezed(page.text)
    assert [t for t in said(result) if squeezed(t) not in seen] == []


def test_the_paper_holds_verdict_checks_and_captions(result, folder, paper):
    assert (folder / "report.pdf").read_bytes().startswith(b"%PDF")
    text = squeezed(" ".join(p.extract_text() for p in paper.pages))
    wanted = [result.trace.sentence, *(c.name for c in result.checks), "failed"]
    wanted += [b.caption for c in standard(result) for b in c.blocks if hasattr(b, "caption")]
    assert [w for w in wanted if squeezed(w) not in text] == []


def test_the_finding_comes_first(result):
    first = standard(result)[0]
    assert first.blocks[0] == Callout(result.trace.sentence)
    (figure,) = [b for b in first.blocks if isinstance(b, Figure)]
    assert "0.79" in figure.alt and "3.8" in figure.alt
    assert not [b for b in first.blocks if isinstance(b, Table)]


@pytest.mark.parametrize(("verdict", "tone"), [(NOTHING, "good"), (UNKNOWN, "bad")])
def test_a_report_without_a_cause_shows_one_model(verdict, tone, tmp_path):
    result = study(verdict)
    write(replace(result, equivalent=(), checks=()), tmp_path)
    page = Page((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert ("div", {"class": f"callout {tone}"}) in page.seen
    assert "extended model" not in page.text
    assert ("Between 100 and 400\u00a0mrad/s, moving forward (velocity)." in page.text) == (verdict == UNKNOWN)


def test_what_stands_in_the_place_of_a_declared_law_is_said_where_the_model_is_shown(result):
    fit = result.trace.before
    film = find("film_friction")
    told = tuple(replace(e, effect="film_friction", at="axis") for e in fit.estimates[-1:])
    before = replace(fit, plant=fit.plant.without("coulomb_friction@axis") + film)
    law = Refinement("coulomb_friction", "axis", "law", "It turns over a speed.", told, 0.1)
    shown = declared(replace(result, trace=replace(result.trace, before=before, refinements=(law,))))
    assert "Film friction stands in the place of the declared Coulomb friction" in shown.blocks[0].text
    # a curve that is a refinement alone stands in the place of nothing
    assert (
        declared(replace(result, trace=replace(result.trace, refinements=(law,)))).blocks[0]
        == declared(result).blocks[0]
    )


def test_what_each_record_says_stands_beside_the_intervals_and_where_they_disagree_apart(result):
    fit = result.trace.before
    name = "viscous_friction@axis.viscous"
    sentence = "viscous_friction: one value does not serve both."
    told = replace(
        fit, spread={name: (0.001, 0.02)}, findings=(*fit.findings, Finding("records disagree", name, sentence, {}, "")),
    )  # fmt: skip
    chapter = declared(replace(result, trace=replace(result.trace, before=told)))
    table = next(b for b in chapter.blocks if isinstance(b, Table) and "by record" in b.columns)
    at = table.columns.index("by record")
    cells = {row[1].text: row[at] for row in table.rows}
    assert cells["viscous"] == Marked("0.0010 to 0.0200", "bad")
    assert cells["inertia"].text == "\u2013"
    under = dict(zip([b.text for b in chapter.blocks if isinstance(b, Heading)],
                     [b.texts for b in chapter.blocks if isinstance(b, Items)], strict=True))  # fmt: skip
    assert under["Where the records disagree"] == (sentence,)
    assert sentence not in "".join(under["What these records do not determine"])
    assert not any("by record" in b.columns for b in declared(result).blocks if isinstance(b, Table))


def test_chapters_of_a_study_stand_before_the_method(page, result):
    titles = [c.title for c in standard(result)]
    assert titles[titles.index("Tuning") :][1:3] == ["Does it reach what was required?", "How it was computed"]
    assert page.text.count("Tuning") == 2  # in the list of chapters and as a heading


# --- how it is made --------------------------------------------------------------------------------------------------


def test_the_page_stands_alone(source, page):
    assert page.open == []
    for tag, attributes in page.seen:
        for name in ("src", "href"):
            assert re.match(r"data:image/|#", attributes.get(name, "#")), (tag, attributes)
    assert "@import" not in source and "url(" not in source.replace("url(#", "")
    assert "fetch(" not in source and "XMLHttpRequest" not in source and "import(" not in source
    assert "http" not in source


def test_the_page_can_be_read_by_all(source, page):
    tags = dict(reversed(page.seen))
    assert tags["html"] == {"lang": "en"} and "main" in tags and "nav" in tags
    assert [t for t, _ in page.seen].count("h1") == 1
    images = [a for t, a in page.seen if t == "svg"]
    assert len(images) == 6 and all(a["role"] == "img" and len(a["aria-label"]) > 5 for a in images)
    assert "prefers-color-scheme: dark" in source and "@media print" in source and "overflow-x: auto" in source
    assert source.count("<math") == 5 and "(5)" in page.text
    assert all(a.get("scope") == "col" for t, a in page.seen if t == "th")


def test_the_paper_is_tagged_and_names_no_day(paper):
    assert paper.trailer["/Root"]["/MarkInfo"]["/Marked"]
    assert paper.metadata.title == "What the model of the bench axis lacks"
    assert paper.metadata.creation_date.year == 1970
    metadata = paper.trailer["/Root"]["/Metadata"].get_data().decode()
    assert "<pdfaid:part>3<" in metadata and "<pdfuaid:part>1<" in metadata


def test_no_file_names_a_place_of_this_machine(folder, tmp_path, result):
    places = [str(folder), str(TESTS), "/tmp", "/somewhere", os.path.expanduser("~") + "/", sys.prefix]
    for name, content in contents(folder).items():
        text = content.decode("latin-1")
        if name.endswith(".pdf"):
            text = " ".join(p.extract_text() for p in PdfReader(folder / name).pages)
        assert [p for p in places if p in text] == [], name


# --- figures ---------------------------------------------------------------------------------------------------------


def test_every_figure_has_a_title_axes_with_units_and_little_weight(folder, result):
    expected = {f"{b.name}.svg" for c in standard(result) for b in c.blocks if isinstance(b, Figure)}
    files = list((folder / "figures").iterdir())
    assert {f.name for f in files} == expected
    for file in files:
        assert file.stat().st_size < 300_000
        root = ElementTree.fromstring(file.read_bytes())
        title = root.find("{*}title").text
        drawn = " ".join("".join(e.itertext()) for e in root.iter("{http://www.w3.org/2000/svg}text"))
        assert len(title) > 15 and squeezed(title) in squeezed(drawn)
        assert (
            len(re.findall(r"\((?:[^)]*/)?(?:rad|s|mN\u00b7m|%|N\u00b7m/rad|rad/s)\)", drawn)) >= 2
            or "least share that counts" in drawn
            or "declared model" in drawn
        )
        assert "http" not in file.read_text("utf-8").replace("http://www.w3.org/", "")


def test_series_are_named_where_there_are_several(folder):
    drawn = (folder / "figures" / "residual_in_time.svg").read_text("utf-8")
    assert all(f">{name}</text>" in drawn for name in ("measured", "declared model", "extended model"))


def test_a_long_trace_is_thinned_and_keeps_its_extremes():
    rng = np.random.default_rng(0)
    x, y = np.arange(100_000.0), rng.normal(size=100_000)
    decimate, values = drawing.envelope(x, y)
    assert decimate.size <= 2 * drawing.BINS and np.all(np.diff(decimate) > 0)
    assert values.min() == y.min() and values.max() == y.max()
    assert drawing.envelope(x[:100], y[:100])[0].size == 100


def test_a_long_record_makes_no_heavy_figure():
    x = np.linspace(0, 100, 200_000)
    svg = drawing.svg("A long record", lambda a: a[0].plot(*drawing.envelope(x, np.sin(50 * x))))
    assert len(svg) < 100_000


def test_pyplot_is_not_needed():
    code = "import sys, workbench.report; assert not [m for m in sys.modules if m.startswith('matplotlib')]"
    env = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(filter(None, [str(TESTS.parent), os.environ.get("PYTHONPATH", "")])),
    }
    subprocess.run([sys.executable, "-c", code], check=True, env=env)


# --- text is text ----------------------------------------------------------------------------------------------------


def test_text_of_the_data_is_never_markup(tmp_path):
    plain = study()
    chapter = Chapter(HOSTILE, (
        Paragraph(HOSTILE), Callout(HOSTILE), Table((HOSTILE, "b"), ((HOSTILE, Marked(HOSTILE, "code")),), HOSTILE, "lp"),
        Figure("hostile", lambda: drawing.svg(HOSTILE, lambda a: None), HOSTILE, HOSTILE),
    ))  # fmt: skip
    records = tuple(replace(r, motion=HOSTILE, file=HOSTILE) for r in plain.records)
    checks = (replace(plain.checks[0], name=HOSTILE),)
    ranked = (replace(plain.trace.ranked[0], effect=HOSTILE), *plain.trace.ranked[1:])
    trace = replace(plain.trace, sentence=HOSTILE, ranked=ranked)
    result = replace(
        plain, title=HOSTILE, name=HOSTILE, question=HOSTILE, campaign=HOSTILE, records=records, checks=checks,
        trace=trace, chapters=(chapter,),
    )  # fmt: skip
    write(result, tmp_path)
    page = Page((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert page.open == []
    assert page.text.count(HOSTILE) >= 14
    assert not {"b", "em", "lab"} & {t for t, _ in page.seen} and [t for t, _ in page.seen].count("script") == 1
    paper = PdfReader(tmp_path / "report.pdf")
    assert paper.metadata.title == HOSTILE
    text = squeezed(" ".join(p.extract_text() for p in paper.pages)).replace("\u65e5", "")
    assert text.count(squeezed(HOSTILE[:60])) >= 10
    svg = ElementTree.fromstring((tmp_path / "figures" / "hostile.svg").read_bytes())
    assert svg.find("{*}title").text == HOSTILE


def test_what_cannot_be_printed_is_left_out(tmp_path):
    assert printable("a\x00b\x1bc\ue000d\ud800 8.9 % of 1 %") == "abcd 8.9\u00a0% of 1\u00a0%"
    write(replace(study(NOTHING), title="a\x07b\ue000", equivalent=()), tmp_path)
    assert "<h1>ab</h1>" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_a_ragged_table_and_a_strange_file_name_are_refused():
    with pytest.raises(ValueError, match="2 columns"):
        Table(("a", "b"), (("1",),), "t", "ll")
    with pytest.raises(ValueError, match="small letters"):
        Figure("../x", b"", "", "")
    twice = Chapter("t", (further().blocks[2],))
    with pytest.raises(ValueError, match="Two figures"):
        write(replace(study(NOTHING), chapters=(twice, twice)), Path("."))
