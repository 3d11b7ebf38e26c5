"""What a number of the firmware is measured in: powers of force, position and time, carried through every instruction.

Positions are counted in encoder counts, so that readings and their differences are whole numbers and exact.
"""

from collections.abc import Mapping

import casadi as ca

from workbench.control.drive import MOST
from workbench.control.notched import COEFFICIENTS
from workbench.errors import WorkbenchError
from workbench.kernel.choice import Choice
from workbench.kernel.program import Program

Power = tuple[float, float, float]  # of force (N*m or N), position (counts) and time (s)
NONE: Power = (0.0, 0.0, 0.0)
POSITION, SPEED, FORCE = (0.0, 1.0, 0.0), (0.0, 1.0, -1.0), (1.0, 0.0, 0.0)

POWERS: dict[str, Power] = {
    "sample_time": (0.0, 0.0, 1.0),
    "sample_rate": (0.0, 0.0, -1.0),
    "smoothing": NONE,
    "other_count": NONE,
    "limit": FORCE,
    "back": POSITION,
    "count": POSITION,
    "law.scale": NONE,
    "law.kp": (1.0, -1.0, 0.0),
    "law.kd": (1.0, -1.0, 1.0),
    "law.kv": (0.0, 0.0, -1.0),
    "law.kvp": (1.0, -1.0, 1.0),
    "law.ki": (1.0, -1.0, 0.0),
    "law.speed_limit": SPEED,
    "law.deceleration": (0.0, 1.0, -2.0),
    "law.gate": POSITION,
    "law.mass": (1.0, -1.0, 2.0),
    "law.per_first": (0.0, -1.0, 1.0),
    "law.held": POSITION,
    "law.integral": FORCE,
    "law.forward": NONE,
    "law.asked": POSITION,
    "law.asked_rate": SPEED,
    **{f"law.notch_{n}": NONE for n in COEFFICIENTS},
    "law.notch_first": FORCE,
    "law.notch_second": FORCE,
    **{f"law.{n}_{i}": NONE for n in COEFFICIENTS for i in range(1, MOST + 1)},
    **{f"law.{n}_{i}": FORCE for n in ("first", "second") for i in range(1, MOST + 1)},
    "gain.kp": (1.0, -1.0, 0.0),
    "gain.kd": (1.0, -1.0, 1.0),
    "gain.friction": FORCE,
    "added": FORCE,
    "u_c": FORCE,
    "way": NONE,
    "share": NONE,
}
SAME = {ca.OP_ADD, ca.OP_SUB, ca.OP_FMIN, ca.OP_FMAX, ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE}
TRUTH = {ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE, ca.OP_NOT, ca.OP_AND, ca.OP_OR}


def power_of(name: str) -> Power:
    """Return the powers of a named signal or constant; WorkbenchError for a law's number that is not known here."""
    if name in POWERS:
        return POWERS[name]
    if name.split(".")[-1] == "vh":
        return SPEED
    if name.startswith("law.") or name.startswith("gain."):
        raise WorkbenchError(
            f"the firmware does not know the unit of '{name}'; add its powers of force, position and time to "
            "workbench.firmware.units.POWERS."
        )
    return POSITION


def spread(program: Program, inputs: Mapping[str, Power]) -> dict[str, Power]:
    """Return name -> powers of every value of a program; WorkbenchError where unlike units are added or compared.

    inputs: name of each input ("i0_0") -> its powers. A literal takes the unit of what it stands beside.
    """
    known = dict(inputs)

    def joined(a: str, b: str, where: str) -> Power:
        found = [known[n] for n in (a, b) if n in known]
        if len(found) == 2 and found[0] != found[1]:
            raise WorkbenchError(f"'{program.name}': {where} joins {unit(found[0])} and {unit(found[1])}.")
        return found[0] if found else NONE

    for line in program.lines:
        a, b = known.get(line.a, NONE), known.get(line.b, NONE)
        if isinstance(line, Choice):
            found = joined(line.a, line.b, line.out)
        elif line.op in SAME:
            found = joined(line.a, line.b, line.out)
        elif line.op == ca.OP_IF_ELSE_ZERO:
            found = b
        elif line.op in (ca.OP_MUL, ca.OP_DIV):
            sign = 1.0 if line.op == ca.OP_MUL else -1.0
            found = tuple(x + sign * y for x, y in zip(a, b, strict=True))
        else:
            factor = {ca.OP_SQ: 2.0, ca.OP_SQRT: 0.5, ca.OP_INV: -1.0}.get(line.op, 1.0)
            found = tuple(factor * x for x in a)
        known[line.out] = NONE if line.op in TRUTH and not isinstance(line, Choice) else found
    return known


def unit(power: Power, effort: str = "N*m") -> str:
    """Return the unit as text, such as "N*m*s/count"; "1" for a plain number."""
    symbols = ((effort, power[0]), ("count", power[1]), ("s", power[2]))
    above = "*".join(_raised(s, p) for s, p in symbols if p > 0.0)
    below = "*".join(_raised(s, -p) for s, p in symbols if p < 0.0)
    below = f"({below})" if "*" in below and sum(p < 0.0 for _, p in symbols) > 1 else below
    return (above or "1") + (f"/{below}" if below else "")


def _raised(symbol: str, power: float) -> str:
    return symbol if power == 1.0 else f"{symbol}^{power:g}"
