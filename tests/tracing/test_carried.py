"""Campaigns of other authors, each answered wrongly once: what is missing is named first, and the error becomes that of the true structure."""

import json

import pytest

from benchmarks._trace_families import CARRIED
from workbench.campaign import load
from workbench.tracing.of_campaign import trace_campaign
from workbench.tracing.result import CAUSE, NOTHING, UNKNOWN

SLOW = ("kb12",)  # half a minute and more
TRUTH = json.loads((CARRIED / "truth.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", sorted({*TRUTH} - {*SLOW}))
def test_what_another_authors_campaign_lacks_is_named(name):
    missing, best = TRUTH[name]["missing"], TRUTH[name]["nrmse_true"]
    found = trace_campaign(load(CARRIED / name))
    if missing in ([], ["unknown"]):
        assert found.verdict == (UNKNOWN if missing else NOTHING) and found.added == ()
        return
    assert found.verdict == CAUSE and {*found.added} == {*missing}
    assert found.ranked[0].earns and found.ranked[0].gain == pytest.approx(max(c.gain for c in found.ranked), abs=0.1)
    declared = TRUTH[name]["nrmse_declared"]
    assert found.after.validation < declared - 0.75 * (declared - best)
