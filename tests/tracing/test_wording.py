"""What the verdict's sentence says."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from workbench.tracing.criteria import Criteria
from workbench.tracing.decide import CAUSE, DRESSING, NOT_BORNE_OUT, NOTHING, REFINEMENT, UNKNOWN, Verdict, decide
from workbench.tracing.evidence import ADDITION, Evidence, Explainable, Weighed
from workbench.tracing.headline import verdict_sentence
from workbench.tracing.reporting import Outcome
from workbench.tracing.result import Cause
from workbench.tracing.wording import findings_of

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


def test_what_a_cause_takes_beside_refinements_alone_is_said_with_them():
    evidence = SimpleNamespace(before=SimpleNamespace(size=0.0, kind=""), floor={"identification": 0.0}, clock=False)
    worse = SimpleNamespace(identification=0.80, validation=0.95, plant=SimpleNamespace(effects=()))
    sentence = verdict_sentence("cause", (GRAVITY,), BEFORE, worse, evidence, refined=AFTER)
    assert sentence.endswith(
        "With it and the refinements, the validation error falls from 90.00 % to 33.00 % and the identification error "
        "from 75.00 % to 25.00 %."
    )


def test_where_nothing_is_missing_what_refinements_leave_is_said_beside_what_the_declared_model_does():
    size = SimpleNamespace(size=0.0, hum=0.0)
    evidence = SimpleNamespace(before=size, floor={"identification": 0.0}, clock=False)
    said = [verdict_sentence("nothing_missing", (), BEFORE, BEFORE, evidence, refined=x) for x in (None, AFTER)]
    assert "leaves 75.00 % of the drive on identification, and nothing of it" in said[0]
    assert "leaves 75.00 % of the drive on identification, with its refinements 25.00 %, and nothing of it" in said[1]


@pytest.mark.parametrize(
    ("verdict", "left", "stands"), [(NOTHING, 0.005, True), (NOTHING, 0.0229, False), (UNKNOWN, 0.005, False)]
)
def test_where_nothing_is_missing_a_refinement_that_validation_bears_out_stands(verdict, left, stands):
    fits = [SimpleNamespace(validation=x) for x in (0.0232, left)]
    of_drive, behind = (SimpleNamespace(behind=b, size=lambda role: 0.0194) for b in (False, True))
    # a bearing's friction behind a joint is in no drive
    for weighed, both in ((of_drive, stands), (behind, verdict == NOTHING)):
        confirmed = SimpleNamespace(added=["hysteresis"], weighed=[weighed], fits=fits)
        found = Outcome(None, (), None, confirmed, None, Verdict(verdict, (REFINEMENT,)), None, Criteria())
        assert found.standing == ([("hysteresis", weighed)] if both else [])


def test_without_a_validation_record_the_headline_says_so_and_gives_no_number_that_is_none():
    evidence = SimpleNamespace(before=SimpleNamespace(size=0.0, kind=""), floor={"identification": 0.001}, clock=False)
    before, after, refined = (
        SimpleNamespace(identification=x, validation=float("nan"), plant=AFTER.plant) for x in (0.0431, 0.0066, 0.006)
    )
    assert verdict_sentence("cause", (GRAVITY,), before, after, evidence, refined=refined) == (
        "Gravity is missing. With it, the identification error falls from 4.31 % to 0.66 % (noise alone would leave 0.1 % or more); "
        "no validation record bears it out. With the refinements, too, it is 0.60 %."
    )


@pytest.mark.parametrize(
    ("at", "begins"), [("axis", "A second cable spring at the axis"), ("load", "Cable spring at the load")]
)
def test_what_bears_a_cause_s_name_and_is_not_borne_out_is_said_to_be_a_second_one(at, begins):
    both = {"identification": 0.03, "validation": 0.04}
    stands = Weighed("cable_spring", "axis", ADDITION, {"identification": 0.09, "validation": 0.07}, both)
    out = Weighed("cable_spring", at, ADDITION, both, both)
    evidence = Evidence(stands.before, {"identification": 0.0}, Explainable(), Explainable(), (stands, out))
    verdict = Verdict(CAUSE, (CAUSE, NOT_BORNE_OUT), added=("cable_spring",))
    (found,) = findings_of(verdict, evidence, (), None, Criteria())
    assert found.sentence.startswith(f"{begins} explains 0 %")


def test_what_leaves_much_is_said_to_be_no_cause_for_what_stays_and_not_for_a_place():
    """A drive that folds its current back: what dresses it takes three quarters of validation, and lives nowhere in particular."""
    before, after = (dict.fromkeys(("identification", "validation"), x) for x in (0.06, 0.03))
    dresses = Weighed("cogging", "axis", ADDITION, before, after)
    evidence = Evidence(
        before, dict.fromkeys(before, 1e-3), Explainable(time=0.0419), Explainable(time=0.0212), (dresses,)
    )
    verdict = decide(evidence, Criteria())
    (found,) = findings_of(verdict, evidence, (), None, Criteria())
    assert (
        verdict.roles == (DRESSING,)
        and "explains 75 % of what validation leaves: 2.1 % of the drive's rms stays" in found.sentence
    )
    (there,) = findings_of(verdict, replace(evidence, after=Explainable(), place_instead=True), (), None, Criteria())
    assert "what lives in one place" in there.sentence
