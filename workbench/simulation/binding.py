"""Numbers put to a design: which vary over lanes, where each row starts, and how long the loop runs."""

from dataclasses import dataclass, replace

import numpy as np

from workbench import definition as fx
from workbench.control.law import JOINT, Controller
from workbench.control.table import stacked
from workbench.errors import WorkbenchError, nearest
from workbench.kernel import arrays
from workbench.plant import ONE_MASS, Plant
from workbench.simulation import noise
from workbench.simulation.bodies import LAST, SOFT
from workbench.simulation.criteria import Criteria
from workbench.simulation.design import Design, Piece, design
from workbench.simulation.dynamics import constants_of
from workbench.simulation.given import REFERENCE, Given, given_of
from workbench.simulation.sampled import Sensing, followed
from workbench.simulation.scenario import Loop, ScenarioArrays

BACK = 2.5  # encoder counts: three back are a reversal; between counts, so that no rounding decides
REST = 60  # fixed-point steps to the motor's position at rest
NEVER = -2.0  # k_settled before anything is settled; -1 is the sample before the first


@dataclass(frozen=True, eq=False)
class Bound:
    """A design with its numbers.

    frontier: for each piece, the values (scalar or (lanes,)) that it takes from constants. initial: row -> value.
    strength: noise over noise.SIGMA. delays: whole substeps. rows_of_tables, base: tables, and first row of each lane's.
    given: signals over time.
    """

    design: Design
    loop: Loop
    scenarios: ScenarioArrays
    frontier: tuple[tuple, ...]
    initial: dict[str, np.ndarray | float]
    delays: np.ndarray
    strength: np.ndarray
    table: np.ndarray
    base: np.ndarray
    grid: tuple[int, int]
    given: Given
    samples: int
    window_from: int

    @property
    def lanes(self) -> int:
        return self.scenarios.lanes


def _evaluated(piece: Piece, values: dict) -> tuple:
    """Return what a piece takes from constants; WorkbenchError where it is not a number."""
    result = arrays.evaluate(piece.before, [values[n] for n in piece.constants])[0]
    for value in result:
        if np.isnan(value).any():
            raise WorkbenchError(
                "the plant's or the controller's numbers combine to something that is not a number: look for "
                "a parameter that is zero where another is divided by it."
            )
    return tuple(result)


def samples_of(duration: float, loop: Loop) -> int:
    """Return the number of samples in `duration` seconds."""
    if not (np.isfinite(duration) and duration > 0.0):
        raise WorkbenchError(f"the simulation's duration is {duration:g} s; it must be positive.")
    return max(int(round(duration / loop.sample_time)), 1)


def _delays_of(plant: Plant, loop: Loop, scenarios: ScenarioArrays) -> np.ndarray:
    """Return the delay of the command in whole substeps, scalar or (lanes,): the loop's, the plant's, the scenario's."""
    total = loop.delay + scenarios.delay
    for e in plant.effects:
        if e.port == fx.TIME and e.at == "command":
            if e.reads or "delay" not in e.parameters:
                raise WorkbenchError(f"effect '{e.name}' is a delay that changes with time; it cannot be simulated.")
            total = total + e.parameters["delay"].value
    return np.floor(total / loop.substep + 0.5).astype(np.int64)


def _factors(scenarios: ScenarioArrays) -> dict:
    """Scenario fields as constants of the design."""
    names = ("target", "inertia", "friction", "load", "phase", "load_inertia", "locked")
    return {n: getattr(scenarios, n)[()] for n in names}


def _limits(plant: Plant, loop: Loop) -> dict[str, float]:
    """Constants of the loop and the drive."""
    return {
        "limit": plant.limits.drive,
        "speed_slope": 1.0 / (SOFT * plant.limits.speed),
        "sample_time": loop.sample_time,
        "sample_rate": 1.0 / loop.sample_time,
        "h": loop.substep,
        "smoothing": loop.smoothing,
        "count": loop.count,
        "position.count": loop.resolution,
        "load_position.count": loop.load_resolution,
    }


