"""What tools/walks.py reads of a tree: who calls whom, with which of its values, in the order of the source."""

import ast
from functools import cached_property
from pathlib import Path

HANDED_ON = {"sorted", "list", "tuple", "reversed", "zip", "enumerate", "min", "max", "next", "iter", "set", "filter"}
Key = tuple[str, str]  # (module, name), also "Class.method"


class Tree:
    """functions and classes: (module, name) -> syntax tree. imports: module -> name -> (module, name there)."""

    def __init__(self, files: dict[Path, ast.Module]):
        self.functions, self.classes, self.imports = {}, {}, {}
        for path, tree in files.items():
            parts = path.with_suffix("").parts
            module = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
            self.imports[module] = {
                alias.asname or alias.name: (node.module, alias.name)
                for node in ast.walk(tree)
                if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("workbench")
                for alias in node.names
            }
            for node in tree.body:
                self._held(module, node)

    def _held(self, module: str, node: ast.stmt) -> None:
        if isinstance(node, ast.FunctionDef):
            self.functions[module, node.name] = node
        elif isinstance(node, ast.ClassDef):
            self.classes[module, node.name] = node
            inner = [f for f in node.body if isinstance(f, ast.FunctionDef)]
            self.functions |= {(module, f"{node.name}.{f.name}"): f for f in inner}

    @cached_property
    def _floors(self) -> dict[str, int]:
        beneath: dict[str, set[str]] = {}
        for module, names in self.imports.items():
            of = self._package(module)
            asked = {f"{m}.{n}" if f"{m}.{n}" in self.imports else m for m, n in names.values()} - {"workbench"}
            beneath.setdefault(of, set()).update({self._package(m) for m in asked} - {of})
        floors: dict[str, int] = {}

        def floor(package: str, above: tuple[str, ...] = ()) -> int:
            if package not in floors and package not in above:
                under = [floor(p, (*above, package)) for p in beneath.get(package, ())]
                floors[package] = 1 + max(under, default=-1)
            return floors.get(package, 0)

        for package in beneath:
            floor(package)
        return floors

    @staticmethod
    def _package(module: str) -> str:
        return ".".join(module.split(".")[:2])

    def floor(self, module: str) -> int:
        """Return the longest chain of imports beneath the package of a module."""
        return self._floors[self._package(module)]

    def meant(self, module: str, name: str, depth: int = 6) -> Key | str | None:
        """Return what a name stands for in a module: a function or class by its key, a module by its name."""
        if (module, name) in self.functions or (module, name) in self.classes:
            return module, name
        if depth == 0 or name not in self.imports.get(module, {}):
            return None
        home, there = self.imports[module][name]
        found = self.meant(home, there, depth - 1) if home != module else None
        return found or (f"{home}.{there}" if f"{home}.{there}" in self.imports else None)

    def class_of(self, module: str, annotation: ast.expr | None) -> Key | None:
        """Return the first class of the package that an annotation names: of a Sequence[Record], Record."""
        for node in ast.walk(annotation) if annotation is not None else ():
            name = {ast.Name: "id", ast.Attribute: "attr", ast.Constant: "value"}.get(type(node))
            found = self.meant(module, str(getattr(node, name))) if name else None
            if found in self.classes:
                return found
        return None

    def member(self, of: Key, name: str) -> Key | ast.expr | None:
        """Return the key of a method of a class, or the annotation of a field."""
        for node in self.classes[of].body:
            if isinstance(node, ast.AnnAssign) and getattr(node.target, "id", None) == name:
                return node.annotation
            if isinstance(node, ast.FunctionDef) and node.name == name:
                return of[0], f"{of[1]}.{name}"
        bases = [self.meant(of[0], getattr(b, "id", "")) for b in self.classes[of].bases]
        return next((m for b in bases if b in self.classes and (m := self.member(b, name))), None)


