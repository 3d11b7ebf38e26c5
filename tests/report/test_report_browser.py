"""The report in a real browser: everybody can read it at any width, its drawings can be explored, and it opens at once."""

from dataclasses import replace
from pathlib import Path

import pytest
from browser import opened, ran
from report_example import further, study

from workbench.report import write
from workbench.report.contents import Chapter, Paragraph
from workbench.report.index import write_index

AXE = (Path(__file__).parent / "axe" / "axe.min.js").read_text(encoding="utf-8")
LOOK = (
    AXE + ";const r = await axe.run(document, {resultTypes: ['violations']});"
    "return r.violations.map(v => [v.impact, v.id, v.nodes.map(n => n.target.join(' ')).slice(0, 3)]);"
)
WORD = "a" * 400


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("browser")
    result = study()
    long = Chapter("A long word", (Paragraph(WORD),))
    write(replace(result, question=WORD, chapters=(further(), long), name="one"), folder)
    return folder / "report.html"


@pytest.mark.parametrize(("width", "dark"), [(1400, False), (800, True), (400, False)])
def test_nothing_keeps_people_from_reading(page, tmp_path, width, dark):
    found = ran(page, LOOK, tmp_path, width, dark)
    assert [v for v in found if v[0] in ("moderate", "serious", "critical")] == []


def test_no_width_makes_the_page_wider_than_its_window(page, tmp_path):
    for width in (1400, 400):
        wide, type_ = ran(page, (
            "const text = document.querySelector('.drawing text');"
            "return [document.documentElement.scrollWidth, text.getBoundingClientRect().height];"
        ), tmp_path, width)  # fmt: skip
        assert wide <= width
        assert type_ >= 10.0  # pixels that a line of a drawing's type takes


EXPLORE = """
const place = [...document.querySelectorAll('.drawing')].find((d) => d.querySelector('[data-trace]'));
place.scrollIntoView(); place.focus();
place.dispatchEvent(new PointerEvent('pointerenter'));
const svg = place.querySelector('svg');
const known = JSON.parse(svg.dataset.graphs).plots[0];
const [x0, y0, x1, y1] = known.box;
const at = (x, y) => new DOMPoint(x, y).matrixTransform(svg.getScreenCTM());
const send = (kind, x, y) => { const p = at(x, y); svg.dispatchEvent(new PointerEvent(kind, { clientX: p.x, clientY: p.y, bubbles: true, pointerType: 'mouse' })); };
const said = () => place.parentNode.querySelector('.readout').textContent;
const labels = () => [...svg.querySelectorAll('.own text')].map((t) => t.textContent);
const out = { limits: known.x.limits };
send('pointermove', (x0 + x1) / 2, (y0 + y1) / 2);
out.middle = said();
const quarter = x0 + (x1 - x0) / 4, half = x0 + (x1 - x0) / 2;
send('pointerdown', quarter, y0 + 5); send('pointermove', half, y1 - 5); send('pointerup', half, y1 - 5);
send('pointermove', x0 + 0.5, (y0 + y1) / 2);
out.zoomed = said(); out.ticks = labels();
const buttons = [...place.parentNode.querySelectorAll('.tools button')];
buttons.find((b) => b.textContent === 'Whole').click();
out.whole = labels().length;
const one = buttons.find((b) => b.getAttribute('aria-pressed'));
one.click();
const traces = () => [...svg.querySelectorAll('[data-trace="0"]')].map((t) => getComputedStyle(t).display);
out.off = traces(); one.click(); out.on = traces();
place.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', bubbles: true })); out.keyed = said();
const selection = getSelection(); selection.selectAllChildren(svg.querySelector('text')); out.selected = selection.toString();
return out;
"""


def value(text: str) -> float:
    """Return the number after the first word of a readout such as "time 3.55 s · measured: −200"."""
    return float(text.split(" \u00b7 ")[0].split("\u00a0")[0].split(" ")[-1].replace("\u2212", "-"))


def test_a_drawing_zooms_reads_values_and_switches_traces(page, tmp_path):
    out = ran(page, EXPLORE, tmp_path)
    low, high = out["limits"]
    assert value(out["middle"]) == pytest.approx((low + high) / 2, rel=2e-3)
    assert "measured:" in out["middle"] and "declared model:" in out["middle"]
    assert value(out["zoomed"]) == pytest.approx(low + (high - low) / 4, rel=2e-3)
    assert len(out["ticks"]) >= 3 and out["whole"] == 0
    assert set(out["off"]) == {"none"} and "none" not in out["on"]
    assert out["keyed"] and out["selected"]


SORT = """
const table = [...document.querySelectorAll('table')].find((t) => t.tHead.textContent.includes('knot'));
const head = [...table.tHead.rows[0].cells].find((c) => c.textContent.includes('gain'));
const column = () => [...table.tBodies[0].rows].map((r) => Number(r.cells[1].textContent));
const button = head.querySelector('button');
button.click(); const up = column(); button.click();
return [up, column(), head.getAttribute('aria-sort')];
"""


def test_a_table_sorts_by_number(page, tmp_path):
    up, down, said = ran(page, SORT, tmp_path)
    assert up == sorted(up) and down == sorted(up, reverse=True) and said == "descending"
    assert len(up) == 60


def test_the_page_is_whole_without_its_script(page, tmp_path):
    whole = "return [document.querySelectorAll('.drawing svg').length, document.querySelectorAll('button').length];"
    assert ran(page, whole, tmp_path, scripts=False) == [6, 0]


def test_the_page_opens_at_once(page, tmp_path):
    blank = tmp_path / "blank.html"
    blank.write_text("<!doctype html><title>t</title>")
    opened(blank, tmp_path)  # the browser's own first start
    assert opened(page, tmp_path) - opened(blank, tmp_path) <= 1.0  # s of a processor, whatever else it does
    assert page.stat().st_size <= 3_000_000


def test_the_list_of_reports_can_be_read_by_all(page, tmp_path):
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / "results.json").write_text(
        '{"title": "A <b>", "sentence": "Nothing is missing.", "checks": []}'
    )
    index = write_index(tmp_path)
    assert "A &lt;b&gt;" in index.read_text() and "one/report.html" in index.read_text()
    assert [v for v in ran(index, LOOK, tmp_path) if v[0] in ("moderate", "serious", "critical")] == []
