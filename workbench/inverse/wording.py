"""What is said of a required drive: a joint that carries nothing, the state that a record starts in, zeros that lie apart."""

from collections.abc import Sequence

import numpy as np

from workbench.finding import CARRIES_NOTHING, Finding
from workbench.inverse.carrying import idle_error
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.record import Record


def idle(inverses: Sequence[InverseDynamics], plant: Plant) -> Finding | None:
    """Return the finding that a fitted plant's joint carries nothing on the identification records, None where it carries."""
    error = idle_error(inverses, plant)
    if error is None:
        return None
    left = f"leaves {100 * error:.0f} % of the load's balance" if np.isfinite(error) else "has no torque"
    return Finding(
        CARRIES_NOTHING, "joint",
        f"The fit lets the joint carry nothing: its law at the measured angle {left}. What the load does then says nothing of "
        f"the joint, and no cause can be told from these balances.",
        {"error": error},
        "Check the clocks of the two encoders and the zero of one against the other in each record (the check says both); "
        "else declare the load's inertia as fixed, or record a motion with more torque through the joint.",
    )  # fmt: skip


def zeros_apart(records: Sequence[Record], displacement: str) -> list[Finding]:
    """Say by how much the zeros of two encoders lie apart."""
    free = {r.name: r.zero for r in sorted(records, key=lambda r: r.name) if r.zero is not None}
    if not free:
        return []
    sentence = (
        f"Between the two encoders lie {_told(free, displacement)}: zeros of their own, or a load that hangs. It was taken "
        "off, and what the joint carries in the mean is what the load's balance asks for."
    )
    remedy = "set both encoders to zero with the joint relaxed, and record again"
    return [Finding("zeros apart", "load_position", sentence, free, remedy)]


def state_at_start(records: Sequence[Record], displacement: str) -> list[Finding]:
    """Say from what displacement each record was found to start."""
    found = {r.name: r.found for r in sorted(records, key=lambda r: r.name) if r.found}
    if not found:
        return []
    sentence = (
        "The campaign does not promise that its records start with friction relaxed; friction with memory was found to start as after a "
        f"displacement of {_told(found, displacement)}."
    )
    remedy = "say in initial_condition that friction is relaxed, if it is, or start records after a full stroke"
    return [Finding("state at the start", "position", sentence, found, remedy)]


def _told(of_records: dict[str, float], displacement: str) -> str:
    return ", ".join(f"{x:.3g} {displacement} in '{name}'" for name, x in of_records.items())
