"""A rig of its own: servo axes simulated at 20 kHz, that writes campaigns whose answer is known.

Nothing here comes from the workbench: friction with memory is a stack of turning points on the exact virgin curve (the
workbench has a bank of stops), motion is integrated in time (the workbench reads torque off motion), and every effect is
written a second time. `campaign` writes one folder and returns what the declared model lacks; `runs` and `bring` make one
of a machine and motions of one's own.
"""

from rig.bases import ONE_MASS, TWO_MASS, based, plain, servo
from rig.campaign import BAND, COUNT, LEVEL, ROLES, Measuring, bring, campaign, runs
from rig.effects import EFFECTS
from rig.kernel import LIMIT, PER_CONTROL, RATE, Axis, masing, simulate
from rig.machine import Machine, run
from rig.motions import RECORDS, Motion, following

__all__ = [
    "BAND", "COUNT", "EFFECTS", "LEVEL", "LIMIT", "ONE_MASS", "PER_CONTROL", "RATE", "RECORDS", "ROLES", "TWO_MASS", "Axis", "Machine",
    "Measuring", "Motion", "based", "bring", "campaign", "following", "masing", "plain", "run", "runs", "servo", "simulate",
]  # fmt: skip