class Body:
    """One function, gone through in the order of its source. followed: names that hold the value. classes: name -> class."""

    def __init__(self, walk, key: Key, followed: set[str], classes: dict[str, Key]):
        self.walk, self.tree, self.module, self.node = walk, walk.tree, key[0], walk.tree.functions[key]
        self.followed, self.classes = followed, classes
        for one in _arguments(self.node):
            if found := self.tree.class_of(self.module, one.annotation):
                classes.setdefault(one.arg, found)
        if "." in key[1]:
            classes.setdefault("self", (key[0], key[1].partition(".")[0]))
        self.inner = {n.name: n for n in ast.walk(self.node) if isinstance(n, ast.FunctionDef) and n is not self.node}

    def run(self) -> None:
        """Go through the function's statements."""
        for statement in self.node.body:
            self._at(statement)

    def _holds(self, node: ast.AST | None) -> bool:
        return node is not None and any(isinstance(n, ast.Name) and n.id in self.followed for n in ast.walk(node))

    def _bound(self, target: ast.expr, value: ast.expr | None) -> None:
        found, holds = self._class(value), self._holds(value)
        for node in ast.walk(target):
            if isinstance(node, ast.Name):
                self.followed |= {node.id} if holds else set()
                self.classes |= {node.id: found} if found else {}

    def _at(self, node: ast.AST) -> None:
        if isinstance(node, ast.Assign):
            for target in node.targets:
                self._bound(target, node.value)
        elif isinstance(node, ast.AnnAssign | ast.AugAssign):
            self._bound(node.target, node.value)
        elif isinstance(node, ast.For):
            self._bound(node.target, node.iter)
        elif isinstance(node, ast.withitem) and node.optional_vars is not None:
            self._bound(node.optional_vars, node.context_expr)
        elif isinstance(node, ast.expr):
            self._class(node)
            return
        for part in ast.iter_child_nodes(node):
            if isinstance(part, ast.stmt | ast.withitem | ast.ExceptHandler | ast.match_case):
                self._at(part)
            elif isinstance(part, ast.expr) and not isinstance(node, ast.Assign | ast.AnnAssign | ast.AugAssign):
                self._class(part)

    def _class(self, node: ast.expr | None) -> Key | None:
        """Go through the calls of an expression; return the class of its value."""
        if isinstance(node, ast.Name):
            return self.classes.get(node.id)
        if isinstance(node, ast.Call):
            return self._called(node)
        if isinstance(node, ast.Attribute):
            return self._attribute(node)
        if isinstance(node, ast.ListComp | ast.SetComp | ast.GeneratorExp | ast.DictComp):
            for each in node.generators:
                self._bound(each.target, each.iter)
                for condition in each.ifs:
                    self._class(condition)
            if isinstance(node, ast.DictComp):
                self._class(node.key)
            return self._class(node.value if isinstance(node, ast.DictComp) else node.elt)
        if isinstance(node, ast.NamedExpr):
            self._bound(node.target, node.value)
        parts = (
            [self._class(n) for n in ast.iter_child_nodes(node) if isinstance(n, ast.expr)] if node is not None else []
        )
        kept = ast.Subscript | ast.Starred | ast.BoolOp | ast.Tuple | ast.List | ast.BinOp | ast.IfExp | ast.NamedExpr
        return next(filter(None, parts), None) if isinstance(node, kept) else None

    def _attribute(self, node: ast.Attribute) -> Key | None:
        of = self._class(node.value)
        found = self.tree.member(of, node.attr) if of else None
        if isinstance(found, tuple):
            return self.tree.class_of(found[0], self.tree.functions[found].returns)
        return self.tree.class_of(of[0], found) if found is not None else None

    def _called(self, node: ast.Call) -> Key | None:
        values = [*node.args, *(k.value for k in node.keywords)]
        classes = [self._class(v) for v in values]
        owner, target = None, None
        if isinstance(node.func, ast.Name):
            name = node.func.id
            if name in self.inner:
                return self.tree.class_of(self.module, self.inner[name].returns)
            if name == "map" and isinstance(node.args[0], ast.Name):
                target = self.tree.meant(self.module, node.args[0].id)
                node = ast.Call(node.args[0], node.args[1:], [])
                classes = classes[1:]
            elif name in HANDED_ON or name == "replace":
                return next(filter(None, classes), None)
            else:
                target = self.tree.meant(self.module, name)
        elif isinstance(node.func, ast.Attribute):
            owner, target = self._method(node.func)
        if target in self.tree.classes:
            return target
        if not isinstance(target, tuple) or target not in self.tree.functions:
            return None
        self._handed(target, node, owner, classes)
        return self.tree.class_of(target[0], self.tree.functions[target].returns)

    def _method(self, func: ast.Attribute) -> tuple[Key | None, Key | ast.expr | str | None]:
        """Return the class that a method is called of, and the method; of a module, None and its function."""
        if isinstance(func.value, ast.Name) and func.value.id not in self.classes | dict.fromkeys(self.followed):
            home = self.tree.meant(self.module, func.value.id)
            if isinstance(home, str):
                return None, self.tree.meant(home, func.attr)
            return (home, self.tree.member(home, func.attr)) if home in self.tree.classes else (None, None)
        of = self._class(func.value)
        return (of, self.tree.member(of, func.attr)) if of else (None, None)

    def _handed(self, target: Key, node: ast.Call, owner: Key | None, classes: list[Key | None]) -> None:
        """Enter a function with those of its arguments that hold the value."""
        names = [a.arg for a in _arguments(self.tree.functions[target])]
        followed, known = set(), {}
        if owner and names:
            known[names[0]] = owner
            if self._holds(node.func.value):
                followed.add(names[0])
            names = names[1:]
        pairs = [*zip(names, node.args, strict=False), *((k.arg, k.value) for k in node.keywords)]
        followed |= {name for name, value in pairs if name and self._holds(value)}
        known |= {name: of for (name, _), of in zip(pairs, classes, strict=False) if name and of}
        if followed:
            self.walk.enter(target, followed, known)


def _arguments(node: ast.FunctionDef) -> list[ast.arg]:
    return [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
