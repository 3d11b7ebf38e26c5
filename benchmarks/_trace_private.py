"""What halving and doubling each private number of the trace does to verdicts, campaign by campaign.

A private number (a module's constant in capitals) serves a search or a description. One that changes a verdict decides, and
belongs among the criteria. Each is changed wherever it was imported to, the campaigns are traced again, and the verdict, the
effects that are added and what is ranked first are compared.
"""

import ast
import importlib
import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path

FACTORS = (0.5, 2.0)
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


def numbers() -> Iterator[tuple[str, str, float]]:
    """(module, name, value) of every private number of the trace, in the order of their files."""
    for stem, name in modules().items():
        module = importlib.import_module(name)
        for node in ast.parse(Path(module.__file__).read_text(encoding="utf-8")).body:
            targets = node.targets if isinstance(node, ast.Assign) else []
            names = [
                x for t in targets for x in (t.elts if isinstance(t, ast.Tuple) else [t]) if isinstance(x, ast.Name)
            ]
            for x in names:
                value = getattr(module, x.id, None)
                if x.id.isupper() and isinstance(value, int | float) and not isinstance(value, bool):
                    yield stem, x.id, value


@contextmanager
def changed(module: str, name: str, value: float) -> Iterator[None]:
    """While it lasts the number has another value, in its module and wherever it was imported by that name."""
    home = importlib.import_module(modules()[module])
    before = getattr(home, name)
    held = [m for key, m in sys.modules.items() if key.startswith("workbench.") and getattr(m, name, None) is before]
    own = [m for m in held if m is home or comes_from(m, module, name)]
    try:
        for m in own:
            setattr(m, name, value)
        yield
    finally:
        for m in own:
            setattr(m, name, before)


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
    """What a trace says of a campaign, as far as it is compared."""
    from benchmarks._trace_run import traced
    from workbench.campaign import load

    found = traced(load(folder))
    return found["verdict"], tuple(sorted(found["added"])), tuple(found["ranked"][:1])


def sweep(folders: Sequence[Path]) -> Iterator[dict]:
    """A row a number and factor: how many of the campaigns say something else, and which."""
    base = {f.name: said(f) for f in folders}
    for module, name, value in list(numbers()):
        for factor in FACTORS:
            other = max(1, round(value * factor)) if isinstance(value, int) else value * factor
            differs = []
            if other != value:
                with changed(module, name, other):
                    for f in folders:
                        try:
                            if said(f) != base[f.name]:
                                differs.append(f.name)
                        except Exception as wrong:  # a number may be at its limit; that, too, is told
                            differs.append(f"{f.name}: {type(wrong).__name__}")
            yield {"number": f"{module}.{name}", "value": value, "factor": factor, "differs": differs}


def main(folders: Sequence[str]) -> None:
    for row in sweep([Path(f) for f in folders]):
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
