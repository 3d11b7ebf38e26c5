"""A run that was stopped goes on from its finished steps, and comes to the same."""

import os
import threading
from pathlib import Path

import numpy as np
import pytest

from workbench import keeping
from workbench.control import law_named
from workbench.definition import catalogue
from workbench.processes import shared


class Killed(BaseException):
    """Stands for a process that is killed: nothing catches it."""


def program(done: list, stop_before: int = 99):
    """A run of seven steps, some within another one; `done` gets those that are taken to their end."""
    begun = []

    def step(name, make):
        def counted():
            if len(begun) == stop_before:
                raise Killed
            begun.append(name)
            made = make()
            done.append(name)
            return made

        return keeping.step(name, counted)

    a = step("a", lambda: np.arange(3.0))
    b = step("outer", lambda: [step("inner", lambda k=k: k * a) for k in range(3)])
    draws = [step("draws", lambda k=k: k + b[k].sum()) for k in range(2)]
    return float(sum(draws) + sum(x.sum() for x in b))


def test_a_run_stopped_before_any_step_takes_none_of_the_finished_ones_again(tmp_path):
    whole = []
    expected = program(whole)
    assert sorted(whole) == ["a", "draws", "draws", "inner", "inner", "inner", "outer"]
    for stop in range(7):
        first, again = [], []
        with pytest.raises(Killed), keeping.keeping(tmp_path / "steps", "digest"):
            program(first, stop)
        with keeping.keeping(tmp_path / "steps", "digest") as keeper:
            assert program(again) == expected
        assert keeper.known == len(first) and sorted(first + again) == sorted(whole)
        assert not (tmp_path / "steps").exists()  # the outputs are there


def test_steps_of_other_inputs_are_not_taken_and_go(tmp_path):
    with pytest.raises(Killed), keeping.keeping(tmp_path, "before"):
        program([], 3)
    again = []
    with pytest.raises(Killed), keeping.keeping(tmp_path, "after") as keeper:
        program(again, 6)
    assert keeper.known == 0 and len(again) == 6 and [p.name for p in tmp_path.iterdir()] == ["after"]


@pytest.mark.parametrize("content", [b"", b"\x80", b"no pickle", b"cnone\nthere\n."])
def test_a_step_that_is_broken_is_taken_again(tmp_path, content):
    with pytest.raises(Killed), keeping.keeping(tmp_path, "digest"):
        program([], 2)
    for file in tmp_path.glob("*/*.step"):
        file.write_bytes(content)
    again = []
    with keeping.keeping(tmp_path, "digest"):
        program(again)
    assert len(again) == 7


def test_what_cannot_be_kept_is_computed_and_a_folder_that_cannot_be_written_is_no_fault(tmp_path):
    (tmp_path / "file").write_text("")
    for place in (tmp_path / "steps", tmp_path / "file" / "below"):
        with keeping.keeping(place, "digest"):
            assert keeping.step("lock", threading.Lock).acquire(False)


def test_forks_and_threads_count_no_steps(tmp_path, monkeypatch):
    monkeypatch.setenv("WORKBENCH_PROCESSES", "2")
    with pytest.raises(Killed), keeping.keeping(tmp_path, "digest"):
        assert list(shared(lambda k: keeping.step("within", lambda: k), range(4))) == list(range(4))
        keeping.step("own", os.getpid)
        raise Killed
    names = {p.name.split("-")[-1] for p in tmp_path.glob("*/*.step")}
    assert names <= {"own.step", "within.step"} and (tmp_path / "digest" / "0-own.step").exists()


def test_effects_and_laws_are_those_of_the_catalogue_again(tmp_path):
    known = list(catalogue().values())
    file = Path(tmp_path / "x.step")
    keeping.write(file, (known, law_named("fixed_pd"), known[0](at=known[0].places[-1], label="b")))
    found, (effects, fixed, labelled) = keeping.read(file)
    assert found and all(a.step is b.step and a == b for a, b in zip(effects, known, strict=True))
    assert fixed is law_named("fixed_pd") and labelled == known[0](at=known[0].places[-1], label="b")


