"""Page 1 says what was found, how much of what could be is explained, and which controller to take; nothing is said twice."""

import json
from dataclasses import replace

import pytest
from report_example import study

from workbench.finding import Finding
from workbench.report import write
from workbench.report.advice import advice_of, headline
from workbench.report.chapters import standard, texts
from workbench.report.compiling import LEAST, emptiest
from workbench.report.contents import BAD, GOOD, Callout, Chapter, Check, Figure, Items, Paragraph, Table
from workbench.report.drawing import svg
from workbench.report.explained import explained
from workbench.report.index import write_index
from workbench.report.required import in_words, judged
from workbench.report.wording import typeset
from workbench.tracing.evidence import Evidence, Explainable


def row(name: str, time: float, error: float, overshoot: float = 0.0) -> dict:
    return {"name": name, "time_grid": time, "error_grid": error, "overshoot_grid": overshoot}


def advised(*rows: dict, files=("gains/a.json", "gains/a.h")):
    return advice_of({"recommended": {"controller": rows[0]["name"], "candidates": list(rows)}}, files, "rad")


def evidence(before: float, after: float) -> Evidence:
    one = Evidence({"identification": 0.1}, {"identification": 0.01}, Explainable(before), Explainable(after))
    return one


def test_the_advice_names_controller_file_quality_and_margin():
    text = headline(advised(row("PI cascade", 0.1, 70e-6), row("fixed PD", 0.11, 8.05e-3), row("wild", 0.1, 1e-6, 0.3)))
    assert text == (
        "Take PI cascade (gains/a.h): over half to one and a half times inertia and friction, it is within 1\u00a0% of the target "
        "after 100\u00a0ms at most and ends 70.0\u00a0µrad off at most. Fixed PD, the next best, takes 1.1 times as long and ends 115 "
        "times as far off (110\u00a0ms, 8.05\u00a0mrad)."
    ).replace("1\u00a0% of", "1 % of")


def test_the_advice_says_where_two_are_as_good_and_where_none_keeps_what_was_asked():
    assert "Second, the next best, is as good." in headline(
        advised(row("first", 0.1, 1e-5), row("second", 0.1, 1.01e-5))
    )
    assert headline(advised(row("first", 0.1, 1e-5, 0.2))).startswith("No controller that was tuned keeps")
    assert advice_of({}, (), "rad") is None


@pytest.mark.parametrize(
    ("after", "said", "tone"), [(0.02, "95\u00a0%", None), (0.3, "25\u00a0%", BAD), (0.0, "100\u00a0%", None)]
)
def test_how_much_is_explained_is_said_and_a_caution_where_most_is_not(after, said, tone):
    (block,) = explained(evidence(0.4, after), 0.01, gains=True)
    assert block.text.startswith(f"Explained is {said} of what could be explained")
    assert isinstance(block, Callout) == (tone is BAD)
    assert ("do not rely on this model, which the gains below are built on" in block.text) == (tone is BAD)
    assert explained(evidence(0.004, 0.004), 0.01, gains=True) == ()  # there is next to nothing to explain


def result():
    plain = study()
    advice = advised(row("PI cascade", 0.1, 70e-6), row("fixed PD", 0.11, 8e-3))
    chapter = Chapter("More", (Paragraph("A chapter."), Items(("It is +-0.3 N*m.", "It is +-0.3 N*m.", "Another."))))
    again = Chapter("Again", (Paragraph("Its own."), Items(("It is +-0.3 N*m.", "New."))))
    findings = (
        *plain.findings,
        Finding("comparison", "gains", "Another."),
        Finding("assumed scale", "x", "A scale is assumed."),
    )
    trace = replace(plain.trace, evidence=evidence(0.4, 0.3))
    return replace(plain, trace=trace, advice=advice, chapters=(chapter, again), findings=findings, answer="So it is.")


