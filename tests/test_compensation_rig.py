"""Compensation of identified effects on a machine that shares no code with the package: the rig's slow ramp, both ways.

What the machine's own cascade still has to do against an effect, beside what is added, is compared with how well the fit
predicts the drive on a record that it was not fitted to.
"""

from dataclasses import replace

import numpy as np
import pytest
from rig import bases, motions
from rig.campaign import Measuring, Missing, campaign
from rig.kernel import PER_CONTROL
from rig.machine import run
from rig.motions import CONTROL, Motion

RAMP = 0.15  # rad/s
TURNED = 3.0  # s each way
"""
"""