def _smoothing_of(controller: Controller, lanes: int, loop: Loop) -> np.ndarray:
    """Return the share of a new difference that a controller's own velocity filter takes, scalar or (lanes,)."""
    time = np.asarray(controller.velocity_filter, dtype=float)
    if time.ndim and time.shape != (lanes,):
        raise WorkbenchError(
            f"controller '{controller.name}': velocity_filter has shape {time.shape}; one value or one for each of the "
            f"{lanes} lanes is needed."
        )
    return np.where(time > 0.0, -np.expm1(-loop.sample_time / np.maximum(time, 1e-12)), 1.0)[()]


def _of_controller(controller: Controller, lanes: int, loop: Loop) -> dict:
    """Constants of the law, of its velocity filter and of its table's ends."""
    missing = set(controller.law.parameters) - set(controller.parameters)
    if missing:
        raise WorkbenchError(f"controller '{controller.name}': {sorted(missing)[0]} is not given.")
    values = {}
    for name, value in controller.parameters.items():
        if name not in controller.law.parameters:
            raise WorkbenchError(
                f"controller '{controller.name}': unknown parameter '{name}'; {nearest(name, controller.law.parameters)}"
            )
        value = np.asarray(value, dtype=float)
        if value.ndim and value.shape != (lanes,):
            raise WorkbenchError(
                f"controller '{controller.name}': {name} has shape {value.shape}; one value or one for each of the "
                f"{lanes} lanes is needed."
            )
        values[f"law.{name}"] = value[()]
    if controller.velocity_filter is not None:
        values["smoothing"] = _smoothing_of(controller, lanes, loop)
    if controller.tables:
        knots = controller.tables[0].knots
        values |= {"knot.first": knots[0], "knot.last": knots[-1]}
    return values


def _tables_of(controller: Controller | None, lanes: int):
    """Return (rows, first row of each lane's table, (shift, offset))."""
    if controller is None or not controller.tables:
        return np.zeros((1, 2)), np.zeros(lanes, dtype=np.int64), (0, 0)
    which = np.zeros(lanes, dtype=np.int64) if controller.table is None else controller.table
    if which.shape != (lanes,):
        raise WorkbenchError(
            f"controller '{controller.name}': one table number for each of the {lanes} lanes is needed."
        )
    shift, offset, knots = controller.tables[0].grid
    return stacked(controller.tables), which * knots, (shift, offset)


def bind(plant, loop: Loop, controller: Controller | None, scenarios: ScenarioArrays, samples: int, criteria: Criteria,
         aim=None, given: Given | None = None) -> Bound:  # fmt: skip
    """Return a design for `plant` (or one plant a lane) with its numbers. aim: what the band is about; the target."""
    plants = [plant] if isinstance(plant, Plant) else list(plant)
    lanes = scenarios.lanes
    given = given_of({}, samples, lanes) if given is None else given
    if given.has(REFERENCE):
        scenarios = replace(scenarios, target=given.last(REFERENCE))
    if len(plants) not in (1, lanes):
        raise WorkbenchError(f"{len(plants)} plants for {lanes} scenarios: give one plant, or one for each.")
    if controller and controller.law.both and plants[0].kind == ONE_MASS:
        raise WorkbenchError(
            f"the law '{controller.law.name}' asks for two encoders, but a plant of {ONE_MASS} has 'position' alone."
        )
    sensing, noisy = _sensing_of(plants[0], loop, scenarios), bool((scenarios.noise > 0.0).any())
    made = design(plants[0], controller.law if controller else None, sensing, noisy=noisy, given=given.structure)
    widths = _widths_of(loop)
    each = [constants_of(p, made.symbols, widths) for p in plants]
    alike = [p.kind == plants[0].kind and p.limits == plants[0].limits for p in plants]
    if not all(alike) or any(e.keys() != each[0].keys() for e in each):
        raise WorkbenchError("plants of one run must have the same effects and limits, and differ in values alone.")
    values = each[0] if len(each) == 1 else {n: _joined([e[n] for e in each]) for n in each[0]}
    values = values | _factors(scenarios) | _limits(plants[0], loop) | criteria.constants(loop)
    values |= _of_controller(controller, lanes, loop) if controller else {}
    back = BACK * (max(loop.resolution, loop.load_resolution) if made.law and made.law.follows == JOINT else loop.count)
    back = controller.reversal if controller and controller.reversal is not None else back
    step = scenarios.target - scenarios.start
    aim = values["target"] if aim is None else aim
    values |= {
        "back": back,
        "aim": aim,
        "band": criteria.band * np.abs(aim - scenarios.start),
        "step_sign": np.sign(step) + 0.0,
    }
    rest = _at_rest(made, values, scenarios)
    values |= _per_mass(made, values, rest, scenarios)
    table, base, grid = _tables_of(controller, lanes)
    delays = _delays_of(plants[0], loop, scenarios)
    window = max(int(round(criteria.window / loop.sample_time)), 1)
    return Bound(
        design=made,
        loop=loop,
        scenarios=scenarios,
        frontier=tuple(_evaluated(p, values) for p in made.pieces),
        initial=_initial(made, controller, values, scenarios, rest),
        delays=delays,
        strength=np.broadcast_to(scenarios.noise / noise.SIGMA, (lanes,)),
        table=table,
        base=base,
        grid=grid,
        given=given,
        samples=samples,
        window_from=max(samples - window, 0),
    )


