"""A controller's numbers as its firmware holds them: constants, knots and gains, positions counted in encoder counts."""

from dataclasses import dataclass
from math import frexp, isfinite

import numpy as np

from workbench.control.law import JOINT, Controller
from workbench.errors import WorkbenchError
from workbench.firmware.parts import Stages
from workbench.firmware.stages import stages
from workbench.firmware.units import power_of
from workbench.kernel import arrays
from workbench.plant import Plant
from workbench.simulation.binding import BACK
from workbench.simulation.scenario import Loop, loop_under

FAR = 2**22  # counts from which the firmware moves its origin along: WB_FAR of wb_runtime.h
MARGIN = 4.0  # times the axis' speed that one sample may show before it is taken for a broken encoder


@dataclass(frozen=True, eq=False)
class Numbers:
    """stages: of the law. values (constants,): float64, in N*m or N, counts and s. knots (m,): SI. columns: name -> (m,).

    count: rad or m a count; limit: N*m or N; bits: of the encoder; jump: counts a sample that are no motion any more.
    travel: the largest error that is told apart, and speed: the largest speed, in counts and counts/s: bounds of signals.
    """

    stages: Stages
    values: np.ndarray
    knots: np.ndarray
    columns: dict[str, np.ndarray]
    sample_time: float
    count: float
    limit: float
    bits: int
    jump: int
    travel: float
    speed: float

    @property
    def per_octave(self) -> int:
        """Knots an octave; 1 where there is no table."""
        if not self.knots.size:
            return 1
        places = (frexp(float(k))[0] * 2.0 for k in self.knots)  # 1 + j/m
        return max(_denominator(p) for p in places) if self.knots.size > 1 else 1


def _denominator(x: float) -> int:
    return x.as_integer_ratio()[1]


def numbers(
    controller: Controller, loop: Loop, plant: Plant, *, bits: int = 32, travel: float | None = None
) -> Numbers:
    """Return the numbers of one controller (scalars, one table) on a loop.

    bits: of the encoder that wraps, 2 to 32. travel: the largest error that is told apart, rad or m; 2^22 counts where
    absent. Raises WorkbenchError for an encoder without counts, a drive without a limit, or gains that vary over lanes.
    """
    count, limit = loop.count, plant.limits.drive
    _insist(controller, count, limit, bits)
    counted = any(t.knots[0] < count for t in controller.tables)
    made = stages(controller.law, loop.feedback, counted)
    given = _given_of(controller, loop, plant, made)
    values = np.array([float(v) for v in arrays.evaluate(made.before, [given[n] for n in made.given])[0]])
    if not np.isfinite(values).all():
        worst = made.constants[int(np.argmin(np.isfinite(values)))]
        raise WorkbenchError(f"controller '{controller.name}': {worst.formula} is not finite.")
    table = controller.tables[0] if controller.tables else None
    factor = float(
        np.ravel(controller.parameters.get("scale", 1.0))[0]
    )  # every schedule's command is proportional to its gains
    columns = {n: factor * _in_counts(f"gain.{n}", table.columns[n], count) for n in made.columns}
    speed = plant.limits.speed / count if isfinite(plant.limits.speed) else FAR / loop.sample_time / 64.0
    jump = int(min(max(MARGIN * speed * loop.sample_time, 64.0), FAR))
    jump = min(jump, 2 ** (bits - 1) - 1)
    return Numbers(
        stages=made,
        values=values,
        knots=table.knots if table else np.zeros(0),
        columns=columns,
        sample_time=loop.sample_time,
        count=count,
        limit=limit,
        bits=bits,
        jump=jump,
        travel=FAR if travel is None else min(abs(travel) / count, FAR),
        speed=MARGIN * speed,
    )


def _insist(controller: Controller, count: float, limit: float, bits: int) -> None:
    """Raise WorkbenchError for what no firmware can be made of: see `numbers`."""
    if count <= 0.0:
        raise WorkbenchError(
            "firmware counts positions in encoder counts, and this loop reads without any: state resolution in [loop]."
        )
    if not isfinite(limit):
        raise WorkbenchError("firmware limits its command, and the drive states no limit: state actuator_limit.")
    if not 2 <= bits <= 32:
        raise WorkbenchError(f"an encoder of {bits} bits cannot be read; 2 to 32 are possible.")
    if len(controller.tables) > 1 or any(np.size(v) > 1 for v in controller.parameters.values()):
        raise WorkbenchError(f"controller '{controller.name}' has several sets of gains; firmware takes one.")


def _in_counts(name: str, value, count: float):
    """Return a value in SI with its positions counted: times count^-p, p the power of position in its unit."""
    return value * count ** -power_of(name)[1]


def _smoothing_of(controller: Controller, loop: Loop) -> float:
    """Return the share of a new difference in the filtered velocity: the law's own filter's, else the loop's."""
    return loop_under(controller, loop).smoothing


def _given_of(controller: Controller, loop: Loop, plant: Plant, made: Stages) -> dict[str, float]:
    """Return name -> value of what the stages' constants are made of, in counts."""
    coarser = max(loop.resolution, loop.load_resolution) if controller.law.follows == JOINT else loop.count
    back = controller.reversal if controller.reversal is not None else BACK * coarser
    other = loop.load_resolution if loop.feedback == "position" else loop.resolution
    si = {
        "sample_time": loop.sample_time,
        "sample_rate": 1.0 / loop.sample_time,
        "smoothing": _smoothing_of(controller, loop),
        "count": loop.count,
        "back": back,
        "limit": plant.limits.drive,
        "other_count": other / loop.count,
        **{f"law.{n}": float(np.ravel(v)[0]) for n, v in controller.parameters.items()},
    }
    missing = set(made.given) - set(si)
    if missing:
        raise WorkbenchError(f"controller '{controller.name}': {sorted(missing)[0].removeprefix('law.')} is not given.")
    return {n: _in_counts(n, si[n], loop.count) for n in made.given}
