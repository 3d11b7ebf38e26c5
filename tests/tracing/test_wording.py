"""What the verdict's sentence says."""

from types import SimpleNamespace

import pytest

from workbench.tracing.headline import verdict_sentence
from workbench.tracing.result import Cause

BEFORE = SimpleNamespace(identification=0.75, validation=0.90)
AFTER = SimpleNamespace(identification=0.25, validation=0.33, plant=SimpleNamespace(effects=()))
GRAVITY = Cause("gravity", "axis", "", (), 0.9, 0.9)


@pytest.mark.parametrize(
    ("floor", "said"),
    [(0.002, "(noise alone would leave 0.2 % or more)"), (0.0, ""), (5e-5, "")],
    ids=["seen", "none", "too little to tell"],
)
def test_a_floor_is_said_only_where_the_records_show_one(floor, said):
    evidence = SimpleNamespace(before=SimpleNamespace(size=0.0, kind=""), floor={"identification": floor}, clock=False)
    sentence = verdict_sentence("cause", (GRAVITY,), BEFORE, AFTER, evidence)
    assert sentence.endswith("75.00 % to 25.00 %" + (f" {said}." if said else "."))


def test_what_a_refinement_takes_is_not_said_to_be_the_causes_own():
    evidence = SimpleNamespace(before=SimpleNamespace(size=0.0, kind=""), floor={"identification": 0.0}, clock=True)
    late = Cause("clock_skew", "sensor.load_position", "", (), 0.0, 0.0)
    same = SimpleNamespace(identification=0.75, validation=0.90, plant=SimpleNamespace(effects=()))
    sentence = verdict_sentence("cause", (late,), BEFORE, same, evidence, refined=AFTER)
    assert (
        "shows in the angle between the two encoders. With it, the validation error goes from 90.00 % to 90.00 %"
        in sentence
    )
    assert sentence.endswith("With the refinements, too, they are 33.00 % and 25.00 %.")
