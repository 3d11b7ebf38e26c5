"""The order in which a program's lines are written, for a processor that begins several at once and waits for each one's result.

List scheduling by the critical path (Hu 1961; Graham 1969): in every cycle what is begun is, of the lines whose operands are there, the
one with the longest way still to go to the end. Compilers keep the order of what they are given nearly everywhere, and a processor
looks some three hundred instructions ahead: an exponential written behind thirty hysteresis elements waits for nothing but itself.
No line changes, so neither do the bits. Alone on a core the loop of the main study takes 0.67 of the time that it takes in CasADi's order.
"""

from dataclasses import replace
from functools import lru_cache

import casadi as ca

from workbench.kernel.choice import Choice
from workbench.kernel.program import Line, Program

# Cycles from operands to result, of AMD Zen 4 (Fog, Instruction tables, 2023), near those of its kin. Only their order of size matters: with one
# unit of each kind a cycle, as its halves of 512 bits have it, twice as many units make the loop of the main study a sixth slower.
DIVISION, PRODUCT, SUM, COMPARISON = 16, 4, 4, 2
CYCLES = {ca.OP_DIV: DIVISION, ca.OP_INV: DIVISION, ca.OP_SQRT: DIVISION, ca.OP_MUL: PRODUCT, ca.OP_SQ: PRODUCT}
CYCLES |= dict.fromkeys((ca.OP_ADD, ca.OP_SUB, ca.OP_TWICE, ca.OP_FLOOR), SUM)


@lru_cache(maxsize=512)
def by_latency(program: Program) -> Program:
    """Return the program with its lines in the order in which they had best begin."""
    lines = program.lines
    at = {line.out: k for k, line in enumerate(lines)}
    needs = [{at[name] for name in line.operands if name in at} for line in lines]
    users: list[list[int]] = [[] for _ in lines]
    for k, need in enumerate(needs):
        for j in need:
            users[j].append(k)
    ahead = _ahead(lines, users)
    waits, there = [len(need) for need in needs], [0] * len(lines)
    open_, order, cycle = [k for k, need in enumerate(needs) if not need], [], 0
    while open_:
        for product in (False, True):  # one sum and one product begin side by side
            ready = [k for k in open_ if there[k] <= cycle and _is_product(lines[k]) == product]
            if not ready:
                continue
            k = min(ready, key=lambda k: (-ahead[k], k))
            open_.remove(k)
            order.append(k)
            for user in users[k]:
                waits[user] -= 1
                there[user] = max(there[user], cycle + _cycles(lines[k]))
                if not waits[user]:
                    open_.append(user)
        cycle += 1
    return replace(program, lines=tuple(lines[k] for k in order))


def _ahead(lines: tuple[Line, ...], users: list[list[int]]) -> list[int]:
    """Return the cycles from the beginning of each line to the end of what needs it, at least."""
    ahead = [0] * len(lines)
    for k in reversed(range(len(lines))):
        ahead[k] = _cycles(lines[k]) + max((ahead[user] for user in users[k]), default=0)
    return ahead


def _cycles(line: Line) -> int:
    return COMPARISON if isinstance(line, Choice) else CYCLES.get(line.op, COMPARISON)


def _is_product(line: Line) -> bool:
    return not isinstance(line, Choice) and CYCLES.get(line.op) in (PRODUCT, DIVISION)
