"""What holds for the project as a whole: the layers, the lock, what is tracked, and what the package ships."""

import ast
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Iterator

import pytest
from layers import PACKAGE, ROOT, layers, room
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

# --- layers ----------------------------------------------------------------------------------------------------------


def imported(text: str, package: list[str]) -> Iterator[tuple[int, str]]:
    """Yield (line, what is imported, from the workbench on), wherever in the file: a late import is an import too.

    `package` is the package that the text lies in, which relative imports start from.
    """
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            base = [*base, *(node.module.split(".") if node.module else [])]
            names = [".".join([*base, alias.name]) for alias in node.names]
        else:
            continue
        for name in names:
            top, _, rest = name.partition(".")
            if top == "workbench" and rest:
                yield node.lineno, rest.partition(".")[0]


def upward(text: str, where: str, package: list[str], order: dict[str, int]) -> list[str]:
    """Return one sentence for each import of a later layer."""
    return [
        f"line {line}: '{where}' (layer {order[where]}) imports '{name}' (layer {order[name]})."
        for line, name in imported(text, package)
        if name in order and order[name] > order[where]
    ]


def test_the_table_of_layers_is_read():
    order = layers()
    assert order["errors"] == 0
    assert order["cli"] == max(order.values())
    assert sorted(set(order.values())) == list(range(max(order.values()) + 1))


@pytest.mark.parametrize(
    "text",
    [
        "import workbench.report",
        "from workbench import report",
        "from workbench.report import html",
        "from .. import report",
        "from ..report import html",
        "def late():\n    from workbench.report.html import page",
    ],
)
def test_every_way_to_import_is_seen(text):
    assert upward(text, "tracing", ["workbench", "tracing"], layers())


def test_an_import_of_an_earlier_or_the_own_layer_is_fine():
    text = "import numpy.report\nfrom workbench import __version__, errors\nfrom ..planning import a\nfrom .report import b\n"
    assert not upward(text, "tracing", ["workbench", "tracing"], layers())


def test_no_module_imports_from_a_later_layer():
    order = layers()
    wrong = []
    for path in sorted(PACKAGE.rglob("*.py")):
        shown = path.relative_to(ROOT)
        text = path.read_text(encoding="utf-8")
        if path == PACKAGE / "__init__.py":  # everyone imports it, so it may import no one
            found = imported(text, ["workbench"])
            wrong += [f"{shown}, line {line}: the package itself imports '{name}'." for line, name in found]
        elif room(path) not in order:
            wrong.append(f"{shown}: '{room(path)}' has no layer in the table of docs/architecture.md.")
        else:
            package = list(path.parent.relative_to(ROOT).parts)
            wrong += [f"{shown}, {sentence}" for sentence in upward(text, room(path), package, order)]
    assert not wrong, "\n".join(wrong)


def test_what_lies_within_a_package_imports_nothing_of_the_package_about_it():
    wrong = []
    for inner in sorted(PACKAGE.glob("*/*/__init__.py")):
        about, own = (".".join(p.relative_to(ROOT).parts) for p in (inner.parents[1], inner.parent))
        for path in sorted(inner.parent.rglob("*.py")):
            nodes = (n for n in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(n, ast.ImportFrom))
            above = [
                n for n in nodes if f"{n.module}.".startswith(f"{about}.") and not f"{n.module}.".startswith(f"{own}.")
            ]
            wrong += [f"{path.relative_to(ROOT)}, line {n.lineno}: imports '{n.module}'." for n in above]
    assert not wrong, "\n".join(wrong)


