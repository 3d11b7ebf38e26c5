"""The direction of motion that friction reads: a stop operator, where no friction with memory gives it.

Friction never reads sign(v): its direction turns over a small distance, and stays what it was where the axis stands.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache

import casadi as ca

from workbench.definition import FORCE, Effect, namespace
from workbench.effects.elementary import clip
from workbench.parameter import Parameter

DIRECTION = "direction"  # the effect that gives `dir` where the plant has no hysteresis
CONTACT = "contact"  # state of a direction of one's own


def _stop(s, z, p):
    """The step of `stop_direction`: one function whatever the width, under which its program is kept."""
    x = clip(z.x + s.dq, -p.width, p.width)
    return {"x": x}, ca.SX(0), {"dir": x / p.width}


@lru_cache(maxsize=64)
def stop_direction(width: float) -> Effect:
    """`dir` where a port has no hysteresis of its own: a stop operator that saturates after `width`, without force."""
    return Effect(
        name=DIRECTION,
        cause="direction of motion",
        formula="x <- clip(x + dq, -w, w), dir = x/w",
        source="stop operator, Krasnosel'skii and Pokrovskii 1989",
        port=FORCE,
        parameters={"width": Parameter(width, "x", "two encoder counts", lower=1e-15, fixed=True)},
        states={"x": 1},
        reads=("dq",),
        provides=("dir",),
        step=_stop,
        places=("axis", "motor", "load", "joint"),
    )


def in_parallel(forces: Sequence[Effect], width: float) -> list[Effect]:
    """Return the forces of one place, those that read `dir` alone with a contact of their own beside friction with memory.

    A second friction that followed the hysteresis' direction would be the same force once more. What is declared beside it
    is another contact, a seal beside the bearings: its direction is a stop operator that saturates after `width`.
    """
    own = {e.key for e in beside_memory(forces)}
    return [_of_its_own(e, width) if e.key in own else e for e in forces]


def beside_memory(forces: list[Effect]) -> list[Effect]:
    """Return the forces of one place that read `dir` alone and stand beside friction with memory: contacts of their own."""
    memory = any(e.linear and "dir" in e.provides for e in forces)
    return [e for e in forces if memory and e.reads == ("dir",)]


def _of_its_own(effect: Effect, width: float) -> Effect:
    """Return a force that reads `dir` alone as one that reads the motion, by a stop operator of this width."""
    return replace(
        effect,
        parameters={**effect.parameters, "width": Parameter(width, "x", "two encoder counts", lower=1e-15, fixed=True)},
        states={CONTACT: 1},
        reads=("dq",),
        step=_contact(effect.step),
    )


@lru_cache(maxsize=16)
def _contact(step: Callable) -> Callable:
    """The step of a force on its own direction: one function a step, under which its columns are kept."""

    def own(s, z, p):
        x = clip(z.contact + s.dq, -p.width, p.width)
        _, output = step(namespace(dir=x / p.width), z, p)
        return {CONTACT: x}, output

    return own
