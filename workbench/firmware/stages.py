"""A law's stages as the firmware runs them: observe (velocity, reversals, where to look up) and command.

They are the functions that the simulated loop is made of (simulate.sampled), from the reading on. What depends on constants
alone is cut out and becomes a number of the table; a division by such a number becomes a multiplication by its reciprocal.
"""

from functools import lru_cache

import casadi as ca

from workbench.control.law import Law
from workbench.effects.elementary import absolute
from workbench.firmware.cutting import PROBE, cut, pruned
from workbench.firmware.parts import Stages
from workbench.simulation.dynamics import Symbols
from workbench.simulation.given import INJECTED, REFERENCE
from workbench.simulation.sampled import AMPLITUDE, command, followed, observed
from workbench.simulation.stage import stage

COMMAND, ADDED = "u_c", "added"
INCREMENT = "increment"  # counts since the last sample
SCALE = "law.scale"  # the command is proportional to the gains of every schedule, so that it may be in them
POSITIONS = ("furthest", "turned", "law.asked")  # states that move along with the origin


class Folded(Symbols):
    """Symbols of a firmware. The factor on a schedule's gains is one: the table holds the gains times that factor.

    The reading that closes the loop is no state: this sample's is there, and the way since the last is counted. counted:
    whether amplitudes below one count are told apart; errors are whole counts, so that where the table begins at one or more
    they are not, and the floor of one count that a law has under its error is none.
    """

    def __init__(self, counted: bool):
        super().__init__()
        self.counted = counted

    def state(self, name: str) -> ca.SX:
        return super().state("now.y" if name == "y" else name)

    def constant(self, name: str) -> ca.SX:
        if name == "count" and not self.counted:
            return ca.SX(0.0)
        return ca.SX(1.0) if name == SCALE else super().constant(name)


@lru_cache(maxsize=64)
def stages(law: Law, feedback: str = "position", counted: bool = True) -> Stages:
    """Return the stages of a law. feedback: the encoder that closes the loop, where the law reads two. counted: see Folded."""
    symbols = Folded(counted)
    begun, seen, decided = _outputs(law, symbols, feedback)
    seen.pop("y")
    wanted = {COMMAND} | ({AMPLITUDE} if law.columns else set())
    while True:  # what a kept value needs from the sample before is kept too
        made = [
            stage(name, symbols.all, {n: x for n, x in outputs.items() if n in wanted or n[0] == PROBE})
            for name, outputs in (("observe", seen), ("command", decided))
        ]
        made = [pruned(s, wanted) for s in made]
        more = {n for s in made for n in s.inputs} & (set(seen) | set(decided)) - wanted
        if not more:
            break
        wanted |= more
    states = {n for s in made for n in s.inputs} & wanted
    first = stage("start", symbols.all, {n: begun.get(n, ca.SX(0.0)) for n in (*seen, *decided) if n in states})
    return cut(law, feedback, symbols, [first, *made])


def _outputs(law: Law, symbols: Symbols, feedback: str):
    """Return the outputs of all three stages, with probes."""
    first = {"y": symbols.state("now.y")}
    if law.both:
        other = symbols.state("now.load.y" if feedback == "position" else "now.motor.y") * symbols.constant(
            "other_count"
        )
        both = (symbols.state("now.y"), other)
        motor, load = both if feedback == "position" else both[::-1]
        first = {"y": symbols.state("now.y"), "motor.y": motor, "load.y": load}
    driven = {REFERENCE: symbols.state(REFERENCE), INJECTED: symbols.state(ADDED)}
    step = symbols.state(INCREMENT)
    seen = observed(law, symbols, first, driven, step)
    at = followed(law, first)
    error = driven[REFERENCE] - first["y"]
    probes = {
        "rate": step * symbols.constant("sample_rate"),
        "from_furthest": at - symbols.state("furthest"),
        "stroke": absolute(at - seen["turned"]),
        "error": error,
    }
    if law.both:
        for body in ("motor", "load"):
            if f"{body}_vh" in law.reads:
                probes[f"{body}_increment"] = first[f"{body}.y"] - symbols.state(f"{body}.y")
    decided = command(law, symbols, driven)
    late = {"error": driven[REFERENCE] - symbols.state("y")}
    begun = first | {"furthest": at, "turned": at, "share": ca.SX(1.0)}
    if law.start is not None:
        begun |= {f"law.{n}": ca.SX(x) for n, x in law.start(driven[REFERENCE], first["y"]).items()}
    return begun, seen | _probed(probes), decided | _probed(late)


def _probed(values: dict) -> dict:
    return {PROBE + n: v for n, v in values.items()}