def test_packages_of_one_layer_import_each_other_in_no_circle():
    asks: dict[str, set[str]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        if path != PACKAGE / "__init__.py":
            package = list(path.parent.relative_to(ROOT).parts)
            found = {name for _, name in imported(path.read_text(encoding="utf-8"), package)}
            asks.setdefault(room(path), set()).update(found & set(layers()) - {room(path)})
    asks["definition"].discard("effects")  # a catalogue finds its effects by the names of their files
    while free := [name for name, others in asks.items() if not others & set(asks)]:
        for name in free:
            del asks[name]
    assert not asks, f"these import each other: {sorted(asks)}"


def test_the_command_line_starts_without_the_heavy_libraries():
    heavy = ("numpy", "scipy", "casadi", "pint", "numba", "matplotlib", "cvxpy")
    code = f"import sys, workbench.cli; print(*sorted(set({heavy!r}) & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


# --- the lock --------------------------------------------------------------------------------------------------------


def project() -> dict:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def lock() -> str:
    return (ROOT / "requirements.lock").read_text(encoding="utf-8")


def entries() -> list[str]:
    """Return the lock's entries: each begins at the margin, and its hashes follow indented."""
    return re.findall(r"^[^\s#].*(?:\n[ \t].*)*", lock(), flags=re.MULTILINE)


def test_the_lock_names_no_place_that_a_download_came_from():
    assert "://" not in lock()
    assert not re.search(r"^\s*-(?!-hash=)", lock(), flags=re.MULTILINE), "The lock holds an option of pip."


def test_every_pin_is_exact_and_hashed():
    for entry in entries():
        assert re.match(r"[\w.-]+==[\w.+!]+ ", entry), f"Not pinned: {entry}"
        assert "--hash=sha256:" in entry, f"Not hashed: {entry}"


def test_the_lock_holds_every_dependency_within_its_range():
    declared = project()
    wanted = [*declared["project"]["dependencies"], *declared["build-system"]["requires"]]
    for extra in declared["project"]["optional-dependencies"].values():
        wanted += extra
    pins: dict[str, list[str]] = {}
    for entry in entries():
        name, _, version = entry.split()[0].partition("==")
        pins.setdefault(canonicalize_name(name), []).append(version)
    for requirement in map(Requirement, wanted):
        versions = pins.get(canonicalize_name(requirement.name))
        assert versions, f"'{requirement}' is not in requirements.lock: run make lock."
        for version in versions:
            assert requirement.specifier.contains(version, prereleases=True), (
                f"requirements.lock pins {requirement.name} {version}, which '{requirement}' refuses: run make lock."
            )


# --- what is tracked -------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def tracked() -> list[str]:
    """The tracked files that are there, by git."""
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        pytest.skip("no git checkout here")
    # safe.directory: git else refuses a checkout that another user owns, as in a container.
    command = ["git", "-c", "safe.directory=*", "ls-files", "-z"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return [name for name in done.stdout.split("\0") if name and (ROOT / name).is_file()]


def test_of_reports_only_the_page_about_them_is_tracked(tracked):
    assert [name for name in tracked if name.startswith("reports/")] == ["reports/README.md"]


# Written in pieces, so that this file does not hold what it looks for.
MACHINE = re.compile(r"(?<![\w.~-])/(?:" + "|".join(("work", "home", "root", "Users")) + r")/")
REGISTRY = re.compile("|".join((r"pypi\." + "org", "python" + "hosted", r"npmjs\." + "org", r"crates\." + "io")), re.I)
BESIDE = ".." + "/shared"


def faults(name: str, text: str) -> list[str]:
    """Return what a tracked text may not hold: it would be true of one machine only, or tie the project to a host."""
    found = [f"{name} names the path of a machine: '{m.group()}'." for m in MACHINE.finditer(text)]
    found += [f"{name} names the host of a package registry: '{m.group()}'." for m in REGISTRY.finditer(text)]
    if BESIDE in text and name != ".ci/run":
        found.append(f"{name} names '{BESIDE}'; measured data is found through WORKBENCH_DATA.")
    return found


def test_no_tracked_text_is_true_of_one_machine_only(tracked):
    wrong = []
    for name in tracked:
        content = (ROOT / name).read_bytes()
        if b"\0" not in content:
            wrong += faults(name, content.decode("utf-8", errors="replace"))
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("text", ["cd /ho" + "me/me", "'/wo" + "rk/x'", "PyPI.o" + "rg", BESIDE + "/data"])
def test_such_a_text_is_found(text):
    assert faults("a.md", text)
    assert not faults("a.md", "frame/" + "work/x, ~/" + "home/, shared/data")


# --- what is shipped -------------------------------------------------------------------------------------------------


def test_the_wheel_holds_every_tracked_file_of_the_package(tracked, tmp_path):
    command = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, capture_output=True, check=True)
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        shipped = set(archive.namelist())
    assert {name for name in tracked if name.startswith("workbench/")} <= shipped
    assert any(name.endswith("/licenses/LICENSE") for name in shipped)


def test_a_test_stands_in_the_folder_of_the_package_that_it_is_of():
    packages = {init.parent.name for init in (ROOT / "workbench").glob("*/__init__.py")}
    modules = {path.stem for path in (ROOT / "workbench").glob("*.py")}
    wrong = [str(p) for p in (ROOT / "tests").glob("test_*.py") if p.stem.removeprefix("test_") not in modules]
    folders = {p.parent.relative_to(ROOT / "tests").parts[0] for p in (ROOT / "tests").glob("*/**/test_*.py")}
    wrong += sorted(folders - packages - {"project", "studies"})
    assert not wrong, f"move into tests/PACKAGE, tests/project (the checkout) or tests/studies (one study): {wrong}"


def test_a_kind_of_finding_that_somebody_asks_for_is_written_once():
    from workbench import finding

    kinds = {v for k, v in vars(finding).items() if k.isupper() and isinstance(v, str)}
    wrong = []
    for path in sorted(PACKAGE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            made = isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Finding"
            asked = isinstance(node, ast.Compare) and getattr(node.left, "attr", "") == "kind"
            said = node.args[:1] if made else node.comparators if asked else []
            wrong += [f"{path.name}, line {s.lineno}" for s in said if isinstance(s, ast.Constant) and s.value in kinds]
    assert not wrong, f"write the constant of workbench.finding: {wrong}"