def _sensing_of(plant: Plant, loop: Loop, scenarios: ScenarioArrays) -> Sensing:
    """Return what is read of a plant; WorkbenchError where the loop or a scenario asks for a load that is not there."""
    if plant.kind == ONE_MASS and loop.feedback != "position":
        raise WorkbenchError(
            f"the loop's feedback is '{loop.feedback}', but a plant of {ONE_MASS} has 'position' alone."
        )
    if plant.kind == ONE_MASS and (scenarios.locked != 0.0).any():
        raise WorkbenchError(f"a scenario's load is locked, but a plant of {ONE_MASS} has no load of its own.")
    counts = {"position": loop.resolution, "load_position": loop.load_resolution}
    return Sensing(plant.kind, loop.feedback, tuple(n for n, count in counts.items() if count > 0.0))


def _widths_of(loop: Loop) -> dict[str, float]:
    """Widths of the stop operators that give `dir`, by place, as in identification."""
    width = max(2.0 * loop.resolution, 1e-12)
    load = max(2.0 * loop.load_resolution, loop.resolution, 1e-12)
    return {"axis": width, "motor": width, "joint": width, "load": load}


def _joined(values: list[float]):
    return values[0] if all(v == values[0] for v in values) else np.array(values)


def _at(made: Piece, values: dict, rows: dict):
    """Return name -> value of a piece at these rows; rows that are not named are zero."""
    given = [rows.get(n, 0.0) for n in made.rows]
    return dict(zip(made.outputs, arrays.evaluate(made.after, given, _evaluated(made, values))[0], strict=True))


def _at_rest(made: Design, values: dict, scenarios: ScenarioArrays) -> dict:
    """Return row -> position and speed of each body, where the loop begins: at the start, with the joint not wound up.

    The motor stands where the gear's error leaves no deflection; its slope is well below one, so fixed-point steps do.
    """
    if made.joint is None:
        return {"q": scenarios.start, "v": scenarios.speed}
    rows = {"q": scenarios.start, "load.q": scenarios.start}
    for _ in range(REST):
        x = _at(made.joint, values, rows)[LAST]
        rows["q"] = rows["q"] - x
    if not np.max(np.abs(x)) < 1e-9:
        raise WorkbenchError(
            "the joint has no deflection of zero near a scenario's start: the slope of its angle maps is too large."
        )
    return rows | {LAST: _at(made.joint, values, rows)[LAST], "v": scenarios.speed, "load.v": scenarios.speed}


def _per_mass(made: Design, values: dict, rest: dict, scenarios: ScenarioArrays) -> dict:
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


def _initial(made: Design, controller: Controller | None, values: dict, scenarios: ScenarioArrays, rest: dict) -> dict:
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
