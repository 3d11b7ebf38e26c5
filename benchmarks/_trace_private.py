"""What halving and doubling each private number of the trace does to verdicts, campaign by campaign.

A private number (a module's constant in capitals) serves a search or a description. One that changes a verdict decides, and
belongs among the criteria. Each is changed wherever it was imported to, the campaigns are traced again, and the verdict, the
effects that are added and what is ranked first are compared. All of a factor are changed at once first, and groups that say
something else are halved.
"""

import ast
import importlib
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import cache
from pathlib import Path

FACTORS = (0.5, 2.0)
Number = float | tuple[float, ...]
Change = tuple[str, str, float, Number]  # module, name, factor, the number times it
CODES = ("EITHER", "FORWARD", "BACKWARD", "MAINS")  # names of directions, and what the mains give
PACKAGES = ("workbench.tracing", "workbench.residual")
BESIDE = ("workbench.identification.cross_validation",)
# What a description on the page, a plan or a file is made of: no search and no verdict reads it.
DESCRIBES = ("criteria", "maps", "output", "repeats", "residual_maps", "spectra", "windows", "wording")


@cache
def modules() -> dict[str, str]:
    """Short name -> module, of what a search or a verdict reads its numbers from."""
    found = [f"{p}.{f.stem}" for p in PACKAGES for f in Path(importlib.import_module(p).__file__).parent.glob("*.py")]
    named = {name.rpartition(".")[2]: name for name in sorted((*found, *BESIDE))}
    return {stem: name for stem, name in named.items() if stem not in ("__init__", *DESCRIBES)}


def numbers() -> Iterator[tuple[str, str, Number]]:
    """(module, name, value) of every private number of the trace, and of every few that stand together, in the order of their files."""
    for stem, name in modules().items():
        module = importlib.import_module(name)
        for node in ast.parse(Path(module.__file__).read_text(encoding="utf-8")).body:
            targets = node.targets if isinstance(node, ast.Assign) else []
            names = [
                x for t in targets for x in (t.elts if isinstance(t, ast.Tuple) else [t]) if isinstance(x, ast.Name)
            ]
            for x in names:
                value = getattr(module, x.id, None)
                if x.id not in CODES and x.id.isupper() and is_number(value):
                    yield stem, x.id, value


def is_number(value: object) -> bool:
    """Whether a constant is a number, or a few of them together."""
    if isinstance(value, tuple) and value:
        return all(is_number(x) for x in value)
    return isinstance(value, int | float) and not isinstance(value, bool)


@contextmanager
def changed(module: str, name: str, value: Number) -> Iterator[None]:
    """While it lasts the number has another value, in its module and wherever it was imported by that name."""
    home = importlib.import_module(modules()[module])
    before = getattr(home, name)
    held = [m for key, m in sys.modules.items() if key.startswith("workbench.") and getattr(m, name, None) is before]
    own = [m for m in held if m is home or comes_from(m, module, name)]
    started = [(f, f.__defaults__ or (), f.__kwdefaults__ or {}) for m in own for f in _starting_from(m, name)]
    try:
        for m in own:
            setattr(m, name, value)
        for f, defaults, keywords in started:
            f.__defaults__ = tuple(value if x is before else x for x in defaults)
            f.__kwdefaults__ = {k: value if x is before else x for k, x in keywords.items()}
        yield
    finally:
        for m in own:
            setattr(m, name, before)
        for f, defaults, keywords in started:
            f.__defaults__, f.__kwdefaults__ = defaults, keywords


def _starting_from(module, name: str) -> list:
    """Return the functions and methods of a module one of whose arguments has a number for its default."""
    holders = [module, *(x for x in vars(module).values() if isinstance(x, type) and x.__module__ == module.__name__)]
    named = {f.name for f in _defaults(ast.parse(Path(module.__file__).read_text(encoding="utf-8")), name)}
    return [f for h in holders for n in named if (f := vars(h).get(n)) is not None and f.__module__ == module.__name__]


def comes_from(module, home: str, name: str) -> bool:
    """Whether a module imports a name from a module of the trace."""
    source = Path(module.__file__).read_text(encoding="utf-8")
    return any(
        isinstance(node, ast.ImportFrom)
        and node.module == modules()[home]
        and name in {a.asname or a.name for a in node.names}
        for node in ast.walk(ast.parse(source))
    )


def said(folder: Path) -> tuple:
    """What a trace says of a campaign, as far as it is compared: the verdict, and of a cause what is added and what leads."""
    from benchmarks._trace_run import traced
    from workbench.campaign import load

    found = traced(load(folder))
    return found["verdict"], tuple(sorted(found["added"])), tuple(found["ranked"][: found["verdict"] == "cause"])


@contextmanager
def called() -> Iterator[set[tuple[str, int]]]:
    """While it lasts, the functions of the package that this thread calls are noted: (file, first line)."""
    seen: set[tuple[str, int]] = set()

    def note(frame, event, _):
        if event == "call":
            seen.add((frame.f_code.co_filename, frame.f_code.co_firstlineno))

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        yield seen
    finally:
        sys.setprofile(before)


