"""Units at the border: what comes in is turned into SI once, and refused where its dimension is not the expected one.

Two things are stricter here than SI itself, since both are silent factors in servo work:

- the angle counts: "N*m*s/rad" is a damping and "N*m*s" is not, "1/deg" is 57.3 "1/rad". Only an inertia may be written
  both ways, "kg*m^2" or "N*m*s^2/rad";
- a frequency in Hz counts cycles: "1/s" and "rad/s" are refused where Hz is expected, because "1/s" is read as either.

"^" and "**", "*" and a middle dot are equal. workbench.units.registry lists the units.
"""

from workbench.units.conversion import EXAMPLES, effect_unit, holds_mass, scaled, to_si

__all__ = ["EXAMPLES", "effect_unit", "holds_mass", "scaled", "to_si"]
