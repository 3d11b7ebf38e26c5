"""From a model to gains and back: describe, tune, fit_schedule, simulate, compensate."""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from workbench import compensation, control, description, schedule, simulation, tuning
from workbench.control import Controller
from workbench.definition import Effect
from workbench.description import Equivalent
from workbench.errors import WorkbenchError
from workbench.frequency import Response
from workbench.front.given import Measured, plant_of
from workbench.plant import ONE_MASS, Plant
from workbench.schedule import Schedule
from workbench.simulation import Criteria, Loop, Metrics, Scenario, ScenarioArrays
from workbench.tuning import Gains, TuningGoal

Law: TypeAlias = Controller | Schedule | tuple[float, float]
Scenarios: TypeAlias = float | Scenario | ScenarioArrays | Sequence[float] | Sequence[Scenario]


def describe(
    model: Effect | Measured,
    amplitudes: Sequence[float] | np.ndarray,
    *,
    omega: float | None = None,
    resolution: float = 0.0,
) -> Equivalent:
    """Return the linear spring and loss that answer x = A cos(w t) as the first harmonic of an effect, or of all friction, does.

        F = k_e x + c_e dx/dt;   k_e and c_e w over A, both N*m/rad or N/m

    model: a force of a plant, or a plant of one mass: then all its forces but inertia and viscous friction, together.
    amplitudes (n,): A, rad or m, zero to peak. omega: w, rad/s; needed but for an effect that holds Masing's rule. resolution:
    of the encoder, rad or m. Raises WorkbenchError where omega is missing, or a force has no first harmonic.
    """
    amplitudes = np.atleast_1d(np.asarray(amplitudes, dtype=float))
    if isinstance(model, Effect) and "masing" in model.holds and model.virgin is not None:
        return description.equivalent(model, amplitudes)
    if omega is None:
        raise WorkbenchError("what is described here may depend on rate; state omega=, the angular frequency in rad/s.")
    if isinstance(model, Effect):
        return description.first_harmonic(model, amplitudes, omega)
    friction, _, _ = description.friction_of(_of_one_mass(model, "described"))
    return description.equivalent_of(friction, amplitudes, np.full(amplitudes.size, float(omega)), resolution)


def tune(
    model: Measured,
    loop: Loop,
    amplitudes: Sequence[float] | np.ndarray,
    goal: TuningGoal | None = None,
    *,
    response: Response | None = None,
) -> Gains:
    """Return the PD gains u = Kp (r - y) - Kd vh of each amplitude: the fastest within the goal, on the exact sampled loop.

        J y'' + (c_e w/w_n + b + Kd) y' + (k_e + Kp) y = Kp r,   w_n = sqrt((Kp + k_e)/J)

    model: of one mass, with an inertia. amplitudes (n,): of steps, rad or m, rising. goal: limits; the plant's own drive and
    speed, and Ms of 2, where absent. response: a measured one, whose modes limit the gains too. Gains are SI, (n,) each.
    Raises WorkbenchError for what is no axis of one mass; tuning.OutOfReach where no gains keep the goal.
    """
    plant = _of_one_mass(model, "tuned")
    if not description.friction_of(plant)[1] > 0.0:
        raise WorkbenchError("the plant has no inertia above 0; add find('inertia') with its value.")
    goal = goal or TuningGoal(drive=plant.limits.drive, speed=plant.limits.speed)
    return tuning.tuned_axis(plant, np.asarray(amplitudes, dtype=float), goal, loop, response=response).gains


def fit_schedule(
    gains: Gains,
    loop: Loop,
    model: Measured | None = None,
    *,
    per_octave: int = 4,
    lowest: float | None = None,
    highest: float | None = None,
    monotone: bool = True,
    slope: tuple[float, float] = (-2.5, 0.5),
    tolerance: float = 0.02,
    rule: str = "frozen",
) -> Schedule:
    """Return the schedule whose gains, linear between knots, are closest to tuned ones in the least squares of their logs.

    loop: that they were tuned for. model: its plant is named in the schedule; `export` needs it. per_octave: knots an octave,
    a power of two. lowest, highest: range of amplitudes, rad or m. monotone: gains never rise with amplitude. slope: bounds of
    d log gain/d log amplitude. tolerance: a larger interpolation error is a finding. rule: "frozen", "following", "error" or "closing"
    (Schedule says which). Raises WorkbenchError for no such knots, range or rule.
    """
    plant = None if model is None else plant_of(model)
    return schedule.fit_schedule(
        gains, loop=loop, per_octave=per_octave, lowest=lowest, highest=highest, monotone=monotone, slope=slope,
        tolerance=tolerance, rule=rule, plant_digest=plant.digest if plant else "",
        plant_lines=plant.digest_lines() if plant else (),
    )  # fmt: skip


