"""The same answer, however it is asked: trace.json to the last bit, whatever the order of what is declared, and on how many threads or processes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rig
from threadpoolctl import threadpool_limits

from workbench.campaign import Campaign, load
from workbench.inverse.dynamics import inverse_dynamics
from workbench.study.traced import run
from workbench.tracing.result import Trace
from workbench.tracing.tracing import trace


@pytest.fixture(scope="module")
def campaign(tmp_path_factory) -> Campaign:
    """Two effects are missing, so that the search takes turns; it closes a loop, and has two records for validation."""
    folder = tmp_path_factory.mktemp("campaign")
    rig.campaign(folder, 44, ("cogging", "stribeck_friction"), 2.0, short=True)
    loaded = load(folder)
    limits = replace(loaded.plant.limits, drive=3.0, speed=30.0)
    again = [replace(r, name="val_again") for r in loaded.records if r.role == "validation"]
    return replace(loaded, plant=replace(loaded.plant, limits=limits), records=(*loaded.records, *again))


@pytest.fixture(scope="module")
def first(campaign, tmp_path_factory) -> tuple[Trace, bytes]:
    """The trace on one process, and all that it wrote."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("WORKBENCH_PROCESSES", "1")
        return traced(campaign, tmp_path_factory.mktemp("out"))


@pytest.fixture(scope="module")
def written(first) -> bytes:
    return first[1]


def traced(campaign: Campaign, folder: Path) -> tuple[Trace, bytes]:
    """Return a trace, and trace.json with every prediction as written."""
    _, found = run(campaign, folder / "out")
    assert sorted(found.added) == ["cogging", "stribeck_friction"]
    files = [folder / "out" / "trace.json", *sorted((folder / "out" / "predictions").iterdir())]
    return found, b"".join(f.read_bytes() for f in files)


def test_neither_the_order_of_effects_and_records_nor_the_number_of_threads_and_processes_shows_in_any_bit(
    campaign, written, tmp_path, monkeypatch
):
    monkeypatch.setenv("WORKBENCH_PROCESSES", "3")
    plant = replace(campaign.plant, effects=campaign.plant.effects[::-1])
    with threadpool_limits(limits=4, user_api="blas"):
        assert np.dot(np.ones(9), np.ones(9)) == 9.0  # the pool of threads is there
        assert traced(replace(campaign, plant=plant, records=campaign.records[::-1]), tmp_path)[1] == written


def test_what_is_tried_and_in_which_order_does_not_depend_on_the_validation_records(campaign, first):
    """A record of another motion and another drive in their place: the search stays, and its answer is not borne out."""
    rng = np.random.default_rng(1)

    def other(r):
        drive = r.drive[::-1] * 2.0 + 0.3 * rng.standard_normal(r.drive.size)
        return replace(r, channels={**r.channels, "torque": drive}) if r.role == "validation" else r

    one, two = (
        first[0],
        trace(campaign.plant, inverse_dynamics(tuple(map(other, campaign.records)), campaign.bandwidth)),
    )
    assert one.steps == two.steps and one.smallest == two.smallest
    assert one.before.identification == two.before.identification
    assert one.added and not two.added
