"""The controller's half of a study: from which amplitude on gains are tuned, and what is said where there are none."""

from math import inf, nan
from types import SimpleNamespace

import numpy as np
import pytest

from workbench.errors import WorkbenchError
from workbench.finding import NOT_TUNED
from workbench.plant import Limits, Plant
from workbench.report.gains import course, step_heading
from workbench.study import gains, tuned
from workbench.study.configuration import Requirement
from workbench.study.control import Control
from workbench.study.outcome import Outcome
from workbench.tuning import OutOfReach

FEASIBLE = 1e-3  # the lowest amplitude that allows any gains


def asked(raised: bool) -> Control:
    amplitudes = np.geomspace(1e-5, 1.0, 20)
    return Control(None, None, amplitudes, raised, 2, 0.02, "following", None, inf, None, None, (1,))


def test_a_lowest_amplitude_that_is_stated_is_not_raised(monkeypatch):
    def design(plant, amplitudes, *_, **__):
        raise OutOfReach("no gains keep the goal", FEASIBLE)

    monkeypatch.setattr(tuned, "design", design)
    with pytest.raises(OutOfReach):
        tuned.designed(None, asked(raised=False), None, print)


def outcome(kind: str, drive: float) -> Outcome:
    return Outcome(Plant(kind, (), limits=Limits(drive=drive)), "axis", 100.0, None, figures={"verdict": "cause"})


@pytest.mark.parametrize(
    ("kind", "drive", "said"),
    [
        ("one mass", inf, "actuator_limit"),
        ("one mass", 1.0, "sample faster"),
        ("two mass", 1.0, "two masses; `workbench trace`"),
    ],
)
def test_a_study_without_gains_says_why_and_keeps_the_rest(monkeypatch, kind, drive, said):
    def refused(*_):
        raise OutOfReach("no gains keep the goal; sample faster.", None)

    monkeypatch.setattr(gains, "run", refused)
    study = SimpleNamespace(requirements=(Requirement("verdict", equals="cause"),))
    (finding,) = gains.with_control(outcome(kind, drive), study, None, print).findings
    assert finding.kind == NOT_TUNED and said in finding.sentence
    needs = SimpleNamespace(requirements=(Requirement("sensitivity_peak", at_most=2.0),))
    with pytest.raises(WorkbenchError, match=said):
        gains.with_control(outcome(kind, drive), needs, None, print)


@pytest.mark.parametrize(
    ("times", "errors", "words"),
    [
        ((0.153, 0.156), (4.7e-6, 3.7e-3), ("153\u00a0ms to 156\u00a0ms", "4.70\u00a0µrad to 3.70\u00a0mrad is left")),
        ((0.153, 0.153), (4.7e-6, 4.7e-6), ("after 153\u00a0ms,", "4.70\u00a0µrad is left")),
        ((0.153, inf), (1e-6, nan), ("1 of 2 never", "not all come to rest")),
        ((inf, inf), (1.0, 1.0), ("None comes within 1 %",)),
    ],
)
def test_the_heading_of_the_steps_says_their_times_and_errors(times, errors, words):
    heading = step_heading(0.152, times, errors, "rad")
    assert all(w in heading for w in (*words, "bound is 152\u00a0ms"))


@pytest.mark.parametrize(
    ("gains", "said"),
    [
        ((5.0, 3.0, 1.0), "falls from 5"),
        ((1.0, 5.0, 2.0), "rises from 1"),
        ((1.0, 5.0, 2.0), "falls to 2"),
        ((1.0, 2.0), "to 2"),
    ],
)
def test_the_heading_of_the_gains_says_how_they_run_over_amplitude(gains, said):
    assert said in course(np.array(gains), "N*m/rad").replace("\u00a0", " ")
