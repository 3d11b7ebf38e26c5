"""Count five ways through the code: `python tools/walks.py [ROOT] [--show WALK]`.

A walk follows one value, and what is computed from it, through the functions of the package in the order in which the source
calls them. stays: functions that it enters, each once, to a depth of calls that belongs to the walk. rooms: modules among
them. climbs: steps from one stay to the next at which the package's floor is higher. returns: stays less rooms. A package's
floor is the longest chain of imports beneath it. What a value is of is read from annotations; a call that they do not say is
passed over, so two trees are compared by this count, and no count is exact.
"""

import argparse
import ast
from pathlib import Path

from walking import Body, Tree

# walk: (module, function, argument, depth of calls). Depths are those at which the numbers of the tree that was first counted
# by hand (46, 77, 48, 51 and 177 stays) come out within a fifth: 47, 85, 58, 46 and 170.
WALKS = {
    "folder to Record": ("campaign", "load", "folder", 6),
    "campaign path to trace.json": ("verbs.trace", "do", "given", 4),
    "Trace to report": ("report.writing", "write", "result", 4),
    "plant to controllers": ("design.design", "design", "plant", 3),
    "records inside trace()": ("tracing.tracing", "trace", "inverses", 6),
}
EARLIER = {
    "report.writing": ("report.write",),
    "design.design": ("verification.design", "verify.design"),
    "tracing.tracing": ("trace.tracing",),
}


class Walk:
    """path: (module, function) in order of first entry."""

    def __init__(self, tree: Tree, depth: int):
        self.tree, self.left, self.path = tree, depth, []

    def enter(self, key: tuple[str, str], followed: set[str], classes: dict) -> None:
        """Note a function and follow the value through it. followed: its arguments that hold the value."""
        if self.left == 0 or key in self.path:
            return
        self.left -= 1
        self.path.append(key)
        Body(self, key, set(followed), dict(classes)).run()
        self.left += 1

    def numbers(self) -> tuple[int, int, int, int]:
        """Return (stays, rooms, climbs, returns)."""
        floors = [self.tree.floor(module) for module, _ in self.path]
        stays, rooms = len(self.path), len({module for module, _ in self.path})
        return stays, rooms, sum(b > a for a, b in zip(floors, floors[1:], strict=False)), stays - rooms


def walked(tree: Tree, module: str, function: str, argument: str, depth: int) -> Walk:
    """Return the walk of one argument of a function."""
    walk = Walk(tree, depth)
    walk.enter((f"workbench.{module}", function), {argument}, {})
    return walk


def main() -> None:
    given = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    given.add_argument("root", nargs="?", type=Path, default=Path(__file__).resolve().parent.parent)
    given.add_argument("--show", choices=WALKS, help="list the stays of one walk with their floors")
    asked = given.parse_args()
    files = sorted((asked.root / "workbench").rglob("*.py"))
    tree = Tree({p.relative_to(asked.root): ast.parse(p.read_text(encoding="utf-8")) for p in files})
    for name, (module, function, argument, depth) in WALKS.items():
        held = [m for m in (module, *EARLIER.get(module, ())) if (f"workbench.{m}", function) in tree.functions]
        place = next(iter(held), module)
        walk = walked(tree, place, function, argument, depth)
        stays, rooms, climbs, returns = walk.numbers()
        print(f"{name:28} {stays:4} stays {rooms:3} rooms {climbs:3} climbs {returns:4} returns")
        if name == asked.show:
            print("".join(f"    {tree.floor(m):2} {m} {f}\n" for m, f in walk.path), end="")


if __name__ == "__main__":
    main()
