"""What controllers and values are called in files and the generated C, and the formulas of numbers that are evaluated once."""

import re

import casadi as ca

from workbench.kernel.program import Program

WORDS = {ca.OP_ADD: "plus", ca.OP_SUB: "minus", ca.OP_MUL: "times", ca.OP_DIV: "over"}
SIGNS = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*", ca.OP_DIV: "/"}
LONGEST = 40  # characters of a name that is put together from others


def slug(name: str) -> str:
    """Return a controller's name as files, figures and C know it."""
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")


def identifier(name: str) -> str:
    """A row's or constant's name in C."""
    return name.removeprefix("law.").removeprefix("now.").replace(".", "_")


def formulas(program: Program, given: tuple[str, ...]) -> dict[str, tuple[str, str]]:
    """Return value -> (name in C, formula) of a program of constants."""
    known = {f"i0_{j}": (identifier(n), identifier(n)) for j, n in enumerate(given)}
    for k, line in enumerate(program.lines):
        (a, fa), (b, fb) = (known.get(o, (o.replace(".", "_").strip("()-"), o)) for o in (line.a, line.b))
        if line.op in WORDS:
            name, text = f"{a}_{WORDS[line.op]}_{b}", f"({fa} {SIGNS[line.op]} {fb})"
        elif line.op == ca.OP_NEG:
            name, text = f"minus_{a}", f"-{fa}"
        elif line.op == ca.OP_INV:
            name, text = f"per_{a}", f"1/{fa}"
        elif line.op in (ca.OP_SQ, ca.OP_TWICE):
            word, sign = {ca.OP_SQ: ("squared", f"{fa}^2"), ca.OP_TWICE: ("twice", f"2*{fa}")}[line.op]
            name, text = f"{a}_{word}", sign
        else:
            name, text = f"number_{k}", line.text
        plain = len(name) <= LONGEST and not name[0].isdigit()  # no name in C begins with a digit
        known[line.out] = (name if plain else f"number_{k}", text)
    return known
