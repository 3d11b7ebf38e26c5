"""The page of a trace: where the residual lives, in figures with axes, units, a legend and the finding in their titles."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from report_example import records, study, trace

from workbench.cli import main
from workbench.errors import WorkbenchError
from workbench.inverse.dynamics import inverse_dynamics
from workbench.report import cause, residual_figures, write
from workbench.report.chapters import standard
from workbench.report.contents import Figure, Heading, Items, Table
from workbench.report.residual_figures import Shade
from workbench.report.residual_maps import where_it_lives
from workbench.residual.residual_maps import as_list, map_residual
from workbench.residual.window import BACKWARD, EITHER, FORWARD
from workbench.study import traced
from workbench.tracing.output import as_dict
from workbench.tracing.result import NOTHING, UNKNOWN


@pytest.fixture(scope="module")
def inverses():
    return inverse_dynamics(records(), 60.0)


@pytest.fixture(scope="module")
def found(inverses):
    return mapped(inverses, trace())


def mapped(inverses, found):
    return map_residual(inverses, found.before, found.extended)


def chapter(found):
    explained = SimpleNamespace(unknown=False, located={}, causes=())
    return where_it_lives(SimpleNamespace(residual_maps=found, trace=explained))


def figures(found) -> dict[str, Figure]:
    return {b.name: b for b in chapter(found).blocks if isinstance(b, Figure)}


def test_what_the_residual_follows_is_said_with_what_is_left_of_it(found):
    first = next(b for b in chapter(found).blocks if isinstance(b, Items)).texts[0]
    share = re.match(
        r"Velocity and the way of motion explain (\d+)\u00a0% of the residual's power, and ([\d.]+)\u00a0% of", first
    )
    assert share and float(share[1]) > 50 and float(share[2]) < 10
    assert figures(found)["where_torque_motion"].alt.count("Velocity and the way of motion explain") == 1
    assert "Velocity and the way of motion explain" in figures(found)["where_torque_motion"].svg().decode()


def test_axes_have_names_and_units_and_models_a_legend(found):
    for name, labels in {
        "where_torque_place": ("position (rad)", "place in a turn (rad)"),
        "where_torque_motion": ("velocity (rad/s)", "distance since reversal (rad)", "load (mN\u00b7m)"),
        "where_torque_time": ("time (s)", "sweep_slow", "orbit", "rms (mN\u00b7m)"),
        "where_torque_spectra": ("frequency (Hz)", "order (1/rad)", "amplitude (mN\u00b7m)"),
    }.items():
        svg = figures(found)[name].svg().decode()
        for label in (*labels, "declared model", "extended model"):
            assert label in svg, (name, label)


def test_of_a_model_with_nothing_missing_there_is_one_curve(inverses):
    found = mapped(inverses, trace(NOTHING))
    assert found[0].after is None
    assert "extended model" not in figures(found)["where_torque_time"].svg().decode()
    table = next(b for b in chapter(found).blocks if isinstance(b, Table))
    assert [row[0] for row in table.rows] == ["backward", "at rest", "forward"]
    assert len(table.columns) == 4


def test_the_title_over_time_is_a_finding(found, inverses):
    said = figures(found)["where_torque_time"].alt
    assert re.search(r"is [\d.]+ to [\d.]+ times smaller with the extended model|times larger between", said)
    assert re.search(
        r"is [\d.]+ to [\d.]+ mN·m rms|times larger", figures(mapped(inverses, trace(NOTHING)))["where_torque_time"].alt
    )


def test_places_of_both_models_are_plain_numbers(found):
    rows = as_list(found)
    assert {r["model"] for r in rows} == {"declared", "extended"}
    for r in rows:
        assert r["low"] < r["high"] and 0 <= r["share"] <= 1 and r["sentence"].startswith("the residual")


def test_the_page_of_a_trace_has_its_own_name_and_its_chapters_once(found, tmp_path):
    result = replace(study(), residual_maps=found, kind="Trace of campaign")
    titles = [c.title for c in standard(result)]
    assert titles.count("Where the residual lives") == 1 and len(set(titles)) == len(titles)
    write(result, tmp_path, "trace")
    assert {"trace.html", "trace.pdf", "figures"} == {p.name for p in tmp_path.iterdir()}
    assert "Trace of campaign bench_axis" in (tmp_path / "trace.html").read_text(encoding="utf-8")


# --- what no effect explains --------------------------------------------------------------------------------------------


def unexplained(inverses, found, **place):
    """A page whose trace leaves something unknown at such a place."""
    result = study(UNKNOWN)
    known = {
        "share": 0.61,
        "size": 0.031,
        "times_calm": 3.1,
        "times_calm_outside": 1.1,
        "direction": "either direction",
    } | place
    return replace(result, trace=replace(result.trace, unknown=known), residual_maps=mapped(inverses, result.trace))


@pytest.mark.parametrize(
    ("place", "figure", "title", "shaded"),
    [
        (
            {"coordinate": "position", "spans": [[0.1, 0.4]], "direction": "forward"},
            "where_torque_place",
            "lives between 100 and 400 mrad, moving forward",
            1,  # of both ways of motion
        ),
        ({"coordinate": "velocity", "spans": [[1.0, 2.0]]}, "where_torque_motion", "between 1.00 and 2.00 rad/s", 2),
        ({"coordinate": "time", "spans": [[1.0, 1.1], [3.0, 3.1]]}, "where_torque_time", "lives at 2 moments", 6),
    ],
)
def test_where_something_unknown_lives_is_said_shaded_and_the_title_of_its_figure(
    inverses, found, monkeypatch, place, figure, title, shaded
):
    result = unexplained(inverses, found, **place)
    drawn = []
    shading = residual_figures.shaded
    monkeypatch.setattr(residual_figures, "shaded", lambda a, spans, *f: (drawn.extend(spans), shading(a, spans, *f)))
    chapter = next(c for c in standard(result) if c.title == "Where the residual lives")
    assert isinstance(chapter.blocks[0], Heading) and chapter.blocks[0].text == "Where it lives"
    for block in (b for b in chapter.blocks if isinstance(b, Figure)):
        svg = block.svg().decode()
        assert (residual_figures.LIVES in svg) == (block.name == figure)
        if block.name == figure:
            assert (
                re.sub(r"\s+", " ", re.search("<title>(.*?)</title>", svg, re.DOTALL)[1])
                .replace("\u00a0", " ")
                .find(title)
                > 0
            )
    assert len(drawn) == shaded


def test_speeds_are_shaded_on_both_sides_of_zero():
    speeds = Shade("velocity", ((1.0, 2.0),), EITHER, "")
    assert speeds.over("velocity", FORWARD) == ((1.0, 2.0),) and speeds.over("velocity", BACKWARD) == ((-2.0, -1.0),)
    assert replace(speeds, direction=FORWARD).over("velocity", BACKWARD) == () == speeds.over("position", FORWARD)


def test_the_unit_of_an_unknown_place_is_told(inverses, found):
    result = unexplained(inverses, found, coordinate="velocity", spans=[[1.0, 2.0]])
    assert as_dict(result.trace, {})["unknown"]["unit"] == "rad/s"
    assert "unit" not in as_dict(replace(result.trace, unknown={"coordinate": "none", "size": 0.025}), {})["unknown"]


def test_a_folder_that_is_not_ours_is_refused_before_anything_long_starts(tmp_path, monkeypatch):
    (tmp_path / "notes.txt").write_text("mine", encoding="utf-8")
    campaign = SimpleNamespace(records=(), bandwidth=60.0, plant=None)
    monkeypatch.setattr(traced, "trace", lambda *_: pytest.fail("the records were looked at"))
    for out in (tmp_path, tmp_path / "notes.txt"):
        with pytest.raises(WorkbenchError, match="name a"):
            traced.run(campaign, out)
    assert [p.name for p in tmp_path.iterdir()] == ["notes.txt"]


def test_a_campaign_is_never_replaced_by_its_trace(tmp_path):
    for name in ("campaign.toml", "trace.json"):
        (tmp_path / name).write_text("mine", encoding="utf-8")
    with pytest.raises(WorkbenchError, match="a campaign is not replaced"):
        traced.run(SimpleNamespace(records=(), bandwidth=60.0, plant=None), tmp_path)
    assert (tmp_path / "campaign.toml").read_text(encoding="utf-8") == "mine"


def test_a_file_in_place_of_a_campaigns_folder_is_answered_with_what_to_name(tmp_path, capsys):
    (tmp_path / "campaign.toml").write_text("", encoding="utf-8")
    assert main(["trace", str(tmp_path / "campaign.toml"), "--out", str(tmp_path / "out")]) == 2
    assert "is a file; name the folder that holds campaign.toml" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_map_into_which_no_sample_falls_has_no_part_in_the_prefix_of_the_others():
    def maps(*rms):
        return SimpleNamespace(
            unit="N*m", before=SimpleNamespace(maps=[SimpleNamespace(coordinate="q", rms=np.array(r)) for r in rms])
        )

    none, some = [np.nan, np.nan], [0.002, np.nan]
    assert residual_figures._prefix(maps(none, some)) == residual_figures._prefix(maps(some))
    assert residual_figures._prefix(maps(none)) == residual_figures._prefix(maps([0.0]))


def test_no_line_is_drawn_across_a_part_where_no_sample_falls():
    """Of a turn an axis may visit two ends; a bin or two that are empty break nothing."""
    seen = np.ones(60, bool)
    seen[[3, 4]] = seen[20:45] = False
    x, y = residual_figures._where_seen(seen, np.arange(60.0), np.full(60, 2.0))
    assert np.flatnonzero(np.isnan(x)).tolist() == np.flatnonzero(np.isnan(y)).tolist() == [18]
    assert (x[17], x[19]) == (19.0, 45.0) and x.size == np.count_nonzero(seen) + 1


def test_a_step_added_what_bears_its_name_once():
    """A composite was added under its part's name, and a later step tried that part itself, which was not added."""
    score = lambda effect, gain: SimpleNamespace(  # noqa: E731
        effect=effect, at="axis", title=effect, gain=gain, scatter=0.01, earns=True
    )
    steps = [[score("backlash", 0.8)], [score("stribeck_friction", 0.9)], [score("stribeck_friction", 0.07)]]
    causes = [SimpleNamespace(effect=n, at="axis") for n in ("backlash", "stribeck_friction")]
    (items,) = cause._later(SimpleNamespace(trace=SimpleNamespace(steps=steps, causes=causes)))
    ends = [text.rpartition("), ")[2] for text in items.texts]
    assert ends == ["was added.", "was not added, and the search ended."]