@pytest.fixture
def study(tmp_path):
    """A study of a short campaign, traced with few candidates, whose own steps are counted."""
    import fuzz

    folder = tmp_path / "studies" / "axis"
    bench = fuzz.made(tmp_path / "bench")
    import shutil

    shutil.copytree(bench.place / "campaign", folder / "campaign")
    (folder / "study.toml").write_text('title = "t"\ncampaign = "campaign"\n')
    (folder / "study.py").write_text(STEPS)
    return folder


STEPS = """import os, signal
from workbench.campaign import load
from workbench.inverse.dynamics import inverse_dynamics
from workbench.keeping import step
from workbench.study.outcome import Outcome
from workbench.tracing.tracing import trace


def run(study, say):
    campaign = load(study.campaign)
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    say("tracing")
    found = trace(campaign.plant, inverses, most=1, only=("transport_delay",))
    say("drawing")
    step("draws", lambda: None)
    say("after")
    return Outcome(campaign.plant, campaign.title, campaign.bandwidth, found, campaign.records, figures=found.figures)
"""


def test_a_study_that_was_killed_goes_on_and_writes_the_same_bytes(study, monkeypatch):
    from workbench.study.running import run
    from workbench.tracing import tracing

    selected = []
    select = tracing.select
    monkeypatch.setattr(tracing, "select", lambda *a, **k: selected.append(1) or select(*a, **k))

    def killed(what):
        if what == "after":
            raise Killed

    with pytest.raises(Killed):
        run(str(study), study.parent / "one", killed)
    assert len(selected) == 1 and list((study / ".steps").rglob("*trace.step"))
    said = []
    run(str(study), study.parent / "one", said.append)
    assert len(selected) == 1 and said[0] == "going on from 2 finished steps of a run that was stopped"
    assert not (study / ".steps").exists()
    run(str(study), study.parent / "two")
    assert len(selected) == 2
    names = sorted(p.relative_to(study.parent / "one") for p in (study.parent / "one").rglob("*") if p.is_file())
    assert {p.name for p in names} >= {"report.html", "report.pdf", "results.json", "trace.json"}
    assert [
        n for n in names if (study.parent / "one" / n).read_bytes() != (study.parent / "two" / n).read_bytes()
    ] == []


def test_a_place_for_the_outputs_that_will_not_do_is_said_before_anything_is_computed(study):
    from workbench.errors import WorkbenchError
    from workbench.study.running import run

    (study.parent / "mine").mkdir()
    (study.parent / "mine" / "thesis.txt").write_text("years")
    with pytest.raises(WorkbenchError, match="did not write"):
        run(str(study), study.parent / "mine", lambda what: pytest.fail(f"it computed: {what}"))


def test_steps_made_side_by_side_are_each_kept_and_none_is_made_again(tmp_path):
    def made(item: int) -> tuple[int, int]:
        return item**2, os.getpid()

    def broken(item: int) -> tuple[int, int]:
        if item == 3:
            raise ValueError("stopped here")
        return made(item)

    with pytest.raises(ValueError), keeping.keeping(tmp_path, "digest"):
        list(keeping.steps("squares", broken, range(5)))
    known = {p.name: p.read_bytes() for p in tmp_path.glob("*/*.step")}
    assert {"0-squares.step", "1-squares.step", "2-squares.step"} <= set(known)
    with keeping.keeping(tmp_path, "digest") as keeper:
        both = [list(keeping.steps("squares", made, range(n))) for n in (5, 2)]
        assert [[n for n, _ in one] for one in both] == [[0, 1, 4, 9, 16], [0, 1]]
        assert keeper.known == len(known) and keeper.count == 7
        assert known.items() <= {p.name: p.read_bytes() for p in tmp_path.glob("*/*.step")}.items()
    assert [n for n, _ in keeping.steps("squares", made, range(3))] == [0, 1, 4]
