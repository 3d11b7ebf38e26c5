"""The catalogue as a page: every effect with its law, cause, parameters and source, from the effects themselves.

python -m workbench.catalogue_page > docs/catalogue.md
"""

import inspect
import sys
from collections.abc import Callable, Mapping

from workbench.definition import TWO_COUNTS, Effect, catalogue
from workbench.effects import curves, free_bank, free_maps
from workbench.effects.hysteresis import maxwell_slip
from workbench.effects.play import inverse, play_bank
from workbench.effects.virgin_curve import slip_of_curve
from workbench.parameter import Parameter

HEAD = """# Catalogue of effects

Generated from `workbench/effects/` by `python -m workbench.catalogue_page`; do not edit.

`F` stands for N*m on a rotary axis and for N on a linear one, `x` for rad and m; `q` is position, `v` velocity, `a`
acceleration, `dq` the increment of position behind a dead band of one encoder count, `t` the bench clock, `u` the drive,
`tau` the torque that a contact carries and `tau_inertia` that of inertia beside it, both by the model, `dir` the smooth
direction of motion. A *linear* parameter enters a least squares, a *searched* one is found by its start (in brackets what
gives it), a *held* one is left as declared unless it is set free.
"""
PORTS = {
    "force": "a force that resists motion",
    "angle": "a map of the joint's deflection",
    "command": "a map of the command",
    "sensor": "a map of a reading",
    "time": "a delay",
}
MADE = (
    maxwell_slip,
    slip_of_curve,
    play_bank,
    inverse,
    curves.friction_over_speed,
    free_bank.hysteresis_bank,
    free_bank.free_bank,
    curves.friction_over_time,
    curves.friction_over_load,
    curves.friction_over_position,
    curves.force_over_position,
    curves.force_over_time,
    free_maps.angle_over_angle,
    free_maps.drive_over_command,
    free_maps.creep_spectrum,
)


def _factory(effect: Effect) -> Callable:
    """Return the function of `workbench.effects` that makes an effect."""
    return getattr(sys.modules[effect.step.__module__], effect.name)


def _law(function: Callable) -> str:
    """The docstring, as paragraphs."""
    return inspect.getdoc(function) or ""


def _bound(p: Parameter) -> str:
    if p.lower == -float("inf") and p.upper == float("inf"):
        return "any"
    if p.upper == float("inf"):
        return f">= {p.lower:g}"
    return f"<= {p.upper:g}" if p.lower == -float("inf") else f"{p.lower:g} to {p.upper:g}"


def _found(effect: Effect, name: str, p: Parameter) -> str:
    """How identification treats an inside parameter."""
    if p.fixed:
        return "held"
    if name in effect.linear:
        return "linear"
    return f"searched ({p.scale})" if p.scale else "searched"


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:] + "."


def _call(function: Callable) -> str:
    """The function with the names of its arguments, and their defaults."""
    given = inspect.signature(function).parameters.values()
    arguments = (p.name if p.default is p.empty else f"{p.name}={p.default!r}" for p in given)
    return f"{function.__name__}({', '.join(arguments)})"


def _table(rows: Mapping[str, Parameter], tell: Callable[[str, Parameter], str] | None = None) -> list[str]:
    head = ["parameter", "unit", "bounds", "meaning", *(["found"] if tell else [])]
    lines = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    for n, p in rows.items():
        cells = [f"`{n}`", p.unit, _bound(p), p.meaning, *([tell(n, p)] if tell else [])]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def _section(effect: Effect) -> list[str]:
    """Lines of one effect."""
    lines = [
        f"## {effect.name}",
        "",
        f"`{effect.formula}`",
        "",
        effect.cause.capitalize() + ".",
        "",
        _law(_factory(effect)),
        "",
    ]
    facts = [f"{PORTS[effect.port]}, at {', '.join(effect.places)}"]
    facts += [f"reads {', '.join(effect.reads)}"] if effect.reads else []
    facts += [f"provides {', '.join(effect.provides)}"] if effect.provides else []
    facts += [f"{sum(effect.states.values())} states"] if effect.states else []
    facts += [f"holds: {', '.join(effect.holds)}"] if effect.holds else []
    facts += [f"{effect.motions[0]} axes only"] if len(effect.motions) == 1 else []
    facts += [] if effect.traced else ["not offered by a trace"]
    facts += ["named after others that explain as much"] if effect.rare else []
    facts += [f"family: {effect.family}"] if effect.family else []
    facts += _limits(effect)
    lines += [_sentence("; ".join(facts)), ""]
    if effect.parameters:
        lines += _table(effect.parameters, lambda n, p: _found(effect, n, p)) + [""]
    if effect.border is not None:
        lines += ["As a campaign writes it:", "", *_table(effect.border.parameters), ""]
    if inspect.signature(_factory(effect)).parameters:
        lines += [f"Built as `{_call(_factory(effect))}`.", ""]
    return [*lines, f"Source: {effect.source}.", ""]


def _limits(effect: Effect) -> list[str]:
    """What an effect is at a neutral value, and what it is made of, as facts."""
    said = []
    for name, (neutral, left) in effect.reduces.items():
        value = "of no more than two encoder counts" if neutral == TWO_COUNTS else f"= {neutral:g}"
        said.append(f"with `{name}` {value} it is {left or 'nothing'}")
    return [*said, *([f"joins {' and '.join(effect.parts)}"] if effect.parts else [])]


def page() -> str:
    """Return docs/catalogue.md."""
    known = catalogue()
    lines = [HEAD, f"{len(known)} effects:", ""]
    lines += ["| effect | family | law | at |", "|---|---|---|---|"]
    for n, e in known.items():
        anchor = f"[{n}](#{n})"
        lines.append(f"| {anchor} | {e.family} | `{e.formula.replace('|', chr(92) + '|')}` | {', '.join(e.places)} |")
    lines.append("")
    for e in known.values():
        lines += _section(e)
    lines += [
        "## Made from data",
        "",
        "Functions that make an effect, or the numbers of one, from what was measured; among them each family's free-form law.",
        "",
    ]
    for function in MADE:
        where = function.__module__
        lines += [f"### {function.__name__}", "", f"`{where}.{_call(function)}`", ""]
        lines += [_law(function), ""]
    return "\n".join(lines).rstrip() + "\n"


if __name__ == "__main__":
    print(page(), end="")
