"""Numbers put to a design: which vary over lanes, where each row starts, and how long the loop runs."""

from dataclasses import dataclass, replace

import numpy as np

from workbench import definition as fx
from workbench.control.law import JOINT, Controller
from workbench.control.table import stacked
from workbench.errors import WorkbenchError, nearest
from workbench.plant import ONE_MASS, Plant
from workbench.simulation import noise
from workbench.simulation.beginning import at_rest, evaluated, initial, per_mass
from workbench.simulation.bodies import SOFT
from workbench.simulation.criteria import Criteria
from workbench.simulation.design import Design, design
from workbench.simulation.dynamics import constants_of
from workbench.simulation.given import REFERENCE, Given, given_of
from workbench.simulation.sampled import Sensing
from workbench.simulation.scenario import Loop, ScenarioArrays

BACK = 2.5  # encoder counts: three back are a reversal; between counts, so that no rounding decides


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
    names = ("target", "inertia", "friction", "load", "phase", "load_inertia", "locked", "temperature")
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
    values = _values_of(plants, made, loop, controller, scenarios, criteria, aim)
    rest = at_rest(made, values, scenarios)
    values |= per_mass(made, values, rest, scenarios)
    table, base, grid = _tables_of(controller, lanes)
    delays = _delays_of(plants[0], loop, scenarios)
    window = max(int(round(criteria.window / loop.sample_time)), 1)
    return Bound(
        design=made,
        loop=loop,
        scenarios=scenarios,
        frontier=tuple(evaluated(p, values) for p in made.pieces),
        initial=initial(made, controller, values, scenarios, rest),
        delays=delays,
        strength=np.broadcast_to(scenarios.noise / noise.SIGMA, (lanes,)),
        table=table,
        base=base,
        grid=grid,
        given=given,
        samples=samples,
        window_from=max(samples - window, 0),
    )


def _values_of(
    plants: list[Plant], made: Design, loop: Loop, controller: Controller | None, scenarios: ScenarioArrays, criteria: Criteria, aim,
) -> dict[str, object]:  # fmt: skip
    """Return constant -> its value, scalar or (lanes,), of a run. WorkbenchError where its plants differ in more than values."""
    widths = _widths_of(loop)
    each = [constants_of(p, made.symbols, widths) for p in plants]
    alike = [p.kind == plants[0].kind and p.limits == plants[0].limits for p in plants]
    if not all(alike) or any(e.keys() != each[0].keys() for e in each):
        raise WorkbenchError("plants of one run must have the same effects and limits, and differ in values alone.")
    values = each[0] if len(each) == 1 else {n: _joined([e[n] for e in each]) for n in each[0]}
    values = values | _factors(scenarios) | _limits(plants[0], loop) | criteria.constants(loop)
    values |= _of_controller(controller, scenarios.lanes, loop) if controller else {}
    back = BACK * (max(loop.resolution, loop.load_resolution) if made.law and made.law.follows == JOINT else loop.count)
    aim = values["target"] if aim is None else aim
    return values | {
        "back": controller.reversal if controller and controller.reversal is not None else back,
        "aim": aim,
        "band": criteria.band * np.abs(aim - scenarios.start),
        "step_sign": np.sign(scenarios.target - scenarios.start) + 0.0,
    }


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