def test_the_first_page_holds_all_that_is_needed_to_act_and_one_figure():
    first, *rest = standard(result())
    kinds = [type(b) for b in first.blocks]
    assert kinds.count(Figure) == 1 and Table not in kinds
    said = " ".join(texts([first]))
    for part in ("Stribeck friction is missing", "do not rely on", "Take PI cascade (gains/a.h)", "So it is.", "A scale is assumed.",
                 "1 of 3 requirements does not hold: time of the trace."):  # fmt: skip
        assert part in said
    assert next(b for b in first.blocks if isinstance(b, Callout) and "Take" in b.text).tone == GOOD
    assert "PI cascade" in first.blocks[kinds.index(Figure)].svg().decode()


def test_nothing_is_said_twice_and_every_chapter_begins_with_a_sentence():
    chapters = standard(result())
    said = texts(chapters)
    assert len(said) == len(set(said)) and "It is ±0.3 N·m." in said
    assert said.count("Another.") == 1
    assert [c.title for c in chapters if not isinstance(c.blocks[0], (Paragraph, Callout, Items))] == []


def test_the_last_table_is_all_that_makes_the_report_again():
    last = standard(replace(result(), command="workbench run studies/x", inputs="c" * 64, tuned="d" * 64))[-1].blocks[
        -1
    ]
    cells = {a.text: b.text for a, b in last.rows}
    assert cells["command"] == "workbench run studies/x"
    assert {"c" * 64, "d" * 64} <= set(cells.values()) and "typst 0.15.0" in cells["versions"]


def test_requirements_are_named_in_words():
    assert in_words("validation_error_after") == "error of the last model on the validation records"
    assert in_words("a3", {"a3": "what it is"}) == "what it is" and in_words("some_figure") == "some figure"
    failed = Check("sensitivity peak", 2.1, "1", "<= 2", False, in_words("sensitivity_peak"))
    assert "largest peak of the sensitivity over all amplitudes" in judged((failed, failed))


def test_units_of_sentences_are_printed_as_those_of_tables():
    assert typeset("viscous_friction: +-0.3 N*m*s/rad, 2 kg*m^2") == "Viscous friction: ±0.3 N·m·s/rad, 2 kg·m²"
    assert typeset("a*b and u = kp (r - y), 3 m/s") == "a*b and u = kp (r - y), 3 m/s"


def test_the_list_of_reports_has_every_study_with_its_headline(tmp_path):
    for name, title in (("b", "Second"), ("a", "First <i>")):
        (tmp_path / name).mkdir()
        checks = [{"name": "x", "words": "in words", "passed": name == "a"}]
        content = {"title": title, "sentence": f"Of {name}.", "advice": "Take it.", "checks": checks}
        (tmp_path / name / "results.json").write_text(json.dumps(content))
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "results.json").write_text("{")
    text = write_index(tmp_path).read_text()
    assert (
        text.index("First &lt;i&gt;")
        < text.index("Of a.")
        < text.index("Second")
        < text.index("Not reached: in words.")
    )
    assert "Take it." in text and "broken" not in text
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a", "b", "broken", "index.html"]


def test_a_page_of_paper_that_is_nearly_empty_is_seen():
    assert emptiest([(1, 700.0), (2, 100.0), (2, 160.0)]) < LEAST < emptiest([(1, 700.0), (3, 400.0)])


def test_figures_that_float_never_keep_a_report_from_being_written(tmp_path):
    draw = lambda: svg("A graph", lambda a: a[0].plot([0, 1], [0, 1]), height=3.0)  # noqa: E731
    blocks = [
        block
        for k in range(6)
        for block in (Items(tuple(f"{k}.{n}: " + "a sentence of some length " * 6 for n in range(7))),
                      Figure(f"graph_{k}", draw, "A graph.", "A line."))
    ]  # fmt: skip
    write(replace(study(), chapters=(Chapter("Lists and graphs", tuple(blocks)),)), tmp_path)
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")
