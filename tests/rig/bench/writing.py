"""How a bench's campaign is written: units, start values far off, channels and records."""

from collections.abc import Sequence

import numpy as np

from rig.bench.machines import Declared, Stand

LENGTHS = {"m": 1.0, "mm": 1e3, "um": 1e6}
ANGLES = {"rad": 1.0, "deg": 180.0 / np.pi}
# (rotary, linear) of a unit in F (torque or force) and x (angle or displacement)
UNITS = {
    "F*s^2/x": ("kg*m^2", "kg"), "F*s/x": ("N*m*s/rad", "N*s/m"), "F": ("N*m", "N"), "F/x": ("N*m/rad", "N/m"), "angle": ("rad", "rad"), "1": ("1", "1"),
}  # fmt: skip
OFF = (2.0, 7.0)  # factors by which start values may be off: as a rule, and now and then


def units(rng, s: Stand) -> tuple[str, float]:
    """Unit of positions and its factor."""
    known = LENGTHS if s.linear else ANGLES
    name = str(rng.choice(list(known)))
    return name, known[name]


def started(rng, d: Declared, key: str, value: float, far: float) -> float:
    """A start value; phases and exponents are guessed plainly."""
    if key == "d":
        return 1.0
    if key == "phase":
        return value + rng.uniform(-0.6, 0.6)
    part = min(far, 2.0) if d.at == "joint" or key == "mgl" else far
    return value * float(np.exp(rng.uniform(-np.log(part), np.log(part))))


def effects(rng, b, declared: Sequence[Declared]) -> list[str]:
    far, said = OFF[1] if rng.random() < 0.2 else OFF[0], []
    for d in declared:
        said += ["", "[[effects]]", f'effect = "{d.effect}"', f'at = "{d.at}"', f'law = "{d.law}"']
        for p in d.parameters:
            value = p.value if p.fixed else started(rng, d, p.key, p.value, far)
            # a start with exponent one: the virgin curve's own length, whatever its exponent
            if p.key == "a":
                curve = b.stand.curves[d.at]
                value, unit = started(rng, d, "a", 1.0 / curve[0], far), "1/m" if b.stand.linear else "1/rad"
            else:
                unit = UNITS[p.unit][b.stand.linear]
            said.append(
                f'parameters.{p.key} = {{ value = {value:.5g}, unit = "{unit}", fixed = {str(p.fixed).lower()} }}'
            )
    return said


def channel(name: str, unit: str, resolution: float = 0.0) -> list[str]:
    said = ["", f"[channels.{name}]", f'column = "{name}"', f'unit = "{unit}"']
    return [*said, f"resolution = {resolution:.10g}"] if resolution > 0.0 else said


def declaration(rng, b, declared: Sequence[Declared], unit: tuple[str, float]) -> str:
    """The text of campaign.toml."""
    s, two = b.stand, b.stand.machine.two
    drive = ("force", "N") if s.linear else ("torque", "N*m")
    said = [
        f'title = "bench {b.seed}: {s.name}"', f'plant = "{"two mass" if two else "one mass"}"',
        f'evaluation_bandwidth = {{ value = {b.rates.band:g}, unit = "Hz" }}',
        f'actuator_limit = {{ value = {s.machine.facts.limit:.5g}, unit = "{drive[1]}" }}',
        'initial_condition = "every record starts at rest with relaxed friction"',
    ]  # fmt: skip
    if b.nuisances.tolerance not in (0.0, 0.01):
        said.append(f"tolerance = {b.nuisances.tolerance:g}")
    if not s.linear:
        said += ["", "[geometry]", f"gear_ratio = {s.ratio:g}", f"pole_pairs = {s.pole_pairs}"]
    said += [*channel("time", "s"), *channel(*drive), *channel("position", unit[0], s.machine.facts.count * unit[1])]
    if two:
        said += channel("load_position", unit[0], s.load_count * unit[1])
    said += [*channel("reference", unit[0]), *effects(rng, b, declared)]
    for p in b.plan:
        said += [
            "",
            "[[records]]",
            f'file = "{p.name}.csv.gz"',
            f'role = "{p.role}"',
            f'motion = "{p.motion.what}"',
            f"start_time_s = {p.start:g}",
        ]
        said += [f"load_locked = {str(p.motion.locked).lower()}"] if two else []
    return "\n".join(said) + "\n"


def line(b, unit: tuple[str, float], log) -> str:
    """The text of a record."""
    s, two = b.stand, b.stand.machine.two
    head = ["time", "force" if s.linear else "torque", "position", *(["load_position"] if two else []), "reference"]
    columns = [log.t, log.u, log.q * unit[1], *([log.ql * unit[1]] if two else []), log.reference * unit[1]]
    form = "%.6f,%.7g" + ",%.11g" * (len(head) - 2)
    return ",".join(head) + "\n" + "\n".join(map(form.__mod__, map(tuple, np.column_stack(columns).tolist()))) + "\n"
