"""The sampled loop, in lanes: one generated kernel a plant and controller (docs/architecture/loop.md)."""

from workbench.simulation.closed import followed, open_loop, simulate
from workbench.simulation.criteria import Criteria
from workbench.simulation.metrics import Metrics, Trajectories
from workbench.simulation.scenario import Loop, Scenario, ScenarioArrays, loop_under

__all__ = [
    "Criteria",
    "Loop",
    "Metrics",
    "Scenario",
    "ScenarioArrays",
    "Trajectories",
    "followed",
    "loop_under",
    "open_loop",
    "simulate",
]
