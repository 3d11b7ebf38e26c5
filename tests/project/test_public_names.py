"""What is public is used by somebody else: a function that its own file alone calls wears an underscore."""

import ast
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
READERS = ("workbench", "studies", "benchmarks", "tests", "docs")
PACKAGES = sorted(init.parent.name for init in (ROOT / "workbench").glob("*/__init__.py"))
ALONE = sorted(
    f.stem for f in (ROOT / "workbench").glob("*.py") if not f.stem.startswith("__")
)  # modules of no package


def module_of(path: Path) -> str:
    """Return the dotted name of a file of the project."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def trees() -> dict[str, ast.Module]:
    """Return module -> its syntax tree, of every Python file that may call the package."""
    files = [f for folder in READERS for f in (ROOT / folder).rglob("*.py")]
    return {module_of(f): ast.parse(f.read_text(encoding="utf-8")) for f in files}


class Words:
    """What a file says: (module, name) of "from" imports, modules imported whole, and attributes and ends of texts."""

    def __init__(self, tree: ast.Module):
        self.taken, self.whole, self.attributes = set(), set(), set()
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module:
                self.taken |= {(node.module, alias.name) for alias in node.names}
            elif isinstance(node, ast.Import):
                self.whole |= {alias.name for alias in node.names}
            elif isinstance(node, ast.Attribute):
                self.attributes.add(node.attr)
            elif isinstance(node, ast.Constant) and isinstance(node.value, str) and len(node.value) < 100:
                self.attributes.add(node.value.rpartition(".")[2])

    def asks_for(self, module: str, name: str) -> bool:
        """Whether the file imports this function, or its module and then an attribute of that name."""
        package, _, leaf = module.rpartition(".")
        if (module, name) in self.taken or (package, name) in self.taken:
            return True
        return name in self.attributes and ((package, leaf) in self.taken or module in self.whole)


@cache
def said() -> dict[str, Words]:
    return {module: Words(tree) for module, tree in trees().items()}


def lonely(package: str) -> list[str]:
    """Return "module.function" of the public functions of a package, or of a module of none, that no other file asks for."""
    found = []
    for module, tree in trees().items():
        if module.split(".")[:2] != ["workbench", package]:
            continue
        others = [words for reader, words in said().items() if reader != module]
        for node in tree.body:
            public = isinstance(node, ast.FunctionDef) and not node.name.startswith("_") and not node.decorator_list
            if public and not any(words.asks_for(module, node.name) for words in others):
                found.append(f"{module}.{node.name}")
    return found


@pytest.mark.parametrize("package", [*PACKAGES, *ALONE])
def test_a_function_that_its_own_file_alone_calls_is_private(package):
    held = [name for name in lonely(package) if not name.startswith("workbench.front.")]
    assert not held, f"write an underscore before: {', '.join(held)}"


def test_names_of_the_front_are_those_that_import_workbench_hands_on():
    import workbench

    public = {name.rpartition(".")[2] for name in lonely("front")}
    assert public <= set(workbench.HELD)


@pytest.mark.parametrize("package", [p for p in PACKAGES if p not in ("effects", "front", "verbs")])
def test_the_front_of_a_package_says_what_it_is_and_hands_on_its_names(package):
    front = import_module(f"workbench.{package}")
    modules = {path.stem for path in (ROOT / "workbench" / package).glob("*.py")}
    names = getattr(
        front, "__all__", [n for n, v in vars(front).items() if getattr(v, "__module__", "") == front.__name__]
    )
    assert front.__doc__ and names
    assert not modules & set(names)  # a name that is a module, too, would hide it
    for name in names:
        assert getattr(front, name) is not None and name in dir(front)
    if hasattr(front, "HELD"):
        with pytest.raises(AttributeError, match="hands on"):
            front.no_such_name  # noqa: B018
