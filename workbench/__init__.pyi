from workbench.campaign import load as load
from workbench.definition import effect as effect
from workbench.definition import find as find
from workbench.exporting import export as export
from workbench.front.fitting import check as check
from workbench.front.fitting import diff as diff
from workbench.front.fitting import identify as identify
from workbench.front.fitting import trace as trace
from workbench.front.loops import compensate as compensate
from workbench.front.loops import describe as describe
from workbench.front.loops import fit_schedule as fit_schedule
from workbench.front.loops import simulate as simulate
from workbench.front.loops import tune as tune
from workbench.front.motions import plan as plan
from workbench.front.motions import response as response
from workbench.front.motions import separate as separate
from workbench.parameter import Parameter as Parameter
from workbench.plant import Plant as Plant
from workbench.record import Record as Record
from workbench.simulation.closed import open_loop as open_loop
from workbench.simulation.scenario import Loop as Loop
from workbench.simulation.scenario import Scenario as Scenario
from workbench.tuning.goal import TuningGoal as TuningGoal

__version__: str
HELD: dict[str, str]
