"""What the verdict's sentence says."""

from types import SimpleNamespace

import pytest

from workbench.tracing.wording import verdict_sentence

BEFORE = SimpleNamespace(identification=0.75, validation=0.90)
AFTER = SimpleNamespace(identification=0.25, validation=0.33, plant=SimpleNamespace(effects=()))
GRAVITY = SimpleNamespace(effect="gravity", at="axis", kind="addition")


@pytest.mark.parametrize(
    ("floor", "said"),
    [(0.002, "(noise alone would leave 0.2 % or more)"), (0.0, ""), (5e-5, "")],
    ids=["seen", "none", "too little to tell"],
)
def test_a_floor_is_said_only_where_the_records_show_one(floor, said):
    evidence = SimpleNamespace(before=SimpleNamespace(size=0.0, kind=""), floor={"identification": floor})
    sentence = verdict_sentence("cause", (GRAVITY,), BEFORE, AFTER, evidence)
    assert sentence.endswith("75.00 % to 25.00 %" + (f" {said}." if said else "."))
