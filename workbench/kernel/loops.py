"""The loops and branches of a generated function, put into LLVM instructions as they are written, about calls of straight functions.

    for name in range(...):     one, two or three arguments; the step a positive constant
    if condition:               without else
    a = expression              also of an array's element, and of a tuple: `a = f(...)`, `a, b, = f(...)`
    f(...)                      a straight function, written here line by line

A name that is given a value at one place is that value. One that is given a value at several has a place in memory, of which LLVM makes
registers. What a loop counts by, and a name that is given its only value in a loop or a branch, are not known after it.
"""

import ast
from collections import Counter
from collections.abc import Callable, Mapping

from llvmlite import ir
from numba.core import cgutils

from workbench.kernel.instructions import WHOLE, Lines


class Loops(Lines):
    """What is written of one function, when it is made. called: name -> writes that straight function with (builder, arguments).

    changing: names that are given a value at several places. places: of those, where in memory, one for each element of a tuple.
    """

    def __init__(self, builder: ir.IRBuilder, given: dict, body: list[ast.stmt], called: Mapping[str, Callable]):
        super().__init__(builder, 1, given)
        nodes = [node for line in body for node in ast.walk(line)]
        named = Counter(n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store))
        counters = {n.target.id for n in nodes if isinstance(n, ast.For)}  # a loop's own, and of no other value
        self.changing = {n for n, count in named.items() if count > 1 and n not in counters}
        self.functions = called
        self.places: dict[str, list[ir.Value]] = {}
        self.all(body)

    def all(self, body: list[ast.stmt]) -> None:
        for line in body:
            self.write(line)

    def write(self, line: ast.stmt) -> None:
        match line:
            case ast.For(iter=ast.Call(func=ast.Name(id="range"), args=args)):
                self._loop(line.target.id, args, line.body)
            case ast.If(orelse=[]):
                with self.builder.if_then(self.value(line.test)):
                    self.all(line.body)
            case ast.Expr(value=ast.Call()):
                self.value(line.value)
            case ast.Assign(targets=[ast.Tuple(elts=targets)]):
                for target, value in zip(targets, self.value(line.value), strict=True):
                    self.assign(target, value)
            case ast.Assign():
                super().write(line)
            case _:
                raise TypeError(f"a looped function holds {ast.unparse(line)!r}, which it cannot.")

    def assign(self, target: ast.expr, value) -> None:
        if not (isinstance(target, ast.Name) and target.id in self.changing):
            super().assign(target, value)
            return
        several = value if isinstance(value, list) else [value]
        if target.id not in self.places:
            self.places[target.id] = [cgutils.alloca_once(self.builder, v.type) for v in several]
            self.known[target.id] = value
        for place, v in zip(self.places[target.id], several, strict=True):
            self.builder.store(v, place)

    def read(self, name: str):
        if name not in self.places:
            return self.known[name]
        values = [self.builder.load(place) for place in self.places[name]]
        return values if isinstance(self.known[name], list) else values[0]

    def called(self, node: ast.Call):
        if node.func.id not in self.functions:
            return super().called(node)
        return self.functions[node.func.id](self.builder, [self.value(a) for a in node.args])

    def _loop(self, name: str, args: list[ast.expr], body: list[ast.stmt]) -> None:
        """Write a loop that asks at its head whether there is another. LLVM turns it, to ask at its end, and does it better: written
        turned, an open loop of one lane moved more values between registers and memory, and took 7 % longer."""
        step = args[2].value if len(args) == 3 else 1
        first = self.value(args[0]) if len(args) > 1 else ir.Constant(WHOLE, 0)
        end = self.value(args[min(len(args), 2) - 1])
        before = self.builder.block
        head, inside, after = (self.builder.append_basic_block(f"{n}.{name}") for n in ("head", "for", "after"))
        self.builder.branch(head)
        self.builder.position_at_end(head)
        at = self.builder.phi(WHOLE, name)
        at.add_incoming(first, before)
        self.builder.cbranch(self.builder.icmp_signed("<", at, end), inside, after)
        self.builder.position_at_end(inside)
        self.known[name] = at
        self.all(body)
        following = self.builder.add(at, ir.Constant(WHOLE, step), flags=("nsw",))  # no end is near 2^63
        at.add_incoming(following, self.builder.block)
        self.builder.branch(head)
        self.builder.position_at_end(after)
        del self.known[name]
