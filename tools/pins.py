"""The pins of requirements.lock that a choice of extras needs, and a table of what each package is and under which licence.

    python tools/pins.py select [EXTRA ...]     the entries of the lock, with their hashes; every one for the extra "all"
    python tools/pins.py third-party            docs/third-party.md, from the lock and the packages that are installed

The lock says of each package what asked for it ("# via"), so nothing is resolved anew and no network is asked. Standard
library alone: this runs before anything is installed.
"""

import re
import sys
import tomllib
from collections.abc import Iterable, Mapping
from importlib import metadata
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ALWAYS = "setup"  # the extra that a set-up itself runs on
ALL = "all"
OURS = "servo-workbench"


def canonical(name: str) -> str:
    """Return a package's name as the lock has it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def entries(lock: str) -> dict[str, str]:
    """Return name -> its entry, that begins at the margin and has hashes and "via" indented beneath."""
    found = re.findall(r"^[^\s#].*(?:\n[ \t].*)*", lock, flags=re.MULTILINE)
    return {canonical(re.match(r"[\w.-]+", entry)[0]): entry for entry in found}


def parents(entry: str) -> set[str]:
    """Return what asked for an entry, by the names under its "# via"."""
    comment = entry.partition("# via")[2]
    return {canonical(name) for name in re.findall(r"^[ #]*([\w.-]+)", comment, flags=re.MULTILINE)}


def roots(project: Mapping, extras: Iterable[str]) -> set[str]:
    """Return the packages that the project and these extras name. SystemExit with a sentence for an unknown extra."""
    optional = project["project"]["optional-dependencies"]
    wanted = list(project["project"]["dependencies"])
    for extra in (ALWAYS, *extras):
        if extra not in optional:
            sys.exit(f"There is no extra '{extra}'; known: {', '.join(sorted(optional))}, or {ALL}.")
        wanted += optional[extra]
    return {canonical(re.match(r"[\w.-]+", requirement)[0]) for requirement in wanted}


def closure(pins: Mapping[str, str], chosen: set[str]) -> set[str]:
    """Return these packages and whatever they ask for, directly or not."""
    asks: dict[str, set[str]] = {}
    for name, entry in pins.items():
        for parent in parents(entry):
            asks.setdefault(parent, set()).add(name)
    found, front = set(chosen), set(chosen)
    while front:
        front = set().union(*(asks.get(name, set()) for name in front)) - found
        found |= front
    return found


def select(extras: list[str]) -> str:
    """Return the part of the lock that these extras need."""
    pins = entries((ROOT / "requirements.lock").read_text(encoding="utf-8"))
    if extras == [ALL]:
        chosen = set(pins)
    else:
        chosen = closure(pins, roots(tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8")), extras))
    return "".join(f"{entry}\n" for name, entry in pins.items() if name in chosen)


def licence(name: str) -> str:
    """Return the licence that an installed package states; what is not installed on this machine says so."""
    try:
        about = metadata.metadata(name)
    except metadata.PackageNotFoundError:
        return "(not installed here: for another system or Python)"
    if expression := about.get("License-Expression"):
        return expression
    trove = [c.rpartition(" :: ")[2] for c in about.get_all("Classifier", []) if c.startswith("License :: ")]
    stated = (about.get("License") or "").strip().partition("\n")[0]
    return ", ".join(t for t in trove if t != "OSI Approved") or (stated if len(stated) < 60 else "") or "(none stated)"


def third_party() -> str:
    """Return the page: each pinned package, its version, its licence, and which extras bring it."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    pins = entries((ROOT / "requirements.lock").read_text(encoding="utf-8"))
    extras = sorted(set(project["project"]["optional-dependencies"]) - {ALWAYS})
    always = closure(pins, roots(project, ()))
    brings = {extra: closure(pins, roots(project, (extra,))) - always for extra in extras}
    lines = [
        "# Third-party packages\n",
        "Written by `make third-party` from `requirements.lock` and what the installed packages state. The package itself",
        "needs those of the first kind alone; the extras are for formats, benchmarks and tests.\n",
        "| package | version | licence | for |",
        "|---|---|---|---|",
    ]
    for name, entry in sorted(pins.items()):
        version = entry.split()[0].partition("==")[2]
        used = "the package" if name in always else ", ".join(e for e in extras if name in brings[e])
        lines.append(f"| {name} | {version} | {licence(name)} | {used} |")
    return "\n".join(lines) + "\n"


def main(arguments: list[str]) -> None:
    if arguments[:1] == ["select"]:
        print(select(arguments[1:]), end="")
    elif arguments == ["third-party"]:
        (ROOT / "docs" / "third-party.md").write_text(third_party(), encoding="utf-8")
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
