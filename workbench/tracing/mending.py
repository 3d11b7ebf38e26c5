"""What an encoder lost is put back before anything is asked: its shifts are no law of motion, and every effect would dress them."""

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.encoders.lost_counts import LostCounts, lost_counts
from workbench.finding import Finding
from workbench.identification.fit import identify
from workbench.identification.result import Fit
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.wording_search import put_back


@dataclass(frozen=True, eq=False)
class Mended:
    """lost: what was put back. inverses: over the records with it. before, after: fits of the declared plant without and with it."""

    lost: LostCounts
    inverses: Sequence[InverseDynamics]
    before: Fit
    after: Fit

    @property
    def size(self) -> float:
        """What putting it back takes away, over the drive's rms, on identification."""
        return max(self.before.identification**2 - self.after.identification**2, 0.0) ** 0.5

    @property
    def finding(self) -> Finding:
        """What is said of it, with the errors of the declared model before and after."""
        role = VALIDATION if VALIDATION in self.before.rms else IDENTIFICATION
        before, after = (100 * getattr(fit, role) for fit in (self.before, self.after))
        return put_back(self.lost, role, before, after, self.size)


def mended(plant: Plant, inverses: Sequence[InverseDynamics], least: float) -> Mended | None:
    """Return the records with the counts put back that an encoder lost, None where none did or it is worth less than `least`.

    least: share of the drive's rms.
    """
    lost = lost_counts([p.motion.record for p in inverses])
    if lost is None:
        return None
    whole = inverse_dynamics([lost.mended(p.motion.record) for p in inverses], inverses[0].motion.filter.bandwidth)
    found = Mended(lost, whole, identify(plant, inverses), identify(plant, whole))
    return found if found.size >= least else None
