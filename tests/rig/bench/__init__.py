"""Benches as another author would build them: stages, gimbals, strain-wave axes, two masses; laws that are no catalogue's.

A simulator beside rig's older one, and apart from the workbench as that is: 40 kHz, SI, contacts as bristles that slip at
their own break-away distances, drives and encoders that report what they report, and forces on the body that no channel
knows. `campaign` writes one folder and returns its truth; `drawn` says which are drawn for a seed.
"""

from rig.bench.campaign import campaign
from rig.bench.causes import CAUSES, OUTSIDE
from rig.bench.draw import Spec, drawn

__all__ = ["CAUSES", "OUTSIDE", "Spec", "campaign", "drawn"]
