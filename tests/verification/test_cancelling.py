"""The trace's closing with compensation of the named causes beside gains tuned anew."""

import json
from dataclasses import replace

import numpy as np
import pytest
from report_example import trace as example
from test_closing import plant, record

from workbench.cancellation.closed import Cancelled, causes, take
from workbench.definition import find
from workbench.report.closed_loop import closed_loop as chapter_of
from workbench.report.contents import Paragraph, Table
from workbench.verification.closed_loop import as_dict, close

GOOD = {"rise": 0.1, "time_1pct": 0.1, "overshoot": 0.0, "final_error": 1e-5, "following": 1e-4}


@pytest.fixture(scope="module")
def wavy():
    """An axis with a cogging that nobody declared."""
    return close(plant(), plant() + find("cogging")(s1=0.15, order=6.0), record())


def test_cancelling_a_cogging_takes_its_error_away_and_half_of_it_does_not(wavy):
    found = wavy.cancelled
    assert found.effects == ("cogging@axis",) and not found.left
    assert found.exact["final_error"] <= wavy.tuned_on_declared.final_error
    assert found.exact["following"] < found.worst["following"]
    assert np.isfinite(list(found.exact.values())).all()


def test_it_is_said_on_the_page_and_in_the_file(wavy):
    held = as_dict(wavy)["compensation"]
    assert [f["gain"] for f in held["figures"]] == [1.0, 0.7, 1.3] and held["take"] in (
        "compensation",
        "gains",
        "both alike",
        "neither",
    )
    assert json.loads(json.dumps(held, allow_nan=False))["effects"] == ["cogging@axis"]
    trace = example()
    blocks = chapter_of(replace(trace, after=replace(trace.after, plant=plant())), wavy).blocks
    tables = [b for b in blocks if isinstance(b, Table) and "Compensation of cogging" in b.caption]
    assert len(tables) == 1 and len(tables[0].rows) == 5
    assert any(isinstance(b, Paragraph) and "gains" in b.text for b in blocks)


def test_what_no_drive_cancels_is_left(wavy):
    late = plant() + find("transport_delay")(delay=1e-3)
    assert causes(plant(), late) == ((), ("transport_delay@command",))
    assert causes(plant(), plant() + find("cogging")) == (("cogging@axis",), ())


def test_advice_asks_that_it_lasts_where_the_effect_is_off():
    bad = GOOD | {"time_1pct": 0.3, "final_error": 1e-3}
    lasting = Cancelled(("a",), (), dict.fromkeys((1.0, 0.7, 1.3), GOOD))
    fragile = Cancelled(("a",), (), {1.0: GOOD, 0.7: bad, 1.3: bad | {"overshoot": 0.2}})
    assert take(bad, bad, lasting) == "compensation"
    assert take(bad, GOOD, fragile) == "gains"
    assert take(bad, GOOD, lasting) == "both alike"
    assert take(bad, bad, fragile) == "neither"
