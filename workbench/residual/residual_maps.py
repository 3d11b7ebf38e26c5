"""The residual of a trace against everything it may follow, before and after: in the drive, and of two masses in the angle."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from workbench.identification.result import Fit
from workbench.inverse.balances import balances
from workbench.inverse.bodies import POSITION
from workbench.inverse.carrying import load_errors
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import TWO_MASS, Plant
from workbench.processes import shared
from workbench.record import IDENTIFICATION
from workbench.residual.maps import Map, maps, over_time, pooled
from workbench.residual.spectra import Spectrum, over_frequency, over_order
from workbench.residual.window import DIRECTIONS, Window
from workbench.residual.windows import explained, sentence, windows

BOTH_WAYS = "both ways"  # as a row of trace.json calls either direction


@dataclass(frozen=True, eq=False)
class Residual:
    """One model's residual: maps over coordinates and directions, its spectra, and the window in each coordinate."""

    maps: tuple[Map, ...]
    spectra: tuple[Spectrum, ...]
    windows: tuple[Window, ...]

    def over(self, coordinate: str) -> tuple[Map, ...]:
        """Return the maps of one coordinate."""
        return tuple(m for m in self.maps if m.coordinate == coordinate)

    def explained(self, coordinate: str) -> float:
        """Return the share of the residual's power that is a function of one coordinate and the direction of motion."""
        return explained(self.over(coordinate))

    def window(self, coordinate: str) -> Window | None:
        """Return the window of one coordinate that the residual is largest in."""
        return next((p for p in self.windows if p.coordinate == coordinate), None)


@dataclass(frozen=True, eq=False)
class ResidualMaps:
    """of: "torque", "force", or "angle" (of the joint). unit: SI. records: those pooled. after: None where nothing was added.

    load: of the angle, role -> relative error of the load's balance, of each model (see `identify.carrying`).
    """

    of: str
    unit: str
    records: tuple[str, ...]
    before: Residual
    after: Residual | None
    rotary: bool
    load: Mapping[str, tuple[float, ...]] = field(default_factory=dict)


def map_residual(inverses: Sequence[InverseDynamics], declared: Fit, extended: Fit | None) -> tuple[ResidualMaps, ...]:
    """Return where the residual of the declared and of the extended plant lives on the identification records.

    extended: None where nothing was added. The residual of the drive is that of both fits; over time, all records are there. With two masses and a joint that has
    a stiffness, the residual of the angle follows.
    """
    chosen = identifying(inverses)
    parts = [lambda: drives(chosen, declared, extended), lambda: _of_angle(inverses, chosen, declared, extended)]
    return tuple(w for w in shared(lambda part: part(), parts) if w is not None)


def _of_angle(
    inverses: Sequence[InverseDynamics], chosen: Sequence[InverseDynamics], declared: Fit, extended: Fit | None
) -> ResidualMaps | None:
    """Return where the residual of the angle lives; None of one mass, or where the joint has no stiffness."""
    moving = [p for p in chosen if declared.plant.kind == TWO_MASS and p.rows(declared.plant) == 2]
    fits = [fit for fit in (declared, extended) if fit is not None]
    left = [angle_residual(moving, fit.plant) for fit in fits] if moving else []
    if not left or any(r is None for r in left):
        return None
    errors = [load_errors(inverses, fit.plant) for fit in fits]
    load = {role: tuple(e[role] for e in errors) for role in errors[0]}
    return replace(_angles(moving, declared, left), load=load)


def identifying(inverses: Sequence[InverseDynamics]) -> list[InverseDynamics]:
    """Return the identification records, by name; all where there are none."""
    chosen = [p for p in inverses if p.motion.record.role == IDENTIFICATION] or list(inverses)
    return sorted(chosen, key=lambda p: p.motion.record.name)


def drives(inverses: Sequence[InverseDynamics], declared: Fit, extended: Fit | None) -> ResidualMaps:
    """Return where the residual of the drive lives."""
    plant = declared.plant
    pool = pooled(inverses, plant, {n: s.predicted for n, s in declared.series.items()})

    def one(fit: Fit) -> Residual:
        series = [fit.series[n] for n in pool.records]
        left = np.concatenate([s.residual[s.keep] for s in series])
        found = (*maps(pool, left), *over_time(fit))
        spectra = over_frequency(inverses, left), over_order(inverses, left, plant.displacement)
        return Residual(found, spectra, windows(found))

    of = "torque" if plant.rotary else "force"
    return ResidualMaps(
        of, plant.effort, pool.records, one(declared), one(extended) if extended else None, plant.rotary
    )


def _angles(inverses: Sequence[InverseDynamics], declared: Fit, left: Sequence[np.ndarray]) -> ResidualMaps:
    """Return where the residual of the angle lives. left: of each model, in the samples that count."""
    plant = declared.plant
    pool = pooled(inverses, plant, {n: s.predicted for n, s in declared.series.items()})

    def one(residual: np.ndarray) -> Residual:
        found = maps(pool, residual)
        spectra = over_frequency(inverses, residual), over_order(inverses, residual, plant.displacement)
        return Residual(found, spectra, windows(found))

    before, after = (*map(one, left), *(None,) * (2 - len(left)))
    return ResidualMaps("angle", plant.displacement, pool.records, before, after, plant.rotary)


def joint_stiffness(inverses: Sequence[InverseDynamics], plant: Plant) -> float:
    """Return the slope of the joint's torque over its deflection, by least squares over all samples, N*m/rad or N/m."""
    product = square = 0.0
    for p in inverses:
        x = p.bodies.body(plant, "joint")[1][POSITION]
        x = x - x.mean()
        torque = np.zeros(x.size)
        for e, name, column in p.columns(plant):
            if e.at == "joint":
                torque += (e.parameters[name].value if name else 1.0) * column[0]
        product, square = product + float(torque @ x), square + float(x @ x)
    return product / square if square > 0.0 else 0.0


def angle_residual(inverses: Sequence[InverseDynamics], plant: Plant) -> np.ndarray | None:
    """Return the deflection that the load's motion asks for less the measured one, in the samples that count, rad or m.

    It is what the load's balance leaves, over the joint's mean stiffness. None where the joint has no stiffness.
    """
    stiffness = joint_stiffness(inverses, plant)
    if not stiffness > 0.0:
        return None
    left = [p.motion.filter(balances(p, plant)[1])[p.motion.keep] for p in inverses]
    return np.concatenate(left) / stiffness


def load_as_dict(found: Sequence[ResidualMaps]) -> dict[str, dict[str, float]]:
    """Return the errors of the load's balance as trace.json holds them; empty of one mass."""
    return {role: {"before": e[0], "after": e[-1]} for w in found for role, e in w.load.items()}


def as_list(found: Sequence[ResidualMaps]) -> list[dict]:
    """Return the windows as trace.json holds them: the declared model's, and the extended one's where there is one."""
    rows = []
    for w in found:
        for model, residual in (("declared", w.before), ("extended", w.after)):
            for p in residual.windows if residual else ():
                share = {"explained": residual.explained(p.coordinate)} if not p.record else {}
                rows.append({"of": w.of, "model": model, **_as_dict(p), **share, "sentence": sentence(p)})
    return rows


def _as_dict(w: Window) -> dict[str, object]:
    """Return a window as a row of trace.json holds it."""
    return {
        "coordinate": w.coordinate,
        "unit": w.unit,
        "way": DIRECTIONS[w.direction] if w.direction else BOTH_WAYS,
        "record": w.record,
        "low": w.low,
        "high": w.high,
        "times": w.times,
        "share": w.share,
        "samples": w.covered,
    }