def simulate(
    model: Measured,
    loop: Loop,
    controller: Law,
    scenarios: Scenarios,
    duration: float,
    record: Sequence[str] = (),
    *,
    every: int = 1,
    reference: np.ndarray | None = None,
    criteria: Criteria | None = None,
) -> Metrics:
    """Run the sampled loop in every scenario, from rest, and return its metrics, (lanes,) each, SI.

    controller: a Controller, a Schedule, or a pair (kp, kd) of a fixed PD. scenarios: targets in rad or m, or Scenarios.
    duration: s. record: signals to keep in `trajectories`, (n, lanes): "q", "v", "y", "vh", "u", "kp", "kd", ...; every so
    many samples. reference (n,) or (n, lanes): what is followed, rad or m, a value a sample. criteria: bands and windows.
    Raises WorkbenchError for a plant without forward dynamics, no scenario, or an unknown signal.
    """
    return simulation.simulate(
        plant_of(model), loop, _controller(controller), _scenarios(scenarios), duration, record,
        every=every, reference=reference, criteria=criteria,
    )  # fmt: skip


def compensate(
    controller: Law,
    model: Measured,
    *effects: str,
    source: str = compensation.READ,
    gain: float = 1.0,
    delay: int = 0,
    low_pass: float = 0.0,
    bandwidth: float = 0.0,
) -> Controller:
    """Return the controller with effects of the plant cancelled in its law: u = law(r, y, ...) + g D[L[F(p)]].

    effects: names or keys of the plant's; all that can be cancelled from this source where none is named. source: of the
    position p: "measured", "reference" or "observer". gain: g of the forces. delay: of D, samples. low_pass: of L, Hz, 0 for
    none. bandwidth: of the observer, Hz. Raises WorkbenchError for an effect that no drive cancels, with the reason.
    """
    plant = plant_of(model)
    names = effects or tuple(e.key for e in compensation.compensable(plant, source))
    if not names:
        raise WorkbenchError(f"no effect of this plant can be cancelled from '{source}'.")
    compensator = compensation.Compensator.of(
        plant, names, source=source, gain=gain, delay=delay, low_pass=low_pass, mass=description.friction_of(plant)[1], bandwidth=bandwidth,
    )  # fmt: skip
    return compensation.compensated(_controller(controller), compensator)


def _of_one_mass(model: Measured, what: str) -> Plant:
    plant = plant_of(model)
    if plant.kind != ONE_MASS:
        raise WorkbenchError(
            f"a plant of two masses is not {what} over amplitude as one; describe an effect of its joint, plant['name@joint']."
        )
    return plant


def _controller(given: Law) -> Controller:
    if isinstance(given, Schedule):
        return control.scheduled_pd(given)
    if isinstance(given, tuple) and len(given) == 2:
        return control.fixed_pd(*given)
    if isinstance(given, tuning.Gains):
        raise WorkbenchError("gains over amplitude are no controller yet: fit_schedule makes one of them.")
    if not isinstance(given, Controller):
        raise WorkbenchError(f"'{type(given).__name__}' is no controller; give one, a Schedule, or a pair (kp, kd).")
    return given


def _scenarios(given: Scenarios) -> Sequence[Scenario] | ScenarioArrays:
    if isinstance(given, Scenario | ScenarioArrays):
        return [given] if isinstance(given, Scenario) else given
    several = np.atleast_1d(np.asarray(given, dtype=object))
    return [s if isinstance(s, Scenario) else Scenario(target=float(s)) for s in several]