@cache
def readers(module: str, name: str) -> frozenset[tuple[str, int]] | None:
    """Return the functions (file, first line) that read a number; None where a module reads it as it is imported, once and for all."""
    home, found = importlib.import_module(modules()[module]), set()
    for m in [m for key, m in sys.modules.items() if key.startswith("workbench.") and hasattr(m, name)]:
        if m is not home and not comes_from(m, module, name):
            continue
        tree = ast.parse(Path(m.__file__).read_text(encoding="utf-8"))
        within = {f: _reads(f, name) for f in ast.walk(tree) if isinstance(f, ast.FunctionDef | ast.AsyncFunctionDef)}
        started = _defaults(tree, name)
        if _reads(tree, name) > len(started) + sum(within[f] for f in within if f in tree.body or _of_class(f, tree)):
            return None
        read = [f for f, n in within.items() if n or f in started]
        found |= {(m.__file__, min([f.lineno, *(d.lineno for d in f.decorator_list)])) for f in read}
    return frozenset(found)


def _reads(node: ast.AST, name: str) -> int:
    """Return how often the code under a node reads a name; of a function its body alone, for what it starts from is read on import."""
    nodes = node.body if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) else [node]
    return sum(
        isinstance(x, ast.Name) and x.id == name and isinstance(x.ctx, ast.Load) for n in nodes for x in ast.walk(n)
    )


def _defaults(node: ast.Module, name: str) -> list:
    """Return the functions one of whose arguments has a number for its default."""
    functions = (f for f in ast.walk(node) if isinstance(f, ast.FunctionDef))
    return [
        f
        for f in functions
        if any(isinstance(d, ast.Name) and d.id == name for d in (*f.args.defaults, *f.args.kw_defaults))
    ]


def _of_class(function: ast.AST, tree: ast.Module) -> bool:
    return any(function in c.body for c in tree.body if isinstance(c, ast.ClassDef))


def read_numbers(seen: set[tuple[str, int]]) -> list[tuple[str, str, Number]]:
    """Return the private numbers that one of the calls seen reads, or that a module reads as it is imported."""
    return [n for n in numbers() if (reads := readers(n[0], n[1])) is None or reads & seen]


def deciding(changes: Sequence[Change], differs: Callable[[Sequence[Change]], bool]) -> Iterator[Change]:
    """Yield the changes that differ by themselves, of those that differ together: a group is halved as long as it does.

    Of few that decide this asks far less often than one after another: n changes of which k decide, some k log2(n/k) times. Two that
    undo each other within a group that does not differ are not seen.
    """
    if not changes or not differs(changes):
        return
    if len(changes) == 1:
        yield changes[0]
        return
    half = len(changes) // 2
    yield from deciding(changes[:half], differs)
    yield from deciding(changes[half:], differs)


def sweep(folders: Sequence[Path]) -> Iterator[dict]:
    """A row a campaign, number and factor with which the campaign says something else; last a row of how often it was traced.

    Numbers that no call reads are passed over.
    """
    for folder in folders:
        with called() as seen:
            base = said(folder)
        answers: dict[tuple[Change, ...], object] = {}

        def under(changes: Sequence[Change], folder: Path = folder, known: dict = answers) -> object:
            """Return what the campaign says with these changes; the name of what was raised, for a number may be at its limit."""
            key = tuple(changes)
            if key not in known:
                with ExitStack() as held:
                    for module, name, _, value in changes:
                        held.enter_context(changed(module, name, value))
                    try:
                        known[key] = said(folder)
                    except Exception as wrong:
                        known[key] = type(wrong).__name__
            return known[key]

        found = read_numbers(seen)
        for factor in FACTORS:
            changes = [(m, n, factor, v) for m, n, x in found if (v := times(x, factor)) != x]
            for change in deciding(changes, lambda c, under=under, base=base: under(c) != base):
                module, name, _, value = change
                row = {"campaign": folder.name, "number": f"{module}.{name}", "factor": factor, "value": value}
                yield row | {"says": under([change]), "instead of": base}
        yield {"campaign": folder.name, "numbers": len(found), "traced": 1 + len(answers)}


def times(value: Number, factor: float) -> Number:
    """Return a number times a factor, each of a few; a whole one stays whole and above zero."""
    if isinstance(value, tuple):
        return tuple(times(x, factor) for x in value)
    return max(1, round(value * factor)) if isinstance(value, int) else value * factor


def main(folders: Sequence[Path]) -> None:
    """Print every row, and last the numbers that changed something."""
    changes: dict[str, list[str]] = {}
    for row in sweep(folders):
        print(json.dumps(row), flush=True)
        if "number" in row:
            changes.setdefault(f"{row['number']} x {row['factor']:g}", []).append(row["campaign"])
    for number, campaigns in changes.items():
        print(f"{number}: {', '.join(campaigns)}")
