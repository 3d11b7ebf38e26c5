"""A bank of hysteresis operators, and what is linear beside it, from records that are too long to keep their columns.

`identify` filters every column over the whole record and keeps it: with 20 elements, 1e6 samples take 4 s of CPU time and
1 GB. Here columns are made, used and forgotten block by block: 0.07 s and 8 MB, and 0.7 s and 80 MB for 1e7 samples (the
positions behind the dead band). For that nothing is filtered, and every frequency of the drive counts alike: right where
its noise is white, as in a slow record of friction, and not where it holds ripple or a resonance above the motion. There
are no intervals; `identify` on a part of the record has them.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench import definition as fx
from workbench.definition import Effect
from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.kernel.step import build
from workbench.long_records.stream import BLOCK, Blocks, Column, Weights, weights_of
from workbench.long_records.wording import known_only_together
from workbench.motion import Motion
from workbench.plant import Plant

BANK = "maxwell_slip"
SIGNALS = ("q", "v", "a", "t", "dt", "ratio", "pole_pairs")  # what an effect beside the bank may read


@dataclass(frozen=True, eq=False)
class LongFit:
    """plant: with its free linear parameters set. residual: rms in N*m or N; error: over the rms of the drive. weights:
    how the least squares was solved. Neither is filtered. findings: elements that the records do not tell apart.
    """

    plant: Plant
    residual: float
    error: float
    weights: Weights
    findings: tuple[Finding, ...] = ()


def _checked(plant: Plant) -> Effect:
    """Return the bank of a plant; WorkbenchError where something of the plant cannot be taken block by block."""
    for e in plant.effects:
        shape = [n for n in e.shape if not e.parameters[n].fixed]
        if e.name != BANK and (e.port != fx.FORCE or e.states or e.at != "axis" or set(e.reads) - set(SIGNALS)):
            why = "is no force without memory at the axis"
        elif shape:
            why = f"has the free parameter '{shape[0]}', which is not linear"
        elif e.name == BANK and any(e.parameters[n].fixed for n in e.linear):
            why = "has elements that are fixed"
        else:
            continue
        raise WorkbenchError(f"effect '{e.name}' {why}, so a long record cannot be fitted in blocks; use identify.")
    return plant[BANK]


def _columns_of(plant: Plant, motion: Motion) -> tuple[list[tuple[Effect, str]], list[Column], np.ndarray]:
    """Return (names, columns) of the free linear parameters beside the bank, and the drive (n,) less what is fixed."""
    constant = {"dt": motion.dt, "ratio": plant.geometry.gear_ratio, "pole_pairs": plant.geometry.pole_pairs}
    over_time = {"q": motion.q, "v": motion.v, "a": motion.a, "t": motion.t}

    def column(e: Effect, j: int) -> Column:
        values, step = {n: p.value for n, p in e.parameters.items()}, build(e)

        def block(x: np.ndarray, a: int) -> np.ndarray:
            part = {n: s[a : a + x.size] for n, s in over_time.items()}
            return np.broadcast_to(step.run(constant | part, values)[j], x.shape)

        return block

    names, columns, drive = [], [], motion.u
    for e in (e for e in plant.effects if e.name != BANK):
        for j, name in enumerate(e.linear or ("",)):
            if name and not e.parameters[name].fixed:
                names.append((e, name))
                columns.append(column(e, j))
            else:
                drive = drive - (e.parameters[name].value if name else 1.0) * column(e, j)(drive, 0)
    return names, columns, drive


def identify_bank(plant: Plant, motions: Sequence[Motion], block: int = BLOCK) -> LongFit:
    """Return `plant` with the elements of its Maxwell-slip bank, all >= 0, and its other linear parameters fitted.

    plant: one mass, with `maxwell_slip(slips)` and forces without memory whose free parameters are linear. motions: of the
    identification records. Errors: WorkbenchError for another plant, no motion, or a parameter that comes out beyond its bounds.
    """
    bank = _checked(plant)
    if not motions:
        raise WorkbenchError("there is no record to fit the bank to; give at least one motion.")
    slips = np.array([bank.parameters[n].value for n in bank.shape])
    records, power, reach = [], 0.0, 0.0
    for m in motions:
        names, columns, drive = _columns_of(plant, m)
        position = np.cumsum(m.dq)  # behind the dead band of one count, as operators see it in `identify`
        records.append(Blocks(position, drive, slips, "stop", columns, block, m.keep))
        power += float(m.u[m.keep] @ m.u[m.keep])
        reach = max(reach, float(np.abs(position - position[0]).max()))
    found = weights_of(records, "stop")
    values = {bank.key: dict(zip(bank.linear, found.weights.tolist(), strict=True))}
    for (e, name), value in zip(names, found.columns.tolist(), strict=True):
        p = e.parameters[name]
        if not p.lower <= value <= p.upper:
            raise WorkbenchError(
                f"{e.name}: {p.meaning} comes out at {value:.3g}, beyond its bounds {p.lower:g} to {p.upper:g}; declare it "
                "fixed, or use identify, which keeps bounds."
            )
        values.setdefault(e.key, {})[name] = value
    count = sum(r.rows for r in records)
    error = found.residual / np.sqrt(power / count) if power > 0.0 else float("nan")
    return LongFit(
        plant.with_values(values), found.residual, float(error), found, _unslipped(plant, bank, slips, reach)
    )


def _unslipped(plant: Plant, bank: Effect, slips: np.ndarray, reach: float) -> tuple[Finding, ...]:
    """Return a finding where several elements never slip in the records, which reach so far from where they begin."""
    names = [n for n, slip in zip(bank.linear, slips, strict=True) if slip >= reach]
    if len(names) < 2:
        return ()
    return (known_only_together(bank, names, reach, plant.displacement),)
