"""What a found effect is worth to each controller, by the rule that comparisons have, and numbers of texts that are those in use."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from workbench.report import control
from workbench.task.task import PHASES
from workbench.verification.compare import LEVEL, Comparison, Row

ROW = Row("fixed PD", 0.0, 0.1, 0.05, 0.0, 1e-5, 2.0, 0.2, 1.0, 0.0)
MORE, LESS = ({k: 1.0 + s * 1.1 * level for k, level in LEVEL.items()} for s in (1, -1))
TASK = SimpleNamespace(
    plant=SimpleNamespace(displacement="rad", effort="N*m", rotary=True),
    criteria=SimpleNamespace(counts=2.0, hold=0.01),
)


@pytest.mark.parametrize(
    ("time", "error", "word"),
    [
        (1.0, 1.0, "equal"), (LESS["time"], 1.0, "better"), (1.0, LESS["error"], "better"), (MORE["time"], 1.0, "worse"),
        (LESS["time"], MORE["error"], "mixed"), (1.0, float("nan"), "worse"),
    ],
)  # fmt: skip
def test_a_controller_is_better_or_worse_by_the_levels_of_every_comparison(time, error, word):
    now = replace(ROW, time_1pct=time * ROW.time_1pct, final_error=error * ROW.final_error)
    chapter = control.worth_chapter(Comparison((ROW,), ()), Comparison((now,), ()), "Stribeck friction", TASK)
    assert getattr(chapter.blocks[1].rows[0][-1], "text", chapter.blocks[1].rows[0][-1]) == word


def test_the_caption_of_a_comparison_says_how_many_phases_were_run():
    chapter = control.comparison_chapter(Comparison((ROW,), ()), TASK)
    assert f"The worst of {PHASES} encoder phases" in chapter.blocks[1].caption
