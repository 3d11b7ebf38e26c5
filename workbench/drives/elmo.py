"""Elmo gain sets: KG[1..16] integral, KG[17..32] proportional gain of the speed loop, KG[33..48] of the position loop.

Of the speed loop the proportional gain is in mA/(count/s), of the position loop in 1/s; in which unit the integral one is
depends on the drive's generation, so it has to be stated: "mA/count", or "1/s" for its ratio to the proportional gain.
GS[2] = 1 to 16 chooses a set.
"""

import re
from collections.abc import Sequence

from workbench.drives.fields import LICENCE, Range, number, text
from workbench.drives.gains import Cascade, Units
from workbench.errors import WorkbenchError, nearest

SETS = 16
LINE = re.compile(r"(KG|GS)\[(\d{1,2})\]=(\S+);")
INTEGRAL = ("mA/count", "1/s")
RANGES = (Range("KG integral", 0.0, 1e6), Range("KG proportional", 0.0, 1e6), Range("KG position", 0.0, 1e6))


def sets(gains: Sequence[Cascade], units: Units, integral: str) -> list[tuple[float, float, float]]:
    """Return (integral, proportional, position) of each set, in the drive's units."""
    if integral not in INTEGRAL:
        raise WorkbenchError(f"Elmo: the integral gain's unit is '{integral}'; {nearest(integral, INTEGRAL)}")
    if not 1 <= len(gains) <= SETS:
        raise WorkbenchError(f"Elmo: {len(gains)} sets of gains; the drive holds 1 to {SETS}. Leave out amplitudes.")
    for g in gains:
        g.without_notches("Elmo")
    if any(g.mass or g.viscous or g.forward for g in gains):
        raise WorkbenchError(
            "Elmo: gain sets hold no feed-forward; write it where the drive takes it, and leave it out here."
        )
    out = []
    for n, g in enumerate(gains, 1):
        milliamps = 1e3 / units.per_amp("Elmo") * units.per_count(g.rotary, "Elmo")
        whole = g.ki * milliamps if integral == "mA/count" else (g.ki / g.kvp if g.kvp else 0.0)
        values = (whole, g.kvp * milliamps, g.kv)
        out.append(tuple(r.hold(v, f"Elmo, set {n}") for r, v in zip(RANGES, values, strict=True)))
    return out


def write(gains: Sequence[Cascade], units: Units, integral: str) -> str:
    """Return the commands of up to 16 sets; sets that are left over repeat the last, so that none is stale."""
    held = sets(gains, units, integral)
    held += [held[-1]] * (SETS - len(held))
    lines = [f"// Gain sets, the integral one in {integral}. {LICENCE}"]
    for first, which in ((0, 0), (SETS, 1), (2 * SETS, 2)):
        lines += [f"KG[{first + n + 1}]={text(values[which])};" for n, values in enumerate(held)]
    return "\n".join([*lines, "GS[2]=1;"]) + "\n"


def read(content: str) -> list[tuple[float, float, float]]:
    """Return (integral, proportional, position) of all 16 sets; WorkbenchError for anything else."""
    found = {}
    for n, line in enumerate(content.splitlines(), 1):
        line = line.split("//")[0].strip()
        if not line:
            continue
        match = LINE.fullmatch(line)
        if match is None:
            raise WorkbenchError(f"Elmo, line {n}: '{line}' is no KG[n]=value; or GS[n]=value;.")
        key = match[1], int(match[2])
        if key in found or not 1 <= key[1] <= (3 * SETS if key[0] == "KG" else 2):
            raise WorkbenchError(f"Elmo, line {n}: {match[1]}[{match[2]}] is there twice, or does not exist.")
        found[key] = number(match[3], f"Elmo, line {n}")
    if missing := [k for k in range(1, 3 * SETS + 1) if ("KG", k) not in found]:
        raise WorkbenchError(f"Elmo: KG[{missing[0]}] is missing.")
    return [tuple(found["KG", n + first] for first in (0, SETS, 2 * SETS)) for n in range(1, SETS + 1)]
