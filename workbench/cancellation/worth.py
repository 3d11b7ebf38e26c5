"""What cancelling named effects is worth to a controller as it is: on a slow motion, as identified, off either way, and by the true law."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from workbench.cancellation.contestant import SUFFIX, contestant
from workbench.cancellation.following import Slow, Worth, bears, worth
from workbench.cancellation.wording import not_stable_alone
from workbench.compensation import OBSERVED, REFERENCE, Compensator
from workbench.control import Controller
from workbench.design.design import Designed
from workbench.errors import WorkbenchError, nearest
from workbench.finding import Finding
from workbench.plant import Plant
from workbench.task.task import Task

FOUR = 4  # lanes: without, with, and off either way
Margins = Callable[[str, Compensator, Sequence[float]], Mapping[float, float]]
Factories = Mapping[str, Callable[[int], Controller]]


@dataclass(frozen=True)
class Cancellation:
    """What is to be cancelled, and how its worth is asked. effects: names or keys. controller: by name. slow: the motion. mismatch: share by which
    the effects are taken too large and too small. options: of the compensator. where: who says so, for sentences."""

    effects: tuple[str, ...]
    controller: str
    slow: Slow
    mismatch: float
    options: Mapping[str, object]
    where: str = "[compensation]"

    def on(self, plant: Plant) -> Compensator:
        """Return the compensator of these effects as a plant has them."""
        options = dict(self.options)
        if options.get("source") == OBSERVED:
            options["mass"] = sum(e.parameters["inertia"].value for e in plant.effects if e.name == "inertia")
        return Compensator.of(plant, self.effects, **options)


@dataclass(frozen=True, eq=False)
class CancellationWorth:
    """found: on the plant of a task, by the law that is taken. true: by the plant's own law; `found` where that is the same.

    sensitivity: gain of the cancellation -> Ms of the loop with it; empty where it was not asked. findings: where the controller does not
    stand on the plant that is left.
    """

    given: Cancellation
    found: Worth
    true: Worth
    sensitivity: Mapping[float, float]
    findings: tuple[Finding, ...] = ()

    @property
    def figures(self) -> dict[str, float]:
        """Figures by which a cancellation may be judged, SI."""
        found, true = self.found, self.true
        figures = {
            "compensation_following_ratio": found.ratio,
            "compensation_following_ratio_true": true.ratio,
            "compensation_over_true": found.ratio / true.ratio,
            "compensation_following_ratio_off": found.off(self.given.mismatch),
            "following_error_alone": found.errors[0.0],
            "following_error_compensated": found.errors[1.0],
        }
        ms = self.sensitivity
        return figures | (
            {"compensation_sensitivity": ms[1.0], "compensation_sensitivity_off": max(ms.values())} if ms else {}
        )

    @property
    def rows(self) -> list[dict[str, float | None]]:
        """The same at each gain of the cancellation, as results.json holds it."""
        return [
            {"gain": g, "following_error": e, "sensitivity": self.sensitivity.get(g)}
            for g, e in self.found.errors.items()
        ]


def cancellation_worth(
    given: Cancellation, task: Task, factories: Factories, model: Plant | None = None, margins: Margins | None = None
) -> CancellationWorth:
    """Return what cancelling is worth on the plant of a task, to the controller with the gains that it has.

    model: the plant whose effects are taken, that of the task where absent. Where the two differ the task's is the rig's true
    law, and what compensation by that attains stands beside. margins: (controller, compensator, gains) -> gain -> Ms.
    """
    check_controller(given, factories)
    plant, controller = task.plant, factories[given.controller](FOUR)
    taken = given.on(model or plant)
    found = worth(plant, task.loop, controller, taken, given.slow, given.mismatch)
    true = found
    if model is not None and model.digest != plant.digest:
        true = worth(plant, task.loop, controller, given.on(plant), given.slow, given.mismatch)
    ms = margins(given.controller, taken, tuple(found.errors)) if margins else {}
    return CancellationWorth(given, found, true, ms, _fallen(given, task, factories[given.controller](1)))


def check_controller(given: Cancellation, controllers: Mapping[str, object]) -> None:
    """Raise WorkbenchError where a cancellation names a controller that there is not."""
    if given.controller not in controllers:
        raise WorkbenchError(
            f"{given.where}: there is no controller '{given.controller}'; {nearest(given.controller, controllers)}"
        )


def with_cancelled(
    made: Designed, given: Cancellation | None, task: Task, seeds: Sequence[int], say: Callable[[str], None]
) -> Designed:
    """Return the design with the controller of a cancellation beside the others, with the compensation and tuned with it."""
    if given is None:
        return made
    check_controller(given, made.tuned)
    one = contestant(made, task, given.controller, given.on(made.plant), seeds, say)
    return replace(made, tuned={**made.tuned, f"{given.controller}{SUFFIX}": one})


def _fallen(given: Cancellation, task: Task, controller: Controller) -> tuple[Finding, ...]:
    """Return a finding where the controller does not stand on the plant that its compensation leaves, which sees its motion."""
    compensator = given.on(task.plant)
    if compensator.source == REFERENCE or bears(task.plant, task.loop, controller, compensator, given.slow):
        return ()
    return (not_stable_alone(given.effects, given.controller),)
