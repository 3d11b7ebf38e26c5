"""The sentence on what a notch buys has the numbers of both searches."""

import numpy as np

from workbench.design.optimise import Tuned
from workbench.design.tries import Trail
from workbench.report.notch import as_table, notch_sentence


def tuned(time, error, value):
    trail = Trail(np.array([1.0, time]), np.array([1.0, error]), np.array([True, True]), np.array([value + 1.0, value]))
    return Tuned(None, np.ones(1), value, 2, 1, trail)


def test_the_sentence_sets_what_is_had_with_a_notch_against_what_is_had_without():
    ours, bare = {"fixed PD": tuned(0.15, 7.8e-4, 1.9)}, {"fixed PD": tuned(0.149, 1.22e-3, 2.0)}
    said = notch_sentence(ours, bare, "rad").replace("\u00a0", " ")
    assert "fixed PD leaves 780 µrad over the grid instead of 1.22 mrad after 150 ms instead of 149 ms" in said
    assert "5.0 % of the cost" in said
    assert [(r["notch"], r["cost"]) for r in as_table(ours, bare)] == [(True, 1.9), (False, 2.0)]


def test_a_notch_that_costs_more_than_it_buys_is_said_to():
    said = notch_sentence({"PI cascade": tuned(0.15, 5e-6, 1.02)}, {"PI cascade": tuned(0.15, 5e-6, 1.0)}, "rad")
    assert "\u22122.0" in said
