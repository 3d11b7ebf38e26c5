"""Where the rows of a design begin: each body at rest at the start, every memory empty."""

import numpy as np

from workbench.control.law import Controller
from workbench.errors import WorkbenchError
from workbench.kernel import arrays
from workbench.simulation.bodies import LAST
from workbench.simulation.design import Design, Piece
from workbench.simulation.sampled import followed
from workbench.simulation.scenario import ScenarioArrays

REST = 60  # fixed-point steps to the motor's position at rest, at most: a step that moves no bit of it is the last
NEVER = -2.0  # k_settled before anything is settled; -1 is the sample before the first


def evaluated(piece: Piece, values: dict) -> tuple:
    """Return what a piece takes from constants; WorkbenchError where it is not a number."""
    result = arrays.evaluate(piece.before, [values[n] for n in piece.constants])[0]
    for value in result:
        if np.isnan(value).any():
            raise WorkbenchError(
                "the plant's or the controller's numbers combine to something that is not a number: look for "
                "a parameter that is zero where another is divided by it."
            )
    return tuple(result)


def _at(made: Piece, values: dict, rows: dict):
    """Return name -> value of a piece at these rows; rows that are not named are zero."""
    return _after(made, evaluated(made, values), rows)


def _after(made: Piece, constants: tuple, rows: dict):
    """Return what `_at` does, of a piece whose constants have been evaluated."""
    given = [rows.get(n, 0.0) for n in made.rows]
    return dict(zip(made.outputs, arrays.evaluate(made.after, given, constants)[0], strict=True))


def at_rest(made: Design, values: dict, scenarios: ScenarioArrays) -> dict:
    """Return row -> position and speed of each body, where the loop begins: at the start, with the joint not wound up.

    The motor stands where the gear's error leaves no deflection; its slope is well below one, so fixed-point steps do.
    """
    if made.joint is None:
        return {"q": scenarios.start, "v": scenarios.speed}
    rows = {"q": scenarios.start, "load.q": scenarios.start}
    constants = evaluated(made.joint, values)
    for _ in range(REST):
        x = _after(made.joint, constants, rows)[LAST]
        before, rows["q"] = rows["q"], rows["q"] - x
        if np.array_equal(before, rows["q"]):
            break
    if not np.max(np.abs(x)) < 1e-9:
        raise WorkbenchError(
            "the joint has no deflection of zero near a scenario's start: the slope of its angle maps is too large."
        )
    return rows | {LAST: _after(made.joint, constants, rows)[LAST], "v": scenarios.speed, "load.v": scenarios.speed}


def per_mass(made: Design, values: dict, rest: dict, scenarios: ScenarioArrays) -> dict:
    """Return one over each body's mass at the start, zero for a load that is held; WorkbenchError where it is not positive."""
    found = {}
    for name, mass in _at(made.mass, values, rest).items():
        load = name == "load.mass"
        if not (np.min(mass) > 0.0):
            body = "load" if load else "plant" if made.joint is None else "motor"
            raise WorkbenchError(
                f"the mass of the {body} is {np.min(mass):g} in at least one scenario; it must be positive: "
                "set the effect 'inertia', or the scenario's load_inertia."
            )
        free = 1.0 - scenarios.locked if load else 1.0
        value = free / mass
        found[f"{name.removesuffix('mass')}per_mass"] = np.float64(value) if np.ndim(value) == 0 else value
    return found


def initial(made: Design, controller: Controller | None, values: dict, scenarios: ScenarioArrays, rest: dict) -> dict:
    """Return row -> value at the start: every memory empty, the reading that of the start position."""
    first = _at(made.start, values, rest)
    y, turned = first["y"], followed(made.law, first)
    rows = rest | {
        **first,
        "furthest": turned,
        "turned": turned,
        "share": 1.0,
        "k_outside": -1.0,
        "k_astray": -1.0,
        "k_settled": NEVER,
        "peak": scenarios.start * values["step_sign"],
    }
    if controller is not None and controller.law.start is not None:
        rows |= {f"law.{n}": v for n, v in controller.law.start(values["target"], y).items()}
    return rows
