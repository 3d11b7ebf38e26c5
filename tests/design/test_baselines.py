"""Baselines: where their searches begin, and which seeds they take."""

from types import SimpleNamespace

import numpy as np
import pytest

from workbench.design import baselines
from workbench.design.families.family import pd_family
from workbench.design.families.linear import Linear
from workbench.plant import Limits
from workbench.simulation import Loop

LOOP = Loop(2.5e-4, 1, 2.5e-4, 2.5e-4, 1e-6)
TASK = SimpleNamespace(plant=SimpleNamespace(limits=Limits(2.0, 5.0)), loop=LOOP, step=0.1)
AXIS = Linear(LOOP, 0.01, 0.1, np.array([0.0, 20.0]), None)
GAINS = SimpleNamespace(
    amplitude=np.array([1e-4, 1e-3, 1e-2]), kp=np.array([90.0, 60.0, 30.0]), kd=np.array([1.2, 1.0, 0.8])
)


def test_searches_begin_at_the_pd_of_a_hundredth_of_the_step_and_brake_within_the_drive():
    begin = baselines.starts_of(GAINS, 0.01, Limits(drive=2.0, speed=5.0), 0.12)
    assert begin.pd == (60.0, 1.0) and begin.cascade == pytest.approx((60.0, 1.0, 6.0))
    assert begin.profile == pytest.approx((60.0, 1.0, 6.0, 0.65 * 2.0 / 0.01)) and begin.speed < 5.0


def test_a_family_begins_alike_with_a_notch_and_without():
    makers = [lambda judge: pd_family(judge, (60.0, 1.0))]
    (notched,), (bare,) = (baselines.shaped_alike(makers, AXIS, LOOP.sample_time, notch=n) for n in (True, False))
    assert notched.numbers == (*bare.numbers, "notch", "notch depth")
    assert notched.start[: bare.start.size].tolist() == bare.start.tolist()


def test_half_of_the_tables_seeds_tune_baselines_and_one_without_a_notch_follows_the_best(monkeypatch):
    asked = []

    def searched(searches):
        asked.append([(f.name, len(f.numbers), seed) for _, f, seed in searches])
        return tuple(SimpleNamespace(family=f, seed=seed, value=abs(seed - 8)) for _, f, seed in searches)

    monkeypatch.setattr(baselines, "optimise_all", searched)
    said = []
    with_notch, without = baselines.tuned_baselines(TASK, AXIS, GAINS, (7, 8, 9, 10), said.append)
    assert [seed for *_, seed in asked[0]] == [7] * 3 + [8] * 3 and [seed for *_, seed in asked[1]] == [8] * 3
    assert [n for name, n, _ in asked[1]] == [n - 2 for name, n, _ in asked[0][:3]]
    assert with_notch.keys() == without.keys() and len(said) == 1


@pytest.mark.parametrize("seeds", [(7,), (7, 8)])
def test_from_one_seed_all_baselines_are_searched_side_by_side(monkeypatch, seeds):
    asked = []

    def searched(searches):
        asked.append([(f.name, seed) for _, f, seed in searches])
        return tuple(SimpleNamespace(family=f, seed=seed, value=1.0, numbers=f.numbers) for _, f, seed in searches)

    monkeypatch.setattr(baselines, "optimise_all", searched)
    with_notch, without = baselines.tuned_baselines(TASK, AXIS, GAINS, seeds, lambda _: None)
    assert len(asked) == 1 and [seed for _, seed in asked[0]] == [7] * 6
    assert all(len(with_notch[n].numbers) == len(without[n].numbers) + 2 for n in with_notch)
