"""Families: classes of causes that share a coordinate, of which the law is a second question; and each one's free-form law.

A family is judged as a whole: which of its laws is at work is asked only after. Its free-form law bounds what any of them
could take.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.definition import Effect
from workbench.effects import curves, free_bank, free_maps
from workbench.errors import WorkbenchError

LEAST = (
    0.002  # share of the samples between two knots: with half of it a level rests on noise, with twice a peak is lost
)


@dataclass(frozen=True)
class FreeForm:
    """make(knots, declared, at) -> Effect, `at` where it may always be. signal: the family's coordinate, as effects read it; its size alone where `size`.

    spacing, count: of the knots, for `knots_of`. "log" where laws change by factors (a Stribeck velocity may lie anywhere over
    three decades), "even" where they change by distance. Of twelve knots over speed, what is left of a law is at most 3 % of
    Stribeck's or a film's and 15 % of a quadratic one; of six, 20 % and 53 %; of 24, 1 % and 3 %, at twice the time and with
    levels that 40 s of record no longer tell apart. A drive that gives a quarter of what it is asked for beyond a knee leaves 6.3 % of
    five knots over the command, and 2.4 % of nine, with which a damper of dry friction behind a gap (BRFD) is a drive that saturates. nearest: traced law whose name a curve of the class bears that is no wave and no formula.
    """

    make: Callable[[Sequence[float], Sequence[Effect], str], Effect]
    signal: str
    size: bool
    spacing: str
    count: int
    at: str = "axis"
    nearest: str = ""


def _command(knots, declared, at):
    return free_maps.drive_over_command(knots, at)


def _creep(knots, declared, at):
    return free_maps.creep_spectrum(knots, at)


def _angle(knots, declared, at):
    return free_maps.angle_over_angle(knots[0], at=at)


FREE_FORMS: dict[str, FreeForm] = {
    "friction over speed": FreeForm(curves.friction_over_speed, "v", True, "log", 12),
    "friction with memory": FreeForm(free_bank.bank_beside, "dq", True, "log", 12),
    "friction over time": FreeForm(curves.friction_over_time, "t", False, "even", 8),
    "friction over load": FreeForm(curves.friction_over_load, "tau", True, "even", 6),
    "friction over position": FreeForm(curves.friction_over_position, "q", False, "even", 16),
    "force over position": FreeForm(curves.force_over_position, "q", False, "even", 24, nearest="cable_spring"),
    "force over time": FreeForm(curves.force_over_time, "t", False, "even", 16),
    "joint stiffness": FreeForm(curves.force_over_position, "q", False, "even", 13),
    "angle over angle": FreeForm(_angle, "motor_q", False, "order", 1, "joint"),
    "drive over command": FreeForm(_command, "u", True, "even", 5, "command"),
    "creep": FreeForm(_creep, "dt", False, "log", 8),
}
WITHOUT = (
    "time",
    "reading over time",
    "inertia",
    "mode",
)  # families whose law is one: a delay, a drift, a mass, a resonance
FAMILIES = (*FREE_FORMS, *WITHOUT)
OF_THE_JOINT = {"force over position": "joint stiffness"}  # the joint's position is its deflection


def family_of(effect: Effect) -> str:
    """Return the family of an effect where it stands."""
    return family_at(effect, effect.at)


def family_at(effect: Effect, place: str) -> str:
    """Return the family that an effect has at a place: a spring is the joint's stiffness there, a force over position elsewhere."""
    if place == "joint":
        return OF_THE_JOINT.get(effect.family, effect.family)
    return {j: f for f, j in OF_THE_JOINT.items()}.get(effect.family, effect.family)


def knots_of(values: Sequence[np.ndarray], form: FreeForm, least: float = 0.0) -> tuple[float, ...]:
    """Return knots over what records cover of a coordinate: between any two at least LEAST of all samples, the ends always.

    values: of each record (n,), SI, in which errors count. least: the smallest first knot of a logarithmic spacing, beside a
    thousandth of the largest value. Empty where the coordinate does not vary, or fewer than three knots are left.
    """
    x = np.concatenate([np.asarray(v, dtype=float) for v in values]) if len(values) else np.zeros(0)
    x = np.sort(np.abs(x) if form.size else x)
    if form.spacing not in ("log", "even"):
        raise WorkbenchError(f"knots are spaced 'log' or 'even'; '{form.spacing}' comes from no coordinate's samples.")
    if not x.size or not x[-1] > x[0]:
        return ()
    if form.spacing == "log":
        wanted = np.geomspace(min(max(least, 1e-3 * x[-1]), 0.5 * x[-1]), x[-1], form.count)
    else:
        first = x[-1] / form.count if form.size else x[0]
        wanted = np.linspace(first, x[-1], form.count)
    enough, below = LEAST * x.size, np.searchsorted(x, wanted, side="right")
    kept = [0]
    for i in range(1, form.count):
        if below[i] - below[kept[-1]] >= enough:
            kept.append(i)
    if kept[-1] != form.count - 1:
        kept[-1 if len(kept) > 1 else 1 :] = [form.count - 1]
    return tuple(float(wanted[i]) for i in kept) if len(kept) > 2 else ()
