"""The sampled loop, in lanes: one generated kernel a plant and controller (docs/architecture.md, section 7)."""

from workbench.simulate.closed import open_loop, simulate
from workbench.simulate.criteria import Criteria
from workbench.simulate.metrics import Metrics, Trajectories
from workbench.simulate.scenario import Loop, Scenario, ScenarioArrays

__all__ = ["Criteria", "Loop", "Metrics", "Scenario", "ScenarioArrays", "Trajectories", "open_loop", "simulate"]
