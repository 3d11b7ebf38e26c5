"""Page 1 says what was found, how much of what could be is explained, and which controller to take; nothing is said twice."""

import ast
import json
import tomllib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from report_example import study

from workbench.finding import Finding
from workbench.report import write
from workbench.report.advice import advice_of, headline, worth_in_short
from workbench.report.chapters import standard, texts
from workbench.report.compiling import LEAST, emptiest
from workbench.report.contents import BAD, GOOD, Callout, Chapter, Check, Figure, Items, Paragraph, Table
from workbench.report.drawing import svg
from workbench.report.explained import explained
from workbench.report.index import write_index
from workbench.report.opening import _uncertain, records
from workbench.report.required import in_words, judged
from workbench.report.wording import bound, named, typeset
from workbench.tracing.evidence import Evidence, Explainable
from workbench.tracing.result import Cause

ROOT = Path(__file__).resolve().parents[2]


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
        "after 100\u00a0ms at most and ends 70.0\u00a0µrad off at most. Fixed PD, the next best, takes 10\u00a0% longer and ends 115 "
        "times as far off (110\u00a0ms, 8.05\u00a0mrad)."
    ).replace("1\u00a0% of", "1 % of")


def test_the_advice_says_a_small_margin_in_per_cent_and_what_speaks_for_the_other_with_a_but():
    text = headline(advised(row("first", 0.1, 7.05e-6), row("second", 0.11, 6.0e-6)))
    assert "Second, the next best, takes 10\u00a0% longer but ends 15\u00a0% nearer (" in text
    text = headline(advised(row("first", 0.1, 7.05e-6), row("second", 0.1, 6.0e-6)))
    assert "takes as long and ends 15\u00a0% nearer" in text


def test_what_the_effect_is_worth_is_said_where_a_controller_never_comes_to_rest():
    rows = [{"controller": "a", "final_error": e, "time_1pct": t} for e, t in ((8e-3, 0.2), (1.9, float("inf")))]
    said = worth_in_short({"comparison": rows[:1], "comparison_tuned_on_declared": rows[1:]}, "rad")
    assert said.endswith("within 1 % after 200\u00a0ms; without, 1.90\u00a0rad off, never within 1 %.")


def test_what_an_effect_is_worth_is_called_the_searchs_own_doing_where_it_is_little():
    def told(time: float, error: float) -> str:
        knowing, blind = (
            {"controller": "a", "final_error": e, "time_1pct": t} for e, t in ((error, time), (240e-6, 0.1457))
        )
        return worth_in_short({"comparison": [knowing], "comparison_tuned_on_declared": [blind]}, "rad")

    assert told(0.1425, 224e-6).endswith("So little may be the search's doing.")
    assert "search" not in told(0.1425, 120e-6) and "search" not in told(0.1, 224e-6)


def test_two_orders_of_one_wave_are_told_from_their_rival_once():
    disc = SimpleNamespace(title="encoder eccentricity", rivals=("kinematic_error",))
    late = SimpleNamespace(title="transport delay", rivals=("actuator_lag",))
    alone = SimpleNamespace(title="cogging", rivals=())
    (said,) = _uncertain(SimpleNamespace(trace=SimpleNamespace(causes=(disc, disc, late, alone))))
    assert said.text.count("encoder eccentricity from kinematic error") == 1
    assert "transport delay from actuator lag" in said.text and "cogging" not in said.text


def test_a_column_of_motions_that_nobody_named_is_left_out():
    plain = study()
    table = records(replace(plain, records=tuple(replace(r, motion="") for r in plain.records))).blocks[-1]
    assert "motion" not in table.columns and len(table.columns) == len(table.alignment) == len(table.rows[0])
    assert "motion" in records(plain).blocks[-1].columns


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


def test_what_only_dresses_what_is_missing_explains_nothing_of_it():
    """An eccentric disc took 92 % of an arm's inertia that changes, and is in no model of the page."""
    (block,) = explained(evidence(0.4, 0.02), 0.01, gains=False, stands=False)
    assert block.text.startswith("Explained is nothing of what could be explained") and block.tone is BAD
    assert "What was tried would take 95\u00a0% of that, but does not stand" in block.text
    assert "do not rely on this model" in block.text
    (alone,) = explained(evidence(0.4, 0.4), 0.01, gains=False, stands=False)
    assert "What was tried" not in alone.text


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
    assert (
        in_words("limit_cycle_wrong_fixed_pd")
        == "cases in which harmonic balance is wrong about a limit cycle under fixed PD"
    )
    failed = Check("sensitivity peak", 2.1, "1", "<= 2", False, in_words("sensitivity_peak"))
    assert "largest peak of the sensitivity over all amplitudes" in judged((failed, failed))


def test_every_requirement_of_every_study_is_named_in_words():
    raw = {}
    for file in sorted(ROOT.glob("studies/*/study.toml")):
        declared = tomllib.loads(file.read_text(encoding="utf-8"))
        own = declared.get("words", {})
        raw[file.parent.name] = [n for n in declared.get("requirements", {}) if in_words(n, own) == n.replace("_", " ")]
    assert len(raw) >= 7 and not any(raw.values()), raw


def test_every_column_of_every_table_has_a_head():
    """Who hears a table knows a column by its head."""
    empty = []
    for file in (f for top in ("workbench", "studies") for f in sorted((ROOT / top).rglob("*.py"))):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            table = isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Table" and node.args
            heads = isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "columns"
            columns = node.args[0] if table else node.value if heads else None
            if isinstance(columns, ast.Tuple) and any(
                isinstance(c, ast.Constant) and c.value == "" for c in columns.elts
            ):
                empty.append(f"{file.name}:{node.lineno}")
    assert empty == []


def test_units_of_sentences_are_printed_as_those_of_tables():
    assert typeset("viscous_friction: +-0.3 N*m*s/rad, 2 kg*m^2") == "Viscous friction: ±0.3 N·m·s/rad, 2 kg·m²"
    assert (
        typeset("a correlation of -0.848, off by 4e-13 N*m and 1.13e+03")
        == "a correlation of −0.848, off by 400 × 10⁻¹⁵ N·m and 1130"
    )
    assert typeset("1-90 Hz on 2013-05-06, x^-2, Cortex-M4 at -O2") == "1-90 Hz on 2013-05-06, x^-2, Cortex-M4 at -O2"
    assert bound("<= 1e-05") == "≤ 10 × 10⁻⁶" and bound(">= 0.148 and <= 0.152") == "≥ 0.148 and ≤ 0.152"
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


def test_two_waves_of_one_cause_are_one_name_in_a_sentence():
    found = [
        Cause(name, "sensor.position", "", (), 0.5, 0.5) for name in ("encoder_eccentricity", "encoder_eccentricity")
    ]
    assert named(found) == "encoder eccentricity"
    assert named([*found, Cause("cogging", "axis", "", (), 0.5, 0.5)]) == "encoder eccentricity and cogging"
